"""The view that is shown: one of the scene's named cameras, or the flight to it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.errors import nearest
from mimics_app.maths import quat
from mimics_app.rendering.visual.presenting.presenter import SeenFrom
from mimics_app.world.content.world import World
from mimics_app.world.graph.camera import Camera

__all__ = ["ActiveView", "Placed", "view_names"]


@dataclass(frozen=True, slots=True, eq=False)
class Placed:
    """A camera that is no entity's: on the way between two, or moved by a person; see `Camera`."""

    world_from_eye: F8
    vertical_fov: float
    near: float
    far: float


def view_names(world: World) -> list[str]:
    """Return the names of the views, in the order of the scene: those of the entities with a camera."""
    return [camera.node.name for camera in world.cameras]


class ActiveView:
    """The active view.

    Args:
        world: The world; it has a camera.
        name: The first view; "": the first camera.
        flight_s: Duration of the flight from one view to the next [s]; 0: a cut.
        cuts: Show the camera `World.cut_to` for as long as it is set; false where the eyes are the person's own.

    Raises:
        KeyError: The world has no camera of that name; the message names the nearest.
    """

    def __init__(self, world: World, name: str = "", flight_s: float = 0.0, *, cuts: bool = True) -> None:
        self._world, self._flight_ns, self._cuts = world, round(flight_s * 1e9), cuts
        self._from: SeenFrom | None = None
        self._free: Placed | None = None
        self._begun_ns = self._now_ns = 0
        self._camera = self._find(name or view_names(world)[0])

    @property
    def name(self) -> str:
        """Name of the view that is shown, or flown to."""
        return self._camera.node.name

    @property
    def is_free(self) -> bool:
        """Whether a camera of the person's own is shown."""
        return self._free is not None

    def select(self, name: str) -> None:
        """Show a view from the next frame on.

        Raises:
            KeyError: The world has no camera of that name; the message names the nearest.
        """
        wanted = self._find(name)
        if self._flight_ns and wanted != self._camera:
            self._from, self._begun_ns = self._held(), self._now_ns
        self._camera, self._free = wanted, None

    def use_camera(self, camera: Placed) -> None:
        """Show what a camera of the person's own sees from the next frame on, until a view is selected."""
        self._free = camera

    def advance(self, now_ns: int) -> None:
        """Continue a flight at session time `now_ns` [ns]."""
        self._now_ns = now_ns
        if now_ns - self._begun_ns >= self._flight_ns:
            self._from = None

    @property
    def camera(self) -> SeenFrom:
        """The camera to draw from: the person's own, that of a cut, that of the view, or one on the way to it."""
        if self._free is not None:
            return self._free
        if self._cuts and self._world.cut_to:
            return self._find(self._world.cut_to)
        if self._from is None:
            return self._camera
        share = (self._now_ns - self._begun_ns) / self._flight_ns
        return _between(self._from, self._camera, share * share * (3.0 - 2.0 * share))

    def _held(self) -> SeenFrom:
        """Return the camera as it is now, which stays when its entity moves on."""
        now = self.camera
        return Placed(now.world_from_eye, now.vertical_fov, now.near, now.far)

    def _find(self, name: str) -> Camera:
        cameras = {camera.node.name: camera for camera in self._world.cameras}
        if name not in cameras:
            raise KeyError(f'no camera "{name}"; {nearest(name, cameras)}')
        return cameras[name]


def _between(begin: SeenFrom, end: SeenFrom, share: float) -> SeenFrom:
    """Return a camera at a share of the way: places on a line, rotations on the shortest arc."""
    pose, turns = np.eye(4), np.empty((3, 4))
    quat.from_matrix(begin.world_from_eye[:3, :3], turns[0])
    quat.from_matrix(end.world_from_eye[:3, :3], turns[1])
    quat.slerp(turns[0], turns[1], share, turns[2])
    quat.to_matrix(turns[2], pose[:3, :3])
    pose[:3, 3] = (1.0 - share) * begin.world_from_eye[:3, 3] + share * end.world_from_eye[:3, 3]
    fov = (1.0 - share) * begin.vertical_fov + share * end.vertical_fov
    return Placed(pose, fov, min(begin.near, end.near), max(begin.far, end.far))
