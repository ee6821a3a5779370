"""Haptic objects of a session as named tuples of arrays for compiled code.

    Rows          parameters from the main thread (contracts.loop.object_rows), read-only in the loop
    ObjectWork    state of the loop: motion, poses, contact memory, results

Every kernel of the objects takes (rows, work, counts, ...), where `counts` is SCENE.objects; rows beyond it are unused.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import from_dtype, typeof, types
from numpy.typing import NDArray

from mimics_app.compiled.borrowed import borrowed_type
from mimics_app.contracts.arrays import Records
from mimics_app.contracts.loop.haptic_objects import MAX_POINTS, MOTION, OBJECT_COUNTS, TUNNEL
from mimics_app.contracts.loop.loop_fields import MAX_CONTACTS
from mimics_app.contracts.loop.loop_ports import FIELD_PARAMETERS, FIELDS
from mimics_app.contracts.loop.object_rows import ObjectCapacities, new_rows
from mimics_app.rendering.haptic.kernels.directions import MAX_TOUCHED, TOUCHED
from mimics_app.rendering.haptic.kernels.objects.contact_scratch import BEFORE, BIRTH, CONTACT_SCRATCH
from mimics_app.rendering.haptic.kernels.objects.object_inputs import INPUT_LENGTH
from mimics_app.rendering.haptic.kernels.objects.records import (
    DYNAMICS,
    EFFECT_MEMORY,
    MAX_WALLS,
    MEMORY,
    PAIR,
    SCRATCH,
    SOLID,
    SWEEP,
    TRACKING,
    WALL_TOUCH,
    new_grip,
)
from mimics_app.rendering.haptic.kernels.objects.totals import TOTALS
from mimics_app.rendering.haptic.kernels.objects.touches import TOUCH
from mimics_app.rendering.haptic.kernels.tunnel_state import TUNNEL_STATE
from mimics_app.rendering.haptic.mesh_table import MeshTable, build_mesh_table
from mimics_app.rendering.haptic.ridge_table import RidgeTable, build_ridge_table

__all__ = ["OBJECT_WORK", "ROWS", "ROW_STACK", "SIMULATE", "ObjectWork", "new_object_work"]


class ObjectWork(NamedTuple):
    """Private arrays of the loop.

    Attributes:
        motions: MOTION, shape [bodies].
        point_positions: Interaction points of this tick, world [m], shape [MAX_POINTS, 3].
        point_velocities: Their velocities [m/s].
        point_forces: Contact force on each point, without effects and grip, world [N], shape [MAX_POINTS, 3].
        shape_rotations: World from shape, shape [shapes, 3, 3].
        shape_positions: Origin of each shape, world [m], shape [shapes, 3].
        bounds: Bounding spheres as rows x, y, z, radius [m], shape [4, shapes]; radius < 0: never tested (a disabled
            shape), infinite: always tested (a wall).
        aux_forces: F_aux of each body plus the contribution of wires, world [N], shape [bodies, 3].
        aux_torques: T_aux likewise [N m].
        totals: TOTALS of each point of contact, shape [MAX_CONTACTS].
        grip: GRIP of each point of contact, shape [MAX_CONTACTS].
        touches: TOUCH of each point of contact, shape [MAX_CONTACTS, 1 + bodies]: the static scene, then the bodies.
        motion_words: View of `motions` as words, shape [bodies, words].
        force: Force of the objects on each point of contact in this tick, world [N], shape [3 * MAX_CONTACTS].
        inputs: Signals of the person for the objects, shape [INPUT_LENGTH].
        dynamics: DYNAMICS, shape [bodies].
        tracking: TRACKING, shape [1].
        solids: SOLID, shape [shapes].
        moving_shapes: Rows of the shapes of bodies, the first TRACKING.moving in use, shape [shapes].
        effects: EFFECT_MEMORY, shape [effects].
        tunnels: TUNNEL_STATE of each tunnel, shape [tunnels].
        paths: TUNNEL records by EFFECT.path, shape [paths]; filled before the loop starts.
        field_parameters: Parameters of the current force field, shape [FIELD_PARAMETERS].
        field_vectors: Its position, velocity and force, shape [3, 3].
        contact_scratch: CONTACT_SCRATCH of the current point and shape, shape [1].
        memories: MEMORY of each point at each shape, shape [MAX_POINTS, shapes].
        births: BIRTH, shape [shapes].
        befores: BEFORE, shape [bodies].
        near: Rows of the shapes near the current point, shape [shapes].
        walls: WALL_TOUCH of the walls that the current point touches, shape [MAX_WALLS].
        touched: TOUCHED of each point of contact, the first TOTALS.listed in use, shape [MAX_CONTACTS, MAX_TOUCHED].
        margins: Smallest stability margin of each shape in contact, inf: never touched, shape [shapes].
        order: Shapes in the order of the sweep, walls from the end, shape [shapes].
        next_moving: For each place in the order, the next place of a movable shape, shape [shapes].
        pairs: PAIR, shape [`ObjectCapacities.pairs`].
        pair_slots: Hash table of the pairs: rows or -1.
        sweep: SWEEP, shape [1].
        scratch: SCRATCH, shape [1].
        still: MOTION of the static scene, shape [1]: zeros except for its unused forces.
        meshes: Triangle meshes by SHAPE.mesh; built before the loop starts.
        ridges: Their sharp edges; built before the loop starts.
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
    touches: Records
    motion_words: NDArray[np.int64]
    force: NDArray[np.float64]
    inputs: NDArray[np.float64]
    dynamics: Records
    tracking: Records
    solids: Records
    moving_shapes: NDArray[np.int64]
    effects: Records
    tunnels: Records
    paths: Records
    field_parameters: NDArray[np.float64]
    field_vectors: NDArray[np.float64]
    contact_scratch: Records
    memories: Records
    births: Records
    befores: Records
    near: NDArray[np.int64]
    walls: Records
    touched: Records
    margins: NDArray[np.float64]
    order: NDArray[np.int64]
    next_moving: NDArray[np.int64]
    pairs: Records
    pair_slots: NDArray[np.int64]
    sweep: Records
    scratch: Records
    still: Records
    meshes: MeshTable
    ridges: RidgeTable


def new_object_work(capacities: ObjectCapacities, meshes: MeshTable | None = None) -> ObjectWork:
    """Return fresh working arrays; `meshes` are indexed by SHAPE.mesh, None: no meshes."""
    shapes, bodies = capacities.shapes, capacities.bodies
    motions = np.zeros(bodies, MOTION)
    triangles = build_mesh_table() if meshes is None else meshes
    return ObjectWork(
        motions=motions,
        point_positions=np.zeros((MAX_POINTS, 3)),
        point_velocities=np.zeros((MAX_POINTS, 3)),
        point_forces=np.zeros((MAX_POINTS, 3)),
        shape_rotations=np.zeros((shapes, 3, 3)),
        shape_positions=np.zeros((shapes, 3)),
        bounds=np.zeros((4, shapes)),
        aux_forces=np.zeros((bodies, 3)),
        aux_torques=np.zeros((bodies, 3)),
        totals=np.zeros(MAX_CONTACTS, TOTALS),
        grip=new_grip(),
        touches=np.zeros((MAX_CONTACTS, 1 + bodies), TOUCH),
        motion_words=motions.view(np.int64).reshape(bodies, MOTION.itemsize // 8),
        force=np.zeros(3 * MAX_CONTACTS),
        inputs=np.zeros(INPUT_LENGTH),
        dynamics=np.zeros(bodies, DYNAMICS),
        tracking=np.zeros(1, TRACKING),
        solids=np.zeros(shapes, SOLID),
        moving_shapes=np.zeros(shapes, np.int64),
        effects=np.zeros(capacities.effects, EFFECT_MEMORY),
        tunnels=np.zeros(capacities.tunnels, TUNNEL_STATE),
        paths=np.zeros(capacities.paths, TUNNEL),
        field_parameters=np.zeros(FIELD_PARAMETERS),
        field_vectors=np.zeros((3, 3)),
        contact_scratch=np.zeros(1, CONTACT_SCRATCH),
        memories=np.zeros((MAX_POINTS, shapes), MEMORY),
        births=np.zeros(shapes, BIRTH),
        befores=np.zeros(bodies, BEFORE),
        near=np.zeros(shapes, np.int64),
        walls=np.zeros(MAX_WALLS, WALL_TOUCH),
        touched=np.zeros((MAX_CONTACTS, MAX_TOUCHED), TOUCHED),
        margins=np.full(shapes, np.inf),
        order=np.zeros(shapes, np.int64),
        next_moving=np.zeros(shapes, np.int64),
        pairs=np.zeros(capacities.pairs, PAIR),
        pair_slots=np.full(1 << (2 * capacities.pairs).bit_length(), -1, np.int64),
        sweep=np.zeros(1, SWEEP),
        scratch=np.zeros(1, SCRATCH),
        still=np.zeros(1, MOTION),
        meshes=triangles,
        ridges=build_ridge_table(triangles),
    )


_ONE = ObjectCapacities(1, 1, 1, 1, 1)

ROWS = typeof(new_rows(_ONE))  # type: ignore[no-untyped-call]
"""Compiled type of `Rows`: one slot."""

ROW_STACK = typeof(new_rows(_ONE, 1))  # type: ignore[no-untyped-call]
"""Compiled type of `Rows` with several slots, shape [slots, capacity] each."""

OBJECT_WORK = typeof(new_object_work(_ONE))  # type: ignore[no-untyped-call]
"""Compiled type of `ObjectWork`; the same for all capacities."""

_VECTOR = types.float64[::1]

SIMULATE = types.void(
    borrowed_type(ROWS), borrowed_type(OBJECT_WORK), from_dtype(OBJECT_COUNTS), _VECTOR, FIELDS, types.float64, _VECTOR
)
"""Signature of `simulate(rows, work, counts, inputs, fields, dt, force)`, the objects' part of the tick.

It is passed to the loop as a first-class function, so that a scene without objects imports, compiles and runs none of
their code. `inputs` holds the signals of the person (kernels.objects.object_inputs), `force` receives the force on each
point of contact, x y z concatenated.
"""
