"""Port of displays: the eyes of a frame with their rectangles, and the presentation of a drawn frame.

The renderer draws a list of views and is independent of displays, and they of it. Frames: "room" is the frame of a
display's trackers and walls, metres, +y up; "head" is between the eyes, looking along -z; the world is the scene's. A
scene's camera is the pose in the world of a head at the display's rest position.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import Enum
from typing import Protocol

import numpy as np

from mimics_app.contracts.arrays import F8, U1
from mimics_app.contracts.clock import FRAME_NS, LONGEST_FRAME_NS
from mimics_app.contracts.ports.tracker_port import TrackerSample

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
"""Longest prediction of a head pose [ns]: constant velocity errs by A w^2 t^2 / 2, 1.5 deg at +-30 deg and 1 Hz."""


@dataclass(frozen=True, slots=True, eq=False)
class Viewpoint:
    """The scene's camera.

    Attributes:
        world_from_head: Rigid pose of a head at rest, float64 [4, 4].
        vertical_fov: Vertical field of view of a desktop view of at least 4:3 [rad].
    """

    world_from_head: F8
    vertical_fov: float

    @property
    def world_from_rest(self) -> F8:
        """Pose with the same position and heading, levelled: a person stands upright however the camera is tilted."""
        back = self.world_from_head[:3, 2] * np.array([1.0, 0.0, 1.0])
        length = float(np.linalg.norm(back))
        if length < _STEEP:  # straight up or down: the camera's up vector gives the heading
            back = self.world_from_head[:3, 1] * np.array([1.0, 0.0, 1.0]) * -np.sign(self.world_from_head[1, 2])
            length = float(np.linalg.norm(back))
        back = back / length
        level = np.eye(4)
        level[:3, 0] = (back[2], 0.0, -back[0])
        level[:3, 2], level[:3, 3] = back, self.world_from_head[:3, 3]
        return level


@dataclass(frozen=True, slots=True, eq=False)
class Eye:
    """One view of a frame.

    Attributes:
        name: Name for files and messages: "", "left", "wall_front", "wall_front_left".
        world_from_eye: Rigid pose; looks along -z, +y up; float64 [4, 4].
        tangents: Tangents of the frustum's edges: left, right, bottom, top.
        rectangle: Viewport in the drawn picture: x, y of the lower left corner, width, height [px].
        screen: Views of one screen share a heads-up display; -1: no heads-up display.
        pair: Eyes with the same number form a stereo pair and may be drawn together; -1: a single eye.
    """

    name: str
    world_from_eye: F8
    tangents: Tangents
    rectangle: Rect
    screen: int = 0
    pair: int = -1


@dataclass(frozen=True, slots=True)
class WindowPlace:
    """Additional window for the view of one eye.

    Attributes:
        title: Name of the eye.
        at: Upper left corner on the desktop [px]; None: full screen.
        size: [px]; None: the size of the drawn view.
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
    """Timing of a frame.

    Attributes:
        display_ns: Predicted display time, on the session's clock [ns].
        period_ns: Frame period [ns]; 0: the display does not pace.
        render: False if the frame will not be visible: nothing is drawn, and the frame is ended empty.
    """

    display_ns: int
    period_ns: int = 0
    render: bool = True

    @classmethod
    def expected(cls, now_ns: int) -> FrameTiming:
        """Return the timing of a frame that no display reports: shown a sixtieth of a second after it is begun."""
        return cls(now_ns + FRAME_NS, LONGEST_FRAME_NS)


@dataclass(frozen=True, slots=True, eq=False)
class DisplayFrame:
    """A finished frame.

    Attributes:
        eyes: Eyes as drawn; a headset's runtime gets these poses and angles.
        size: Size of the picture [px].
        texture: OpenGL name of its texture, 0 for none.
        read: Reads the pixels: RGBA display values, uint8 [height, width, 4], row 0 at the top.
    """

    eyes: Sequence[Eye]
    size: Size
    texture: int
    read: Callable[[], U1]


@dataclass(frozen=True, slots=True, eq=False)
class Composing:
    """Composition of the eyes' views into the picture that is shown.

    Attributes:
        shader: Fragment shader below shaders/.
        vectors: Its vector and matrix uniforms by name, flattened column by column.
        each_eye: True: run once per eye's rectangle, False: once over the whole picture.
    """

    shader: str
    vectors: dict[str, tuple[float, ...]]
    each_eye: bool = False


_STEEP = 1e-6
"""Horizontal length of a line of sight below which it has no heading."""

HeadSource = Callable[[int], F8 | None]
"""Session time [ns] -> room_from_head, float64 [4, 4]; None without tracking."""


class Display(Protocol):
    """One display. Per frame: `begin_frame`, `eyes` (again just before submitting: late latch), `end_frame`.

    Attributes:
        kind: One of `DISPLAY_KINDS`.
        head: Source of the head pose, for displays without tracking of their own.
        composing: Composition of the views; None where the eyes' rectangles form the picture.
        leaving: True once the display requests the end of the session.
        windows: Additional windows; () if the surface shows everything.
    """

    kind: str
    head: HeadSource
    composing: Composing | None
    leaving: bool
    windows: Sequence[WindowPlace]

    def drawn_size(self, shown: Size) -> Size:
        """Return the size of the picture to draw for one shown at size `shown` [px]."""
        ...

    def begin_frame(self, now_ns: int) -> FrameTiming:
        """Wait for the display where it paces; return the timing of the frame.

        Raises:
            DeviceError: The display is lost.
        """
        ...

    def eyes(self, viewpoint: Viewpoint, drawn: Size, display_ns: int) -> list[Eye]:
        """Return the eyes at a time, in a picture of size `drawn`."""
        ...

    def end_frame(self, frame: DisplayFrame | None) -> None:
        """Present the drawn frame, None for an empty one."""
        ...

    def take_faults(self) -> list[str]:
        """Return the faults of presentation since the last call, one line each; each is reported once."""
        ...

    def tracked(self) -> Sequence[TrackerSample]:
        """Return the display's own tracking of head and hands, in the frame of the head at rest; () for none."""
        ...

    def take_pressed(self) -> Sequence[str]:
        """Return the gamepad buttons, mapped from the display's controllers, pressed since the last call."""
        ...

    def renew(self) -> None:
        """Recreate the resources of a lost OpenGL context."""
        ...

    def close(self) -> None:
        """Release all resources."""
        ...
