"""Broad phase of the collisions: sweep and prune along one axis, repeated only when a shape has left its fat AABB.

While all shapes stay in their fat AABBs the list of pairs is valid. When one leaves, the fat AABBs of moving shapes are
updated (larger for fast bodies), the order along the axis is repaired by insertion sort (few exchanges, as bodies move
little), and the sweep finds the overlaps. Pairs of two static shapes are never tested; walls are tested against the fat
AABB of each moving shape. Cost: O(n) per tick, and O(n + pairs) when the sweep is repeated.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import I8
from mimics_app.contracts.loop.haptic_objects import STATIC, ShapeKind
from mimics_app.maths.vec import norm
from mimics_app.rendering.haptic.kernels.objects.bodies import is_free
from mimics_app.rendering.haptic.kernels.objects.pairs import add_pair, drop_pairs, forget_pairs, join_surfaces

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import (
        BodyRecord,
        DynamicsRecord,
        Floats,
        MeshRecord,
        MotionRecord,
        ObjectCountsRecord,
        ObjectWork,
        PairRecord,
        Rows,
        ShapeRecord,
        SolidRecord,
        SweepRecord,
        Table,
        TrackingRecord,
    )

__all__ = ["find_pairs", "near"]


_MARGIN = 0.05
"""Margin of a fat AABB, relative to the bounding radius of the shape [-]."""

_AHEAD = 10.0
"""Ticks of motion by which a fat AABB is enlarged."""

_SPREAD = 4.0
"""Ratio of variances from which the sweep changes to an axis of wider spread [-]."""


@kernel
def near(a: SolidRecord, b: SolidRecord) -> bool:
    """True when the AABBs of two SOLIDs overlap."""
    for k in range(3):
        if a.low[k] > b.high[k] or b.low[k] > a.high[k]:
            return False
    return True


@kernel
def _may_come_near(a: SolidRecord, b: SolidRecord) -> bool:
    """True for shapes of different bodies whose fat AABBs overlap."""
    for k in range(3):
        if a.fat_low[k] > b.fat_high[k] or b.fat_low[k] > a.fat_high[k]:
            return False
    return a.body != b.body


@kernel
def _extent(solid: SolidRecord, k: int) -> float:
    """Half of a shape's extent along world axis k [m]; inf for an unbounded one."""
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
    """Set the AABB of an analytic shape."""
    for k in range(3):
        reach = _extent(solid, k)
        solid.low[k] = solid.position[k] - reach
        solid.high[k] = solid.position[k] + reach


@kernel
def _bound_mesh(solid: SolidRecord, mesh: MeshRecord, boxes: Floats) -> None:
    """Set the AABB of a mesh from the root of its BVH."""
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
    """Set the AABB of any shape."""
    if solid.kind == ShapeKind.MESH:
        _bound_mesh(solid, meshes[solid.mesh], boxes)
    else:
        _bound(solid)


@kernel
def _fatten(solid: SolidRecord, margin: float) -> None:
    """Set the fat AABB: the AABB with a margin [m]."""
    for k in range(3):
        solid.fat_low[k] = solid.low[k] - margin
        solid.fat_high[k] = solid.high[k] + margin


@kernel
def _margin_of(solid: SolidRecord, motion: MotionRecord, dt: float) -> float:
    """Margin of the fat AABB of a moving shape [m]."""
    v, w = motion.velocity, motion.omega
    radius = solid.radius
    if solid.kind == ShapeKind.MESH:
        radius = 0.0
        for k in range(3):
            radius = max(radius, 0.5 * (solid.high[k] - solid.low[k]))
    speed = norm(v)
    speed += radius * norm(w)
    return _MARGIN * radius + _AHEAD * dt * speed


@kernel
def _has_left(solid: SolidRecord) -> bool:
    """True when a shape is no longer inside its fat AABB, or not finite."""
    for k in range(3):
        if not (solid.fat_low[k] <= solid.low[k] and solid.high[k] <= solid.fat_high[k]):
            return True
    return False


@kernel
def _take_shapes(
    solids: Table[SolidRecord], meshes: Table[MeshRecord], boxes: Floats, order: I8, sweep: SweepRecord, count: int
) -> None:
    """Fill the order from changed rows: enabled bounded shapes from the front, walls from the back."""
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
        _fatten(solid, 0.0)
        if math.isfinite(solid.low[0]):
            order[sweep.sorted] = i
            sweep.sorted += 1


@kernel
def _choose_axis(solids: Table[SolidRecord], order: I8, sweep: SweepRecord) -> None:
    """Choose the axis of the sweep by the widest spread of the shapes."""
    widest, spread = sweep.axis, 0.0
    for turn in range(3):
        k = (sweep.axis + turn) % 3
        total, squares = 0.0, 0.0
        for n in range(sweep.sorted):
            place = solids[order[n]].fat_low[k]
            total += place
            squares += place * place
        variance = squares - total * total / max(1, sweep.sorted)
        if variance > (spread if turn == 0 else _SPREAD * spread):
            widest, spread = k, variance
    sweep.axis = widest


@kernel
def _sort(solids: Table[SolidRecord], order: I8, sweep: SweepRecord) -> None:
    """Insertion sort of the order by the lower ends of the fat AABBs."""
    k = sweep.axis
    for n in range(1, sweep.sorted):
        i = order[n]
        key = solids[i].fat_low[k]
        at = n - 1
        while at >= 0 and solids[order[at]].fat_low[k] > key:
            order[at + 1] = order[at]
            at -= 1
        order[at + 1] = i


@kernel
def _can_move(bodies: Table[BodyRecord], solid: SolidRecord) -> bool:
    """True for a shape of a body that forces can move."""
    return solid.body != STATIC and is_free(bodies[solid.body])


@kernel
def _link_moving(
    bodies: Table[BodyRecord], solids: Table[SolidRecord], order: I8, following: I8, sweep: SweepRecord
) -> None:
    """Set, for each place in the order, the next place of a shape that can move."""
    after = sweep.sorted
    for n in range(sweep.sorted - 1, -1, -1):
        following[n] = after
        if _can_move(bodies, solids[order[n]]):
            after = n


@kernel
def _reaches_wall(solid: SolidRecord, wall: SolidRecord) -> bool:
    """True when the fat AABB of a shape overlaps a wall's half-space, and the two are not of one body."""
    height, reach = 0.0, 0.0
    for k in range(3):
        n = wall.rotation[k, 2]
        height += n * (0.5 * (solid.fat_low[k] + solid.fat_high[k]) - wall.position[k])
        reach += abs(n) * 0.5 * (solid.fat_high[k] - solid.fat_low[k])
    return height < reach and solid.body != wall.body


@kernel
def _add(i: int, j: int, shapes: Table[ShapeRecord], pairs: Table[PairRecord], slots: I8, sweep: SweepRecord) -> None:
    """Keep or begin a pair, or count it as left out."""
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
    """Keep or begin the pairs of shapes whose fat AABBs overlap and of which one can move."""
    k = sweep.axis
    for n in range(sweep.sorted):
        i = order[n]
        solid = solids[i]
        moves = _can_move(bodies, solid)
        m = n + 1 if moves else following[n]
        while m < sweep.sorted and solids[order[m]].fat_low[k] <= solid.fat_high[k]:
            if _may_come_near(solid, solids[order[m]]):
                _add(i, order[m], shapes, pairs, slots, sweep)
            m = m + 1 if moves else following[m]
        if moves:
            for w in range(order.shape[0] - sweep.walls, order.shape[0]):
                if _reaches_wall(solid, solids[order[w]]):
                    _add(i, order[w], shapes, pairs, slots, sweep)


@kernel
def _update_bounds(
    solids: Table[SolidRecord],
    meshes: Table[MeshRecord],
    boxes: Floats,
    motions: Table[MotionRecord],
    moving: I8,
    tracking: TrackingRecord,
) -> bool:
    """Update the AABBs of the shapes of awake bodies; return whether one has left its fat AABB."""
    stale = False
    for n in range(tracking.moving):
        solid = solids[moving[n]]
        if solid.enabled and motions[solid.body].asleep == 0:
            _bound_any(solid, meshes, boxes)
            stale = stale or _has_left(solid)
    return stale


@kernel
def _forget_placed(pairs: Table[PairRecord], dynamics: Table[DynamicsRecord], sweep: SweepRecord, count: int) -> None:
    """Clear the memory of pairs of bodies that were placed in this tick."""
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
    """Update the fat AABBs of moving shapes, and mark all pairs as not yet found."""
    sweep.remade += 1
    sweep.left_out = 0
    for n in range(tracking.moving):
        solid = solids[moving[n]]
        if solid.enabled:
            _fatten(solid, _margin_of(solid, motions[solid.body], dt))
    for k in range(sweep.pairs):
        pairs[k].kept = 0


@kernel
def _join_anew(shapes: Table[ShapeRecord], pairs: Table[PairRecord], count: int) -> None:
    """Update the surfaces of all pairs from changed rows; contacts continue."""
    for k in range(count):
        pair = pairs[k]
        pair.body_a, pair.body_b = shapes[pair.a].body, shapes[pair.b].body
        join_surfaces(shapes[pair.a], shapes[pair.b], pair)


@kernel
def find_pairs(rows: Rows, work: ObjectWork, counts: ObjectCountsRecord, dt: float) -> None:
    """Update the list of pairs, `work.pairs`, of which SWEEP.pairs are in use.

    Args:
        rows: `Rows` of this tick.
        work: `ObjectWork` with posed solids; their bounds, the order, the pairs and the state of the sweep are updated.
        counts: SCENE.objects.
        dt: Tick [s].
    """
    tracking, sweep, solids, order, pairs = work.tracking[0], work.sweep[0], work.solids, work.order, work.pairs
    meshes, boxes = work.meshes.rows, work.meshes.boxes
    changed = tracking.paired_revision != counts.revision + 1
    if changed:
        tracking.paired_revision = counts.revision + 1
        _take_shapes(solids, meshes, boxes, order, sweep, counts.shapes)
    stale = _update_bounds(solids, meshes, boxes, work.motions, work.moving_shapes, tracking) or changed
    _forget_placed(pairs, work.dynamics, sweep, counts.bodies)
    if not stale:
        return
    _prepare(solids, work.motions, work.moving_shapes, pairs, tracking, sweep, dt)
    _choose_axis(solids, order, sweep)
    _sort(solids, order, sweep)
    _link_moving(rows.bodies, solids, order, work.next_moving, sweep)
    _sweep(rows.bodies, rows.shapes, solids, order, work.next_moving, pairs, work.pair_slots, sweep)
    sweep.pairs = drop_pairs(pairs, work.pair_slots, sweep.pairs)
    if changed:
        _join_anew(rows.shapes, pairs, sweep.pairs)
