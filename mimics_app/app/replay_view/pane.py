"""Pictures of replayed runs: one fills the surface, two stand side by side."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from mimics_app.app.picture.active_view import Placed
from mimics_app.app.picture.force_arrows import SEEN_NS, ForceArrows
from mimics_app.app.picture.orbit_camera import OrbitCamera
from mimics_app.app.picture.picture import Picture
from mimics_app.app.picture.shown_on import open_display
from mimics_app.app.replay_view.replayed_scene import ReplayedScene
from mimics_app.contracts.arrays import F8
from mimics_app.rendering.visual.materials.shader_library import ShaderLibrary
from mimics_app.rendering.visual.overlay.layers import Arrow
from mimics_app.rendering.visual.passes.screen import ScreenPass
from mimics_app.rendering.visual.presenting.presenter import SeenFrom
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.surfaces.eye_buffer import EyeBuffer
from mimics_app.rendering.visual.surfaces.surface import Surface

__all__ = ["Panes", "QualityOf"]

QualityOf = Callable[[ReplayedScene, Surface], RenderSettings]
"""Returns the quality of the picture of a run on a surface."""

_NEAREST_M = 0.05
"""Least distance from the point [m]."""


class _Pane:
    """The picture of one run."""

    def __init__(self, replayed: ReplayedScene, surface: Surface, quality: RenderSettings, camera: str) -> None:
        self.replayed = replayed
        display = open_display(replayed.scene, "desktop", surface)  # also of a run on walls or in a headset
        self.picture = Picture(surface, replayed.scene, replayed.world, quality, camera, display)

    def draw(self, now_ns: int) -> None:
        """Draw the newest frame, from a view that flies by a time [ns]."""
        picture, replayed = self.picture, self.replayed
        if picture.renderer.world is not replayed.world:
            picture.show(replayed.scene, replayed.world)
        if picture.renderer.shows("forces"):
            picture.renderer.overlay.arrows = _arrows_of(replayed)
        picture.draw(replayed.board, now_ns)


class Panes:
    """The pictures of one run or of two on a surface.

    Args:
        surface: The surface; closed with the pictures.
        runs: The runs, one or two.
        quality: Quality of the picture of a run.
        camera: Entity whose camera is shown first, "": as each scene says.
        forces: Whether forces and contacts are drawn from the beginning on.

    Raises:
        SceneError: A scene has no camera of that name.
    """

    def __init__(
        self, surface: Surface, runs: Sequence[ReplayedScene], quality: QualityOf, camera: str, *, forces: bool
    ) -> None:
        self._surface = surface
        self._buffers = [EyeBuffer(surface, self._half) for _ in runs] if len(runs) > 1 else []
        drawn: Sequence[Surface] = self._buffers or [surface]
        self._panes = [_Pane(run, on, quality(run, on), camera) for run, on in zip(runs, drawn, strict=True)]
        self._copy = ScreenPass(surface.ctx, ShaderLibrary(surface.ctx), "post/resample.frag")
        if forces:
            self.toggle_forces()

    @property
    def pictures(self) -> list[Picture]:
        """The pictures."""
        return [pane.picture for pane in self._panes]

    @property
    def views(self) -> list[str]:
        """Names of the views that every run has, in the order of the first one's scene."""
        named = [[camera.node.name for camera in pane.replayed.world.cameras] for pane in self._panes]
        return [name for name in named[0] if all(name in names for names in named)]

    @property
    def view(self) -> str:
        """Name of the view that is shown, or flown to."""
        return self.pictures[0].view.name

    def show_view(self, name: str) -> None:
        """Show a view of `views` from the next frame on."""
        for picture in self.pictures:
            picture.show_view(name)

    @property
    def is_free(self) -> bool:
        """Whether a free camera is shown instead of a view."""
        return self.pictures[0].view.is_free

    def orbit(self, right_px: float, up_px: float) -> None:
        """Turn a free camera around the hand by a movement of the pointer [px]; it begins at the view that is shown."""
        self._move(lambda camera: camera.orbit(right_px, up_px))

    def zoom(self, steps: float) -> None:
        """Bring the free camera nearer to the hand by steps of the wheel."""
        self._move(lambda camera: camera.zoom(steps))

    def _move(self, move: Callable[[OrbitCamera], None]) -> None:
        first = self._panes[0]
        camera = _around_point(self.pictures[0].view.camera, first.replayed.hand)
        move(camera)
        for picture in self.pictures:
            picture.view.use_camera(_placed(camera))

    def toggle_forces(self) -> None:
        """Draw forces and contacts from the next frame on, or no longer."""
        for picture in self.pictures:
            picture.renderer.overlay.toggle("forces")

    def draw(self, now_ns: int) -> None:
        """Draw the newest frame of every run, from views that fly by a time [ns]."""
        for buffer in self._buffers:
            buffer.resize(self._half)
        for pane in self._panes:
            pane.draw(now_ns)
        if self._buffers:
            self._put_beside()

    def close(self) -> None:
        """Free everything, the surface included."""
        self._copy.release()
        for picture in self.pictures:
            picture.close()
        if self._buffers:
            self._surface.close()

    def _put_beside(self) -> None:
        """Copy the pictures of the runs into the halves of the surface."""
        width, height = self._half
        self._surface.drawn_by = self
        self._surface.framebuffer.use()
        for number, buffer in enumerate(self._buffers):
            self._copy.draw(buffer.texture, (0, 0, width, height), (number * width, 0, width, height))

    @property
    def _half(self) -> tuple[int, int]:
        width, height = self._surface.size
        return max(1, width // 2), height


def _arrows_of(replayed: ReplayedScene) -> list[Arrow]:
    """Return the arrows of the newest frame, with the contacts before it that still fade."""
    arrows, found = ForceArrows(), []
    for frame in replayed.recent(SEEN_NS):
        found = arrows.of(frame.snapshot, frame.events, frame.now_ns)
    return found


def _around_point(camera: SeenFrom, point: F8) -> OrbitCamera:
    """Return an orbit camera at a camera's place that looks at a point.

    Args:
        camera: The camera.
        point: Centre of the orbit, world [m], float64 [3].
    """
    away = camera.world_from_eye[:3, 3] - point
    orbit = OrbitCamera()
    orbit.target, orbit.distance = point.copy(), max(float(np.linalg.norm(away)), _NEAREST_M)
    orbit.yaw = math.atan2(away[0], away[2])
    orbit.pitch = math.asin(min(1.0, max(-1.0, away[1] / orbit.distance)))
    orbit.fov, orbit.near, orbit.far = camera.vertical_fov, camera.near, camera.far
    return orbit


def _placed(orbit: OrbitCamera) -> Placed:
    """Return what an orbit camera sees, for a picture."""
    return Placed(orbit.pose, orbit.fov, orbit.near, orbit.far)
