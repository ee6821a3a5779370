"""Points on prescribed paths through haptic objects: the forces that the kernels of the loop give, tick by tick."""

from __future__ import annotations

from typing import Any

import numpy as np

from mimics_app.compiled.borrowed import borrowed
from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.loop.haptic_objects import MAX_POINTS, OBJECT_COUNTS, ShapeKind
from mimics_app.contracts.loop.object_rows import ObjectCapacities, new_rows
from mimics_app.rendering.haptic.kernels.objects.bodies import place_bodies, step_bodies
from mimics_app.rendering.haptic.kernels.objects.interaction_points import place_points
from mimics_app.rendering.haptic.kernels.objects.shape_poses import pose_shapes
from mimics_app.rendering.haptic.kernels.objects.totals import clear_totals
from mimics_app.rendering.haptic.kernels.objects.touch import touch_points
from mimics_app.rendering.haptic.mesh_table import build_mesh_table
from mimics_app.rendering.haptic.objects import new_object_work
from tests.support.body_play import Play

RIM = 0.02
"""Half of every size of `SOLIDS` [m]."""

SOLIDS: dict[ShapeKind, tuple[float, ...]] = {
    ShapeKind.SPHERE: (RIM,),
    ShapeKind.BOX: (2 * RIM, 2 * RIM, 2 * RIM),
    ShapeKind.CYLINDER: (RIM, 2 * RIM),
    ShapeKind.CAPSULE: (RIM, 2 * RIM),
}
"""One of each solid; at +z their surface is at RIM, and flat along y or bent by RIM at most."""

KINDS = [*SOLIDS, ShapeKind.WALL, ShapeKind.MESH]

BLOCK = np.array([[x, y, z] for x in (-RIM, RIM) for y in (-RIM, RIM) for z in (-RIM, RIM)])
BLOCK_TRIANGLES = np.array(
    [face for a, b, c, d in ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
     for face in ((a, b, c), (a, c, d))]
)  # fmt: skip
"""The box of `SOLIDS` as a mesh."""


def new_touch_play(meshes: Any = ((BLOCK, BLOCK_TRIANGLES),), bodies: int = 8, shapes: int = 32) -> Play:
    """As `new_play`, with meshes for SHAPE.mesh; the first is `BLOCK`."""
    capacities = ObjectCapacities(shapes=shapes, bodies=bodies)
    work = new_object_work(capacities, build_mesh_table(meshes))
    return Play(new_rows(capacities), work, np.zeros(1, OBJECT_COUNTS))


def one_shape(kind: ShapeKind, size: Any = None, radius: float = 0.0, **fields: Any) -> Play:
    """One shape of `SOLIDS`, the wall or the block, undamped unless said, and one point."""
    play = new_touch_play()
    play.add_shape(kind, SOLIDS.get(kind, ()) if size is None else size, **{"damping": 0.0, **fields})
    add_point(play, radius=radius)
    return play


def surface_of(kind: ShapeKind) -> float:
    """Height z of the surface above the origin of the shape [m]."""
    return 0.0 if kind == ShapeKind.WALL else RIM


@kernel
def _follow(rows: Any, work: Any, counts: Any, path: Any, velocities: Any, dt: float, forces: Any, free: bool) -> None:
    rows, work = borrowed(rows), borrowed(work)
    for tick in range(path.shape[0]):
        clear_totals(work.totals[0])
        place_bodies(rows, work, counts)
        pose_shapes(rows, work, counts)
        place_points(rows, work, counts, path[tick], velocities[tick])
        touch_points(rows, work, counts, dt)
        for i in range(3):
            forces[tick, i] = work.totals[0].shape_force[i]
        if free:
            step_bodies(rows, work, counts, dt)


def add_point(play: Play, offset: Any = (0.0, 0.0, 0.0), radius: float = 0.0) -> int:
    k = int(play.counts[0]["points"])
    assert k < MAX_POINTS
    play.rows.points[k]["offset"], play.rows.points[k]["radius"], play.rows.points[k]["enabled"] = offset, radius, 1
    play.counts[0]["points"] += 1
    return k


def follow(play: Play, path: Any, velocities: Any = None, free: bool = False) -> np.ndarray:
    """Forces on the user [N], shape [n, 3], of the HIP on a path [n, 3]; velocities by differences unless given."""
    path = np.atleast_2d(np.asarray(path, float))
    if velocities is None:
        velocities = np.gradient(path, play.dt, axis=0) if len(path) > 1 else np.zeros_like(path)
    velocities = np.broadcast_to(np.asarray(velocities, float), path.shape).copy()
    forces = np.zeros_like(path)
    _follow(play.rows, play.work, play.counts[0], path, velocities, play.dt, forces, free)
    return forces


def at_rest(play: Play, *points: Any) -> np.ndarray:
    """Force [N] at the last of these points, each reached at a tick, the velocity taken as 0."""
    return follow(play, points, np.zeros(3))[-1]


@kernel
def _push(
    rows: Any,
    work: Any,
    counts: Any,
    moving: Any,
    load: Any,
    tremor: Any,
    mass: float,
    drag: float,
    dt: float,
    path: Any,
) -> None:
    """A mass under a load that trembles at 5 Hz: moving is [place, velocity], rows of 3."""
    rows, work = borrowed(rows), borrowed(work)
    for tick in range(path.shape[0]):
        clear_totals(work.totals[0])
        place_bodies(rows, work, counts)
        pose_shapes(rows, work, counts)
        place_points(rows, work, counts, moving[0], moving[1])
        touch_points(rows, work, counts, dt)
        share = np.sin(2.0 * np.pi * 5.0 * tick * dt)
        for i in range(3):
            force = work.totals[0].shape_force[i] + load[i] + share * tremor[i] - drag * moving[1, i]
            moving[1, i] += dt * force / mass
            moving[0, i] += dt * moving[1, i]
            path[tick, i] = moving[0, i]


def push(play: Play, start: Any, load: Any, tremor: Any, seconds: float, mass: float = 3.0, drag: float = 20.0) -> Any:
    """Distance [m], shape [ticks, 3], of a hand of `mass` [kg] on the point, from rest, under load and tremor [N]."""
    path = np.empty((round(seconds / play.dt), 3))
    moving = np.array([start, (0.0, 0.0, 0.0)], float)
    load, tremor = np.asarray(load, float), np.asarray(tremor, float)
    _push(play.rows, play.work, play.counts[0], moving, load, tremor, mass, drag, play.dt, path)
    return path


def energy_taken(path: np.ndarray, forces: np.ndarray) -> float:
    """Work [J] done by the user: every force is held until the next tick."""
    return float(-(forces[:-1] * np.diff(path, axis=0)).sum())
