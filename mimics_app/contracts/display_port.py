"""What a display is: which eyes look out of which pictures, and how a drawn frame is handed over.

The renderer draws a list of views and knows no display; a display knows no renderer. Frames: "room" is the frame of a
display's trackers and walls, metres, +y up; "head" is between the eyes, looking along -z; the world is the scene's. A
scene's camera says where in the world the head of a person is who stands at the display's resting place.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import Enum
from typing import Protocol

import numpy as np

from mimics_app.contracts.arrays import F8, U1
from mimics_app.contracts.tracker_port import TrackerSample

__all__ = [
    "MAX_PREDICTION_NS",
    "Composing",
    "Display",
    "DisplayFrame",
    "Eye",
    "FrameTiming",
    "HeadSource",
    "HeadsetState",
    "Viewpoint",
    "WindowPlace",
]

Rect = tuple[int, int, int, int]
Size = tuple[int, int]
Tangents = tuple[float, float, float, float]

MAX_PREDICTION_NS = 50_000_000
"""A head is predicted no farther ahead [ns]: constant velocity errs by A w^2 t^2 / 2, 1.5 deg at +-30 deg and 1 Hz."""


@dataclass(frozen=True, slots=True, eq=False)
class Viewpoint:
    """The scene's camera.

    Attributes:
        world_from_head: Rigid pose of a head at rest, float64 [4, 4].
        vertical_fov: Of a plain picture, bottom to top [rad].
    """

    world_from_head: F8
    vertical_fov: float

    @property
    def world_from_rest(self) -> F8:
        """The same place and heading, level: a person stands upright in the room, wherever a camera is tilted to."""
        back = self.world_from_head[:3, 2] * np.array([1.0, 0.0, 1.0])
        length = float(np.linalg.norm(back))
        if length < _STEEP:  # it looks straight up or down: its upper edge says where is forward
            back = self.world_from_head[:3, 1] * np.array([1.0, 0.0, 1.0]) * -np.sign(self.world_from_head[1, 2])
            length = float(np.linalg.norm(back))
        back = back / length
        level = np.eye(4)
        level[:3, 0] = (back[2], 0.0, -back[0])
        level[:3, 2], level[:3, 3] = back, self.world_from_head[:3, 3]
        return level


@dataclass(frozen=True, slots=True, eq=False)
class Eye:
    """One picture of a frame.

    Attributes:
        name: For files and messages: "", "left", "wall_front", "wall_front_left".
        world_from_eye: Rigid pose; looks along -z, +y up; float64 [4, 4].
        tangents: Of the frustum's edges: left, right, bottom, top.
        rectangle: Where in the drawn picture: x, y of the lower left corner, width, height [px].
        screen: Views of one screen share their heads-up display; -1: none is laid over it.
        pair: Eyes of one number are the two before one picture, and may be drawn together; -1: an eye on its own.
    """

    name: str
    world_from_eye: F8
    tangents: Tangents
    rectangle: Rect
    screen: int = 0
    pair: int = -1


@dataclass(frozen=True, slots=True)
class WindowPlace:
    """A window of its own for one eye's picture, beside the surface.

    Attributes:
        title: Name of the eye.
        at: Its upper left corner on the desktop [px]; None: it fills a monitor.
        size: [px]; None: as large as its picture is drawn.
    """

    title: str
    at: tuple[int, int] | None
    size: Size | None


class HeadsetState(Enum):
    """Life of a headset's session, in the words of OpenXR 1.0."""

    IDLE = "idle"
    READY = "ready"
    SYNCHRONIZED = "synchronized"
    VISIBLE = "visible"
    FOCUSED = "focused"
    STOPPING = "stopping"
    LOSS_PENDING = "loss_pending"
    EXITING = "exiting"


@dataclass(frozen=True, slots=True)
class FrameTiming:
    """When a frame will be seen.

    Attributes:
        display_ns: Predicted, on the session's clock [ns].
        period_ns: From one frame to the next [ns]; 0: the display does not pace.
        render: False where nobody would see it: nothing is drawn, the frame is ended empty.
    """

    display_ns: int
    period_ns: int = 0
    render: bool = True


@dataclass(frozen=True, slots=True, eq=False)
class DisplayFrame:
    """A finished frame.

    Attributes:
        eyes: As drawn; a headset's runtime gets these poses and angles.
        size: Of the picture [px].
        texture: OpenGL name of the texture it is in, 0 where it is in none.
        read: Reads it: RGBA display values, uint8 [height, width, 4], row 0 at the top.
    """

    eyes: Sequence[Eye]
    size: Size
    texture: int
    read: Callable[[], U1]


@dataclass(frozen=True, slots=True, eq=False)
class Composing:
    """How the eyes' pictures become the one that is shown.

    Attributes:
        shader: Fragment shader below shaders/.
        vectors: Its vector and matrix uniforms by name, each flat, column after column.
        each_eye: True where it is run over each eye's rectangle, False where once over the whole picture.
    """

    shader: str
    vectors: dict[str, tuple[float, ...]]
    each_eye: bool = False


_STEEP = 1e-6
"""Horizontal part of a line of sight that has no heading."""

HeadSource = Callable[[int], F8 | None]
"""Session time [ns] -> room_from_head, float64 [4, 4]; None where no tracker knows."""


class Display(Protocol):
    """One display. Per frame: `begin_frame`, `eyes` (again just before submitting: late latch), `end_frame`.

    Attributes:
        kind: Of `DISPLAY_KINDS`.
        head: Where the person's head is, for displays that do not know on their own.
        composing: None where the eyes' rectangles are the picture already.
        leaving: True once the display wants the session to end.
        windows: Where pictures have windows of their own; () where the surface shows all.
    """

    kind: str
    head: HeadSource
    composing: Composing | None
    leaving: bool
    windows: Sequence[WindowPlace]

    def drawn_size(self, shown: Size) -> Size:
        """Size of the picture to draw [px] where one of size `shown` is to be seen."""
        ...

    def begin_frame(self, now_ns: int) -> FrameTiming:
        """Wait for the display where it paces; when the frame will be seen.

        Raises:
            DeviceError: it is gone for good.
        """
        ...

    def eyes(self, viewpoint: Viewpoint, drawn: Size, display_ns: int) -> list[Eye]:
        """What each eye sees at a time, in a picture of size `drawn`."""
        ...

    def end_frame(self, frame: DisplayFrame | None) -> None:
        """Hand over what was drawn, None where nothing was."""
        ...

    def take_faults(self) -> list[str]:
        """What could not be shown as it should since the last call, a line each; each fault is reported once."""
        ...

    def tracked(self) -> Sequence[TrackerSample]:
        """What the display itself knows of head and hands, in the frame of the head at rest; () for nothing."""
        ...

    def take_pressed(self) -> Sequence[str]:
        """Gamepad buttons that the person's own controllers stand for and that went down since the last call."""
        ...

    def renew(self) -> None:
        """The surface has a new context: what was bound to the old one is gone."""
        ...

    def close(self) -> None:
        """Free everything."""
        ...
