"""The haptic objects of a session as tuples of arrays that compiled code can take.

    Rows          what the main thread wants: views into one slot of the parameter blocks, read only in the loop
    ObjectWork    what the loop makes of it: motion, poses, contact memory, results

Every kernel of the objects takes (rows, work, counts, ...), `counts` being SCENE.objects; rows beyond it mean nothing.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numba import from_dtype, types
from numpy.typing import NDArray

from mimics_app.contracts.haptic import TUNNEL
from mimics_app.contracts.haptic_objects import BODY, EFFECT, MAX_POINTS, MOTION, POINT, SHAPE, WIRE
from mimics_app.contracts.loop_ports import FIELD_PARAMETERS
from mimics_app.rendering.haptic.kernels.objects.corner import MOST_WALLS, WALL_TOUCH
from mimics_app.rendering.haptic.kernels.objects.desk import BEFORE, BIRTH, DESK
from mimics_app.rendering.haptic.kernels.objects.effect_memory import EFFECT_MEMORY
from mimics_app.rendering.haptic.kernels.objects.grip import GRIP, new_grip
from mimics_app.rendering.haptic.kernels.objects.inertia import DYNAMICS
from mimics_app.rendering.haptic.kernels.objects.manifold import SCRATCH
from mimics_app.rendering.haptic.kernels.objects.memory import MEMORY
from mimics_app.rendering.haptic.kernels.objects.pairs import PAIR
from mimics_app.rendering.haptic.kernels.objects.poses import SOLID, TRACKING
from mimics_app.rendering.haptic.kernels.objects.sweep import SWEEP
from mimics_app.rendering.haptic.kernels.objects.totals import TOTALS
from mimics_app.rendering.haptic.mesh_table import MESH_TABLE, MeshTable, build_mesh_table

__all__ = ["OBJECT_WORK", "ROWS", "ObjectCapacities", "ObjectWork", "Rows", "new_object_work", "new_rows"]

Records = NDArray[Any]

_NEIGHBOURS = 24
"""Pairs to a shape: in a heap of equal cubes each has 26 neighbours, so 13 pairs; the rest is for unequal ones."""


@dataclass(frozen=True, slots=True)
class ObjectCapacities:
    """Rows of each table, fixed when the session is built."""

    shapes: int = 32
    bodies: int = 8
    effects: int = 16
    wires: int = 32
    paths: int = 4

    @property
    def pairs(self) -> int:
        """Pairs of shapes near each other: all there are, or as many as lie around each in a heap."""
        return max(1, min(self.shapes * (self.shapes - 1) // 2, _NEIGHBOURS * self.shapes))


class Rows(NamedTuple):
    """Rows of the main thread; dtypes of the same names in capitals."""

    shapes: Records
    bodies: Records
    effects: Records
    points: Records
    wires: Records


class ObjectWork(NamedTuple):
    """Arrays of the loop alone.

    Attributes:
        motions: MOTION, shape [bodies].
        point_positions: Interaction points of this tick, world [m], shape [MAX_POINTS, 3].
        point_velocities: Likewise [m/s].
        point_forces: What each point feels, without effects and grip, world [N], shape [MAX_POINTS, 3].
        shape_rotations: World from shape, shape [shapes, 3, 3].
        shape_positions: Origin of each shape, world [m], shape [shapes, 3].
        bounds: Bounding spheres as rows x, y, z, radius [m], shape [4, shapes]; a radius < 0 is never touched (a
            disabled shape), an infinite one always looked at (a wall).
        aux_forces: F_aux of each body with what wires add, world [N], shape [bodies, 3].
        aux_torques: T_aux likewise [N m].
        totals: TOTALS, shape [1].
        grip: GRIP, shape [1].
        dynamics: DYNAMICS, shape [bodies].
        tracking: TRACKING, shape [1].
        solids: SOLID, shape [shapes].
        moving_shapes: Rows of the shapes of bodies; TRACKING.moving says how many, shape [shapes].
        effects: EFFECT_MEMORY, shape [effects].
        paths: TUNNEL records by EFFECT.path, shape [paths]; filled before the loop starts.
        field_parameters: What a force field is given, shape [FIELD_PARAMETERS].
        field_vectors: Likewise place and velocity, and the force it gives, shape [3, 3].
        desk: DESK, shape [1]: the point and the shape at hand.
        memories: MEMORY of each point at each shape, shape [MAX_POINTS, shapes].
        births: BIRTH, shape [shapes].
        befores: BEFORE, shape [bodies].
        near: Rows of the shapes near the point at hand, shape [shapes].
        walls: WALL_TOUCH, shape [MOST_WALLS]: walls that the point at hand touches.
        order: Shapes in the order of the sweep, walls from the back, shape [shapes].
        next_moving: For each place in the order, the next of a shape that can move.
        pairs: PAIR, shape [`ObjectCapacities.pairs`].
        pair_slots: Hash of the pairs, rows or -1.
        sweep: SWEEP, shape [1].
        scratch: SCRATCH, shape [1].
        still: MOTION of the static scene, shape [1]: zeros, but for forces nobody reads.
        meshes: Triangles by SHAPE.mesh; built before the loop starts.
    """

    motions: Records
    point_positions: NDArray[np.float64]
    point_velocities: NDArray[np.float64]
    point_forces: NDArray[np.float64]
    shape_rotations: NDArray[np.float64]
    shape_positions: NDArray[np.float64]
    bounds: NDArray[np.float64]
    aux_forces: NDArray[np.float64]
    aux_torques: NDArray[np.float64]
    totals: Records
    grip: Records
    dynamics: Records
    tracking: Records
    solids: Records
    moving_shapes: NDArray[np.int64]
    effects: Records
    paths: Records
    field_parameters: NDArray[np.float64]
    field_vectors: NDArray[np.float64]
    desk: Records
    memories: Records
    births: Records
    befores: Records
    near: NDArray[np.int64]
    walls: Records
    order: NDArray[np.int64]
    next_moving: NDArray[np.int64]
    pairs: Records
    pair_slots: NDArray[np.int64]
    sweep: Records
    scratch: Records
    still: Records
    meshes: MeshTable


def new_rows(capacities: ObjectCapacities) -> Rows:
    """Empty rows."""
    return Rows(
        shapes=np.zeros(capacities.shapes, SHAPE),
        bodies=np.zeros(capacities.bodies, BODY),
        effects=np.zeros(capacities.effects, EFFECT),
        points=np.zeros(MAX_POINTS, POINT),
        wires=np.zeros(capacities.wires, WIRE),
    )


def new_object_work(capacities: ObjectCapacities, meshes: MeshTable | None = None) -> ObjectWork:
    """Fresh working arrays; `meshes` are those that SHAPE.mesh refers to, None: none."""
    shapes, bodies = capacities.shapes, capacities.bodies
    return ObjectWork(
        motions=np.zeros(bodies, MOTION),
        point_positions=np.zeros((MAX_POINTS, 3)),
        point_velocities=np.zeros((MAX_POINTS, 3)),
        point_forces=np.zeros((MAX_POINTS, 3)),
        shape_rotations=np.zeros((shapes, 3, 3)),
        shape_positions=np.zeros((shapes, 3)),
        bounds=np.zeros((4, shapes)),
        aux_forces=np.zeros((bodies, 3)),
        aux_torques=np.zeros((bodies, 3)),
        totals=np.zeros(1, TOTALS),
        grip=new_grip(),
        dynamics=np.zeros(bodies, DYNAMICS),
        tracking=np.zeros(1, TRACKING),
        solids=np.zeros(shapes, SOLID),
        moving_shapes=np.zeros(shapes, np.int64),
        effects=np.zeros(capacities.effects, EFFECT_MEMORY),
        paths=np.zeros(capacities.paths, TUNNEL),
        field_parameters=np.zeros(FIELD_PARAMETERS),
        field_vectors=np.zeros((3, 3)),
        desk=np.zeros(1, DESK),
        memories=np.zeros((MAX_POINTS, shapes), MEMORY),
        births=np.zeros(shapes, BIRTH),
        befores=np.zeros(bodies, BEFORE),
        near=np.zeros(shapes, np.int64),
        walls=np.zeros(MOST_WALLS, WALL_TOUCH),
        order=np.zeros(shapes, np.int64),
        next_moving=np.zeros(shapes, np.int64),
        pairs=np.zeros(capacities.pairs, PAIR),
        pair_slots=np.full(1 << (2 * capacities.pairs).bit_length(), -1, np.int64),
        sweep=np.zeros(1, SWEEP),
        scratch=np.zeros(1, SCRATCH),
        still=np.zeros(1, MOTION),
        meshes=build_mesh_table() if meshes is None else meshes,
    )


def _records(dtype: np.dtype[Any]) -> Any:
    return from_dtype(dtype)[::1]


_TABLE = types.float64[:, ::1]

ROWS = types.NamedTuple(  # type: ignore[no-untyped-call]
    [_records(SHAPE), _records(BODY), _records(EFFECT), _records(POINT), _records(WIRE)], Rows
)
"""Compiled type of `Rows`, field by field."""

OBJECT_WORK = types.NamedTuple(  # type: ignore[no-untyped-call]
    [
        _records(MOTION),
        _TABLE,
        _TABLE,
        _TABLE,
        types.float64[:, :, ::1],
        _TABLE,
        _TABLE,
        _TABLE,
        _TABLE,
        _records(TOTALS),
        _records(GRIP),
        _records(DYNAMICS),
        _records(TRACKING),
        _records(SOLID),
        types.int64[::1],
        _records(EFFECT_MEMORY),
        _records(TUNNEL),
        types.float64[::1],
        _TABLE,
        _records(DESK),
        from_dtype(MEMORY)[:, ::1],
        _records(BIRTH),
        _records(BEFORE),
        types.int64[::1],
        _records(WALL_TOUCH),
        types.int64[::1],
        types.int64[::1],
        _records(PAIR),
        types.int64[::1],
        _records(SWEEP),
        _records(SCRATCH),
        _records(MOTION),
        MESH_TABLE,
    ],
    ObjectWork,
)
"""Compiled type of `ObjectWork`, field by field."""
