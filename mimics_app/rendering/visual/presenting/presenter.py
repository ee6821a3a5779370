"""Presenter of a display: gives the renderer its views, and shows its pictures."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol, TypeVar

import numpy as np

from mimics_app.contracts.arrays import F8, U1
from mimics_app.contracts.clock import MonotonicClock
from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.ports.display_port import (
    Composing,
    Display,
    DisplayFrame,
    Eye,
    FrameTiming,
    HeadSource,
    Rect,
    Viewpoint,
)
from mimics_app.contracts.ports.plugins import raised
from mimics_app.contracts.ports.tracker_port import TrackerSample
from mimics_app.rendering.visual.displays.desktop import DesktopDisplay
from mimics_app.rendering.visual.materials.shader_library import ShaderLibrary
from mimics_app.rendering.visual.passes.screen import ScreenPass
from mimics_app.rendering.visual.surfaces.eye_buffer import EyeBuffer
from mimics_app.rendering.visual.surfaces.headless import WritePng, read_pixels, write_png
from mimics_app.rendering.visual.surfaces.surface import Size, Surface
from mimics_app.rendering.visual.surfaces.wall_windows import WallWindows
from mimics_app.rendering.visual.view import View

if TYPE_CHECKING:
    import moderngl

__all__ = ["ComposePass", "Presenter", "SeenFrom"]


class ComposePass:
    """Runs the composition of a display.

    Args:
        ctx: Context of the pass.
        composing: Shader and uniforms.
    """

    def __init__(self, ctx: moderngl.Context, composing: Composing) -> None:
        self._composing = composing
        self._shaders = ShaderLibrary(ctx)
        self._pass = ScreenPass(ctx, self._shaders, composing.shader)

    def draw(self, drawn: EyeBuffer, shown: Surface, places: Sequence[Rect]) -> int:
        """Fill the surface; return the draw calls.

        Args:
            drawn: Picture of all eyes.
            shown: Surface to fill.
            places: Rectangles of the eyes in `drawn` [px], for shaders that run per eye.
        """
        shown.framebuffer.use()
        program: Any = self._shaders.program("post/screen.vert", self._composing.shader).program
        for name, values in self._composing.vectors.items():
            program[name].value = values
        if "rows" in program:
            program["rows"].value = float(shown.size[1])
        if not self._composing.each_eye:
            whole = (0, 0, *drawn.size)
            return self._pass.draw(drawn.texture, whole, (0, 0, *shown.size))
        shown.framebuffer.clear(alpha=1.0)
        return sum(self._pass.draw(drawn.texture, place, scaled(place, drawn, shown)) for place in places)

    def release(self) -> None:
        """Free the vertex array."""
        self._pass.release()


def scaled(place: Rect, drawn: Surface, shown: Surface) -> Rect:
    """Scale a rectangle of one picture to another that shows all of it at another size [px]."""
    across, down = shown.size[0] / drawn.size[0], shown.size[1] / drawn.size[1]
    x, y, width, height = place
    left, bottom = round(x * across), round(y * down)
    return left, bottom, max(1, round((x + width) * across) - left), max(1, round((y + height) * down) - bottom)


_Answer = TypeVar("_Answer")

_REST_HEIGHT = 1.7
"""Eye height of a person at rest, for trackers with room coordinates and displays without [m]."""

_WALLS = ("wall", "cave")
"""Kinds whose pictures are seen apart: an offscreen surface takes their total size."""

_HEADSETS = ("sim-hmd", "openxr")
"""Kinds with a runtime that receives the frame."""

_OVER_EACH_OTHER = ("interleaved", "anaglyph", "quad")
"""Kinds that show both eyes in the same place."""

_PATIENCE_NS, _STEP_NS = 5_000_000_000, 2_000_000
"""Time-out and polling interval of a still picture that waits for a headset's session [ns]."""

_SHOW = Composing("post/resample.frag", {}, each_eye=True)
"""Composition of a display whose picture has another size than the surface: scaled to fit."""


class SeenFrom(Protocol):
    """What a display needs of a camera; `world.camera.Camera` is one."""

    @property
    def world_from_eye(self) -> F8:
        """Rigid pose; looks along -z, +y up; float64 [4, 4]."""

    @property
    def vertical_fov(self) -> float:
        """Full vertical angle of view [rad]."""

    @property
    def near(self) -> float:
        """Distance of the near plane [m]."""

    @property
    def far(self) -> float:
        """Distance of the far plane [m]."""


class _BesideWindows:
    """The windows of a display's pictures, opened with the first frame.

    Args:
        display: Display that lists the windows.
        surface: Surface whose context they share.
    """

    def __init__(self, display: Display, surface: Surface) -> None:
        self._display, self._surface = display, surface
        self._windows: WallWindows | None = None
        self._composed: EyeBuffer | None = None
        self._opened = False
        self._faults: list[str] = []

    def show(self, drawn: EyeBuffer, eyes: Sequence[Eye], compose: ComposePass | None) -> None:
        """Show each eye's picture in its window.

        Args:
            drawn: Picture of all eyes.
            eyes: The eyes as drawn.
            compose: Composition of the display, None without one.
        """
        windows = self._open(eyes[0].rectangle[2:])
        if windows is None:
            return
        whole = drawn
        if compose is not None:
            whole = self._composed = self._composed or EyeBuffer(self._surface, drawn.size)
            whole.resize(drawn.size)
            compose.draw(drawn, whole, [eye.rectangle for eye in eyes])
        windows.show(whole.texture.glo, [(eye.name, eye.rectangle) for eye in eyes])

    @property
    def should_close(self) -> bool:
        """Whether the person closed one of them."""
        return self._windows is not None and self._windows.should_close

    def take_faults(self) -> list[str]:
        """Return the windows that could not be opened, a line each; each is reported once."""
        taken, self._faults = self._faults, []
        return taken

    def close(self) -> None:
        """Close the windows; the next frame opens them again."""
        if self._windows is not None:
            self._windows.close()
        self._windows, self._composed, self._opened = None, None, False

    def _open(self, size: tuple[int, int]) -> WallWindows | None:
        if self._opened:
            return self._windows
        self._opened = True
        self._windows = self._surface.open_beside(self._display.windows, size)
        if self._windows is not None and self._windows.missing:
            names = ", ".join(self._windows.missing)
            self._faults.append(f'no monitor is left for {names}: seen in the first window alone; give a wall "window"')
        return self._windows


class Presenter:
    """One display on one surface.

    Args:
        display: The display; closed with the presenter.
        surface: The window, or an offscreen surface.

    Attributes:
        drawn: Surface to draw on: `surface` itself where the display has no composition.
        timing: Timing of the present frame.
    """

    def __init__(self, display: Display, surface: Surface) -> None:
        self.display, self.surface = display, surface
        self._compose: ComposePass | None = None
        self._fixed = None if surface.backend == "window" else surface.size
        if self._fixed is not None and display.kind in _WALLS:
            surface.resize(display.drawn_size(self._fixed))
        self._beside = _BesideWindows(display, surface) if display.windows and surface.backend == "window" else None
        apart = display.composing is not None or self._beside is not None or self._wanted() != surface.size
        apart = apart or display.kind == "openxr"  # its runtime is given a texture
        self.drawn: Surface = EyeBuffer(surface, self._wanted()) if apart else surface
        self.timing = FrameTiming(0)
        self._begun = False
        self._eyes: list[Eye] = []
        self._views: list[View] = []
        self._seen: object = None

    def follow(self, head: HeadSource) -> None:
        """Set the source of the head pose, room_from_head, of displays without a tracker of their own."""
        if self.display.kind in _WALLS:
            self.display.head = head
        elif self.display.kind == "hmd":
            self.display.head = partial(_from_rest, head)

    @property
    def follows_head(self) -> bool:
        """Whether the views depend on the head pose."""
        return self.display.kind in (*_WALLS, "hmd", "sim-hmd", "openxr")

    @property
    def paces(self) -> bool:
        """Whether the display says when a frame begins and when it will be seen."""
        return self.display.kind in _HEADSETS

    @property
    def begun(self) -> bool:
        """Whether a frame was begun and not shown yet."""
        return self._begun

    @property
    def surrounds(self) -> bool:
        """Whether the person stands in front of walls and sees their own body."""
        return self.display.kind in _WALLS

    @property
    def worn(self) -> bool:
        """Whether one person wears the display, and others see at most its mirror."""
        return self.display.kind in (*_HEADSETS, "hmd")

    @property
    def mirrored(self) -> bool:
        """Whether the surface shows the mirror of a headset."""
        return self.display.kind in _HEADSETS

    def begin(self, now_ns: int) -> FrameTiming:
        """Begin a frame; see `Display.begin_frame`. A frame that was begun and never shown ends empty."""
        if self._begun:
            self.skip()
        self._begun = True
        self.timing = self._ask(lambda display: display.begin_frame(now_ns))
        return self.timing

    def begin_seen(self, now_ns: int) -> FrameTiming:
        """Begin a frame that will be visible: a headset's session takes some frames to start."""
        clock = MonotonicClock()
        limit_ns = clock.now_ns() + (_PATIENCE_NS if self.display.kind == "openxr" else 0)
        while not self.begin(now_ns).render and clock.now_ns() < limit_ns:
            clock.sleep_until_ns(clock.now_ns() + _STEP_NS)
        return self.timing

    def _ask(self, call: Callable[[Display], _Answer]) -> _Answer:
        """Return the display's answer; what it raises makes it a lost one: the session continues, on the desktop."""
        try:
            return call(self.display)
        except Exception as error:  # of a library or a third party: it must not end the session
            if self.surface.reset_status():
                raise  # the whole context is lost and will be made again
            self._show_on_desktop(error)
        return call(self.display)

    def _show_on_desktop(self, error: Exception) -> None:
        """Replace a display that was lost for good by the desktop."""
        what = str(error) if isinstance(error, DeviceError) else f"the display {self.display.kind} {raised(error)}"
        faults: list[str] = []
        with suppress(Exception):  # it is lost already
            faults = self.display.take_faults()
        with suppress(Exception):
            self.display.close()
        desktop = DesktopDisplay()
        for fault in [*faults, f"{what}: the picture is shown on the desktop"]:
            desktop.note(fault)
        self.display = desktop
        if self._compose is not None:
            self._compose.release()
            self._compose = None

    def tracked(self) -> list[TrackerSample]:
        """Return head and hands as tracked by the display, in room coordinates."""
        return [
            replace(each, position=(each.position[0], each.position[1] + _REST_HEIGHT, each.position[2]))
            for each in self._ask(lambda display: display.tracked())
        ]

    def views(self, camera: SeenFrom) -> list[View]:
        """Return the views of all eyes at the frame's display time: the same ones where nothing has changed."""
        if self.drawn is not self.surface:
            self.drawn.resize(self._wanted())
        viewpoint = Viewpoint(camera.world_from_eye, camera.vertical_fov)
        size, at_ns = self.drawn.size, self.timing.display_ns
        self._eyes = self._ask(lambda display: display.eyes(viewpoint, size, at_ns))
        near, far = camera.near, camera.far
        seen = [(eye.world_from_eye.tobytes(), eye.tangents, eye.rectangle, eye.screen, eye.pair) for eye in self._eyes]
        if self._seen != (seen, near, far):
            self._seen = seen, near, far
            self._views = [
                View(eye.world_from_eye, eye.tangents, eye.rectangle, near, far, eye.screen, pair=eye.pair)
                for eye in self._eyes
            ]
        return list(self._views)

    def ray(self, camera: SeenFrom, right: float, up: float) -> tuple[F8, F8]:
        """Return the ray through a point of the shown picture, each coordinate in [-1, 1].

        It is that of the eye whose picture is there; the mean of both where their pictures overlap.

        Returns:
            Origin, world [m], and direction, float64 [3] each.
        """
        views = self.views(camera)
        if self.display.kind in _OVER_EACH_OTHER:
            rays = np.array([view.ray(right, up) for view in views]).mean(axis=0)
            return rays[0], rays[1]
        at = 0.5 * (np.array([right, up]) + 1.0) * self.drawn.size
        view = min(views, key=lambda each: _outside(each.rectangle, at))
        x, y, width, height = view.rectangle
        inside = 2.0 * (at - (x, y)) / (width, height) - 1.0
        return view.ray(float(inside[0]), float(inside[1]))

    def present(self) -> None:
        """Compose the drawn picture and submit it; the surface's `swap` shows it.

        A headset receives the frame first, before its mirror on the surface.
        """
        self._begun = False
        texture = self.drawn.texture.glo if isinstance(self.drawn, EyeBuffer) else 0
        frame = DisplayFrame(self._eyes, self.drawn.size, texture, self._read)
        if self.display.kind in _HEADSETS:
            self._ask(lambda display: display.end_frame(frame))
            self._show_on_surface()
        else:
            self._show_on_surface()
            self._ask(lambda display: display.end_frame(frame))

    def _show_on_surface(self) -> None:
        if isinstance(self.drawn, EyeBuffer) and self.drawn is not self.surface:  # the surface may be one itself
            if self._compose is None:
                self._compose = ComposePass(self.surface.ctx, self.display.composing or _SHOW)
            self._compose.draw(self.drawn, self.surface, [eye.rectangle for eye in self._eyes])
            if self._beside is not None:
                self._beside.show(self.drawn, self._eyes, self._compose if self.display.composing else None)
            self.surface.both_eyes = self.drawn.framebuffer if self.display.kind == "quad" else None

    def skip(self) -> None:
        """End a frame without a picture."""
        self._begun = False
        self._ask(lambda display: display.end_frame(None))

    def save(self, file: Path, write: WritePng = write_png) -> list[Path]:
        """Save the shown picture as PNG, and each eye's picture beside it where there are several.

        Args:
            file: File of the shown picture.
            write: Writes pixels, which are read before this returns.

        Returns:
            The files: FILE.png, then FILE_left.png and so on; for walls one file each and none of all together.
        """
        eyes = [self._save_eye(eye, file, write) for eye in self._eyes if eye.name]
        if self.display.kind in _WALLS:
            return eyes
        write(read_pixels(self.surface), file)
        return [file, *eyes]

    def take_pressed(self) -> Sequence[str]:
        """Return the gamepad buttons pressed on the display's controllers since the last call."""
        return self._ask(lambda display: display.take_pressed())

    @property
    def leaving(self) -> bool:
        """Whether the display requests the end of the session, or one of its windows was closed."""
        return self._ask(lambda display: display.leaving) or (self._beside is not None and self._beside.should_close)

    def take_faults(self) -> list[str]:
        """Return new faults since the last call, a line each; each fault is reported once."""
        return [
            *self._ask(lambda display: display.take_faults()),
            *(self._beside.take_faults() if self._beside is not None else ()),
        ]

    def renew(self) -> None:
        """Create the GPU objects again after the surface's context was lost."""
        self._compose = None
        self._ask(lambda display: display.renew())
        if self._beside is not None:
            self._beside = _BesideWindows(
                self.display, self.surface
            )  # the old windows were lost with the shared context
        if self.drawn is not self.surface:
            self.drawn.renew()

    def release(self) -> None:
        """Free everything but the surface, and close the display."""
        if self._compose is not None:
            self._compose.release()
        if self._beside is not None:
            self._beside.close()
        with suppress(Exception):  # of a library or a third party: everything else is closed after it
            self.display.close()

    def _wanted(self) -> Size:
        return self._ask(lambda display: display.drawn_size(self._fixed or self.surface.size))

    def _read(self) -> U1:
        return read_pixels(self.drawn)

    def _save_eye(self, eye: Eye, file: Path, write: WritePng) -> Path:
        x, y, width, height = eye.rectangle
        pixels = read_pixels(self.surface if self.display.kind in _WALLS else self.drawn)
        top = pixels.shape[0] - y - height
        place = file.with_name(f"{file.stem}_{eye.name}{file.suffix}")
        write(pixels[top : top + height, x : x + width], place)
        return place


def _outside(rectangle: Rect, at: F8) -> float:
    """Return the distance of a point from a rectangle [px], 0 inside."""
    corner, size = np.array(rectangle[:2]), np.array(rectangle[2:])
    return float(np.maximum(np.maximum(corner - at, at - corner - size), 0.0).max())


def _from_rest(head: HeadSource, now_ns: int) -> F8 | None:
    """Return the head pose in the frame of the head at rest."""
    room_from_head = head(now_ns)
    if room_from_head is None:
        return None
    moved = room_from_head.copy()
    moved[1, 3] -= _REST_HEIGHT
    return moved
