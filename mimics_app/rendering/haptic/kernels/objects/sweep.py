"""Which shapes are near each other: sweep and prune along one axis, made anew only when something has moved far enough.

Each shape has a room in which it may move freely; while all stay in theirs the list of pairs holds. When one leaves,
rooms are drawn anew (larger for fast bodies), the order along the axis is kept by insertion (bodies move little: few
exchanges), and the sweep finds what overlaps. Pairs of the static scene are never looked at; walls are tested against
each moving shape by its room. Cost: O(n) a tick, and now and then O(n + pairs).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mimics_app.contracts.arrays import I8
from mimics_app.contracts.haptic_objects import STATIC, ShapeKind
from mimics_app.contracts.kernel import kernel
from mimics_app.rendering.haptic.kernels.objects.bodies import is_free
from mimics_app.rendering.haptic.kernels.objects.pairs import add_pair, drop_pairs, forget_pairs, join_surfaces

if TYPE_CHECKING:
    from mimics_app.contracts.record_types import (
        BodyRecord,
        DynamicsRecord,
        Floats,
        MeshRecord,
        MotionRecord,
        ObjectCountsRecord,
        PairRecord,
        ShapeRecord,
        SolidRecord,
        SweepRecord,
        Table,
        TrackingRecord,
    )

__all__ = ["find_pairs", "near"]


_MARGIN = 0.05
"""Room around a shape, as a share of its bounding radius."""

_AHEAD = 10.0
"""Ticks of motion that a room leaves space for."""

_SPREAD = 4.0
"""The sweep changes its axis when shapes are spread so many times wider (in variance) along another."""


@kernel
def near(a: SolidRecord, b: SolidRecord) -> bool:
    """True when the bounds of two SOLIDs overlap."""
    for k in range(3):
        if a.low[k] > b.high[k] or b.low[k] > a.high[k]:
            return False
    return True


@kernel
def _may_come_near(a: SolidRecord, b: SolidRecord) -> bool:
    """True for shapes of different bodies whose rooms overlap."""
    for k in range(3):
        if a.room_low[k] > b.room_high[k] or b.room_low[k] > a.room_high[k]:
            return False
    return a.body != b.body


@kernel
def _extent(solid: SolidRecord, k: int) -> float:
    """Half of a shape's extent along world axis k [m]; inf for one without bounds."""
    size, R = solid.size, solid.rotation
    if solid.kind == ShapeKind.BOX:
        return 0.5 * (size[0] * abs(R[k, 0]) + size[1] * abs(R[k, 1]) + size[2] * abs(R[k, 2]))
    if solid.kind == ShapeKind.SPHERE:
        return size[0]
    upright = abs(R[k, 1])
    if solid.kind == ShapeKind.CAPSULE:
        return 0.5 * size[1] * upright + size[0]
    if solid.kind == ShapeKind.CYLINDER:
        return 0.5 * size[1] * upright + size[0] * math.sqrt(max(0.0, 1.0 - upright * upright))
    return math.inf


@kernel
def _bound(solid: SolidRecord) -> None:
    for k in range(3):
        reach = _extent(solid, k)
        solid.low[k] = solid.position[k] - reach
        solid.high[k] = solid.position[k] + reach


@kernel
def _bound_mesh(solid: SolidRecord, mesh: MeshRecord, boxes: Floats) -> None:
    """Bounds of a mesh, by the box of its whole tree."""
    R, node = solid.rotation, mesh.first_node
    for k in range(3):
        place, reach = solid.position[k], 0.0
        for j in range(3):
            place += 0.5 * R[k, j] * (boxes[node, j] + boxes[node, j + 3])
            reach += 0.5 * abs(R[k, j]) * (boxes[node, j + 3] - boxes[node, j])
        solid.low[k] = place - reach
        solid.high[k] = place + reach


@kernel
def _bound_any(solid: SolidRecord, meshes: Table[MeshRecord], boxes: Floats) -> None:
    if solid.kind == ShapeKind.MESH:
        _bound_mesh(solid, meshes[solid.mesh], boxes)
    else:
        _bound(solid)


@kernel
def _draw_room(solid: SolidRecord, room: float) -> None:
    for k in range(3):
        solid.room_low[k] = solid.low[k] - room
        solid.room_high[k] = solid.high[k] + room


@kernel
def _room_of(solid: SolidRecord, motion: MotionRecord, dt: float) -> float:
    """How far a moving shape may go [m]."""
    v, w = motion.velocity, motion.omega
    radius = solid.radius
    if solid.kind == ShapeKind.MESH:
        radius = 0.0
        for k in range(3):
            radius = max(radius, 0.5 * (solid.high[k] - solid.low[k]))
    speed = math.sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])
    speed += radius * math.sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2])
    return _MARGIN * radius + _AHEAD * dt * speed


@kernel
def _has_left(solid: SolidRecord) -> bool:
    """True when a shape is no longer in its room; one that is nowhere (not finite) has left too."""
    for k in range(3):
        if not (solid.room_low[k] <= solid.low[k] and solid.high[k] <= solid.room_high[k]):
            return True
    return False


@kernel
def _take_shapes(
    solids: Table[SolidRecord], meshes: Table[MeshRecord], boxes: Floats, order: I8, sweep: SweepRecord, count: int
) -> None:
    """Fill the order from changed rows: enabled shapes with bounds from the front, walls from the back."""
    sweep.sorted = 0
    sweep.walls = 0
    for i in range(count):
        solid = solids[i]
        if not solid.enabled:
            continue
        if solid.kind == ShapeKind.WALL:
            sweep.walls += 1
            order[order.shape[0] - sweep.walls] = i
            continue
        _bound_any(solid, meshes, boxes)
        _draw_room(solid, 0.0)
        if math.isfinite(solid.low[0]):
            order[sweep.sorted] = i
            sweep.sorted += 1


@kernel
def _choose_axis(solids: Table[SolidRecord], order: I8, sweep: SweepRecord) -> None:
    """Sweep along the axis the shapes are spread widest on."""
    widest, spread = sweep.axis, 0.0
    for turn in range(3):
        k = (sweep.axis + turn) % 3
        total, squares = 0.0, 0.0
        for n in range(sweep.sorted):
            place = solids[order[n]].room_low[k]
            total += place
            squares += place * place
        variance = squares - total * total / max(1, sweep.sorted)
        if variance > (spread if turn == 0 else _SPREAD * spread):
            widest, spread = k, variance
    sweep.axis = widest


@kernel
def _mend_order(solids: Table[SolidRecord], order: I8, sweep: SweepRecord) -> None:
    """Insertion sort by the lower end of the rooms."""
    k = sweep.axis
    for n in range(1, sweep.sorted):
        i = order[n]
        key = solids[i].room_low[k]
        at = n - 1
        while at >= 0 and solids[order[at]].room_low[k] > key:
            order[at + 1] = order[at]
            at -= 1
        order[at + 1] = i


@kernel
def _can_move(bodies: Table[BodyRecord], solid: SolidRecord) -> bool:
    return solid.body != STATIC and is_free(bodies[solid.body])


@kernel
def _link_moving(
    bodies: Table[BodyRecord], solids: Table[SolidRecord], order: I8, following: I8, sweep: SweepRecord
) -> None:
    """For each place in the order, the next place of a shape that can move."""
    after = sweep.sorted
    for n in range(sweep.sorted - 1, -1, -1):
        following[n] = after
        if _can_move(bodies, solids[order[n]]):
            after = n


@kernel
def _reaches_wall(solid: SolidRecord, wall: SolidRecord) -> bool:
    """True when the room of a shape dips into a wall's half-space, and the two are not of one body."""
    height, reach = 0.0, 0.0
    for k in range(3):
        n = wall.rotation[k, 2]
        height += n * (0.5 * (solid.room_low[k] + solid.room_high[k]) - wall.position[k])
        reach += abs(n) * 0.5 * (solid.room_high[k] - solid.room_low[k])
    return height < reach and solid.body != wall.body


@kernel
def _add(i: int, j: int, shapes: Table[ShapeRecord], pairs: Table[PairRecord], slots: I8, sweep: SweepRecord) -> None:
    count = add_pair(i, j, shapes, pairs, slots, sweep.pairs)
    if count < 0:
        sweep.left_out += 1
    else:
        sweep.pairs = count


@kernel
def _sweep(
    bodies: Table[BodyRecord],
    shapes: Table[ShapeRecord],
    solids: Table[SolidRecord],
    order: I8,
    following: I8,
    pairs: Table[PairRecord],
    slots: I8,
    sweep: SweepRecord,
) -> None:
    """Keep or begin a pair of all shapes whose rooms overlap and of which one can move."""
    k = sweep.axis
    for n in range(sweep.sorted):
        i = order[n]
        solid = solids[i]
        moves = _can_move(bodies, solid)
        m = n + 1 if moves else following[n]
        while m < sweep.sorted and solids[order[m]].room_low[k] <= solid.room_high[k]:
            if _may_come_near(solid, solids[order[m]]):
                _add(i, order[m], shapes, pairs, slots, sweep)
            m = m + 1 if moves else following[m]
        if moves:
            for w in range(order.shape[0] - sweep.walls, order.shape[0]):
                if _reaches_wall(solid, solids[order[w]]):
                    _add(i, order[w], shapes, pairs, slots, sweep)


@kernel
def _look(
    solids: Table[SolidRecord],
    meshes: Table[MeshRecord],
    boxes: Floats,
    motions: Table[MotionRecord],
    moving: I8,
    tracking: TrackingRecord,
) -> bool:
    """Bounds of what is awake; True when a shape has left its room."""
    stale = False
    for n in range(tracking.moving):
        solid = solids[moving[n]]
        if solid.enabled and motions[solid.body].asleep == 0:
            _bound_any(solid, meshes, boxes)
            stale = stale or _has_left(solid)
    return stale


@kernel
def _forget_placed(pairs: Table[PairRecord], dynamics: Table[DynamicsRecord], sweep: SweepRecord, count: int) -> None:
    """Drop what pairs remember of bodies that were put somewhere else."""
    placed = False
    for k in range(count):
        placed = placed or dynamics[k].placed != 0
    if not placed:
        return
    forget_pairs(pairs, sweep.pairs, dynamics)
    for k in range(count):
        dynamics[k].placed = 0


@kernel
def _prepare(
    solids: Table[SolidRecord],
    motions: Table[MotionRecord],
    moving: I8,
    pairs: Table[PairRecord],
    tracking: TrackingRecord,
    sweep: SweepRecord,
    dt: float,
) -> None:
    """Draw the rooms of what moves anew, and take all pairs as not found yet."""
    sweep.remade += 1
    sweep.left_out = 0
    for n in range(tracking.moving):
        solid = solids[moving[n]]
        if solid.enabled:
            _draw_room(solid, _room_of(solid, motions[solid.body], dt))
    for k in range(sweep.pairs):
        pairs[k].kept = 0


@kernel
def _join_anew(shapes: Table[ShapeRecord], pairs: Table[PairRecord], count: int) -> None:
    """Surfaces of all pairs from rows that changed; contacts go on."""
    for k in range(count):
        pair = pairs[k]
        pair.body_a, pair.body_b = shapes[pair.a].body, shapes[pair.b].body
        join_surfaces(shapes[pair.a], shapes[pair.b], pair)


@kernel
def find_pairs(
    bodies: Table[BodyRecord],
    shapes: Table[ShapeRecord],
    motions: Table[MotionRecord],
    dynamics: Table[DynamicsRecord],
    solids: Table[SolidRecord],
    meshes: Table[MeshRecord],
    boxes: Floats,
    moving: I8,
    order: I8,
    following: I8,
    pairs: Table[PairRecord],
    slots: I8,
    tracking: TrackingRecord,
    sweep: SweepRecord,
    counts: ObjectCountsRecord,
    dt: float,
) -> None:
    """Bring the list of pairs up to date: `pairs`, of which `sweep.pairs` count.

    Args:
        bodies: BODY rows.
        shapes: SHAPE rows.
        motions: MOTION rows.
        dynamics: DYNAMICS rows; `placed` is cleared.
        solids: SOLID rows, posed; their bounds are updated.
        meshes: MeshTable.rows.
        boxes: MeshTable.boxes.
        moving: ObjectWork.moving_shapes.
        order: ObjectWork.order, updated.
        following: ObjectWork.next_moving, updated.
        pairs: PAIR rows, updated.
        slots: ObjectWork.pair_slots, updated.
        tracking: TRACKING.
        sweep: SWEEP, updated.
        counts: SCENE.objects.
        dt: Tick [s].
    """
    changed = tracking.paired_revision != counts.revision + 1
    if changed:
        tracking.paired_revision = counts.revision + 1
        _take_shapes(solids, meshes, boxes, order, sweep, counts.shapes)
    stale = _look(solids, meshes, boxes, motions, moving, tracking) or changed
    _forget_placed(pairs, dynamics, sweep, counts.bodies)
    if not stale:
        return
    _prepare(solids, motions, moving, pairs, tracking, sweep, dt)
    _choose_axis(solids, order, sweep)
    _mend_order(solids, order, sweep)
    _link_moving(bodies, solids, order, following, sweep)
    _sweep(bodies, shapes, solids, order, following, pairs, slots, sweep)
    sweep.pairs = drop_pairs(pairs, slots, sweep.pairs)
    if changed:
        _join_anew(shapes, pairs, sweep.pairs)
