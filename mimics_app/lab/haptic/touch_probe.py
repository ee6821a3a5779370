"""Workload of touch: a point on a prescribed path through one of many shapes.

As for the peers: shapes of 2 cm on a square grid of 6 cm, and a point that slides +-4 mm at a depth of 1 mm in the
middle one, with friction.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.compiled.borrowed import borrowed
from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import F8
from mimics_app.contracts.loop.haptic_objects import OBJECT_COUNTS, STATIC, ShapeKind
from mimics_app.contracts.loop.object_rows import ObjectCapacities, Rows, new_rows
from mimics_app.lab.probe import shortest_us
from mimics_app.rendering.haptic.kernels.objects.interaction_points import place_points
from mimics_app.rendering.haptic.kernels.objects.shape_poses import pose_shapes
from mimics_app.rendering.haptic.kernels.objects.totals import clear_totals
from mimics_app.rendering.haptic.kernels.objects.touch import touch_points
from mimics_app.rendering.haptic.mesh_table import build_mesh_table
from mimics_app.rendering.haptic.objects import ObjectWork, new_object_work

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import ObjectCountsRecord, ObjectWork, Rows

__all__ = ["DT", "RADIUS", "STIFFNESS", "TouchScene", "ball_mesh", "slide_path", "touch_scene"]


RADIUS = 0.02
"""Half the size of every shape [m]."""

STIFFNESS = 2000.0
DT = 1e-3

_PITCH = 0.06
_TICKS = 5000
_RUNS = 20  # about a millisecond each: at least one is not interrupted
_APPROACH = 100
_SIZES = {
    ShapeKind.SPHERE: (RADIUS, 0.0, 0.0),
    ShapeKind.BOX: (2 * RADIUS, 2 * RADIUS, 2 * RADIUS),
    ShapeKind.CYLINDER: (RADIUS, 2 * RADIUS, 0.0),
    ShapeKind.CAPSULE: (RADIUS, 2 * RADIUS, 0.0),
    ShapeKind.MESH: (0.0, 0.0, 0.0),
}


@kernel
def _touch_often(
    rows: Rows, work: ObjectWork, counts: ObjectCountsRecord, path: F8, velocities: F8, dt: float, forces: F8
) -> None:
    _touch_borrowed(borrowed(rows), borrowed(work), counts, path, velocities, dt, forces)


@kernel
def _touch_borrowed(
    rows: Rows, work: ObjectWork, counts: ObjectCountsRecord, path: F8, velocities: F8, dt: float, forces: F8
) -> None:
    pose_shapes(rows, work, counts)
    for tick in range(path.shape[0]):
        clear_totals(work.totals[0])
        place_points(rows, work, counts, path[tick], velocities[tick])
        touch_points(rows, work, counts, dt)
        for i in range(3):
            forces[tick, i] = work.totals[0].shape_force[i]


@dataclass(frozen=True, eq=False)
class TouchScene:
    """Shapes, and the path of a point through one of them.

    Attributes:
        rows: Tables of objects.
        work: Working memory of the loop.
        counts: OBJECT_COUNTS, shape [1].
        path: HIP at every tick [m], shape [ticks, 3]; the first hundred lead into the shape.
        velocities: Velocity of the HIP [m/s], shape [ticks, 3].
    """

    rows: Rows
    work: ObjectWork
    counts: NDArray[Any]
    path: F8
    velocities: F8

    def forces(self) -> F8:
        """Return the force on the user at every tick of the path [N], shape [ticks, 3]."""
        forces = np.zeros_like(self.path)
        _touch_often(self.rows, self.work, self.counts[0], self.path, self.velocities, DT, forces)
        return forces

    def cost_us(self) -> float:
        """Return the cost of cull, narrow phase, force and friction of a tick in contact [us]."""
        self.forces()
        path, velocities = self.path[_APPROACH:], self.velocities[_APPROACH:]
        forces = np.zeros_like(path)
        args = (self.rows, self.work, self.counts[0], path, velocities, DT, forces)
        return shortest_us(lambda: _touch_often(*args), len(path), _RUNS)


def ball_mesh(triangles: int) -> tuple[F8, NDArray[np.int32]]:
    """Return vertices and triangles of a ball of RADIUS around the origin; approximate number, of similar size at z."""
    n = max(4, round((0.5 * triangles) ** 0.5))
    polar, around = np.meshgrid(np.linspace(0.0, np.pi, n + 1), np.linspace(0.0, 2.0 * np.pi, n + 1), indexing="ij")
    directions = np.sin(polar) * np.sin(around), np.cos(polar), np.sin(polar) * np.cos(around)
    row, column = np.meshgrid(np.arange(n), np.arange(n), indexing="ij")
    corner = (row * (n + 1) + column).ravel()
    upper = np.stack([corner, corner + n + 1, corner + 1], 1)
    lower = np.stack([corner + 1, corner + n + 1, corner + n + 2], 1)
    return RADIUS * np.stack(directions, -1).reshape(-1, 3), np.concatenate([upper, lower]).astype(np.int32)


def slide_path(top: F8) -> tuple[F8, F8]:
    """Return path and velocities: down along z to 1 mm under `top` [m] in 0.1 s, then around this point for 5 s."""
    ticks = np.arange(_APPROACH + _TICKS)
    t = DT * ticks
    depth = np.where(ticks < _APPROACH, 0.01 - 1.1e-4 * ticks, -1e-3 + 3e-4 * np.sin(2.0 * np.pi * 3.0 * t))
    path = top + np.stack([4e-3 * np.sin(2.0 * np.pi * t), 3e-3 * np.cos(2.0 * np.pi * t), depth], 1)
    velocities = np.gradient(path, DT, axis=0)
    velocities[: _APPROACH + 1] = (0.0, 0.0, -0.11)
    return path, velocities


def touch_scene(kind: ShapeKind, count: int = 1, triangles: int = 0, friction: float = 0.4) -> TouchScene:
    """Return `count` shapes of a kind at rest on a grid; a mesh, the same for all, has roughly `triangles`."""
    capacities = ObjectCapacities(shapes=count, bodies=1, effects=1, wires=1, paths=1)
    meshes = build_mesh_table([ball_mesh(triangles)] if kind == ShapeKind.MESH else [])
    rows, work = new_rows(capacities), new_object_work(capacities, meshes)
    side = max(1, int(np.ceil(np.sqrt(count))))
    places, shapes = np.arange(count), rows.shapes
    shapes["kind"], shapes["body"], shapes["enabled"] = kind, STATIC, 1
    shapes["orientation"][:, 3] = 1.0
    shapes["position"][:, 0] = (places % side) * _PITCH
    shapes["position"][:, 1] = (places // side) * _PITCH
    shapes["size"] = _SIZES[kind]
    shapes["stiffness"], shapes["damping"], shapes["exponent"] = STIFFNESS, 5.0, 1.0
    shapes["friction_static"], shapes["friction_dynamic"] = 1.25 * friction, friction
    rows.points[0]["enabled"] = 1
    counts = np.zeros(1, OBJECT_COUNTS)
    counts["shapes"], counts["points"] = count, 1
    top = shapes["position"][count // 2] + (0.0, 0.0, RADIUS)
    return TouchScene(rows, work, counts, *slide_path(top))
