"""Collisions of haptic objects (4.2.9): near pairs, their contact points, their forces, who wakes whom.

Figures 40-44 and beyond: sphere, capsule, cylinder, box, wall and mesh, each with each; any number of shapes to a body.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.contracts.haptic_objects import STATIC, ShapeKind
from mimics_app.contracts.kernel import kernel
from mimics_app.rendering.haptic.kernels.objects.bodies import is_free, rest_time, wake
from mimics_app.rendering.haptic.kernels.objects.collisions_boxes import separate_boxes
from mimics_app.rendering.haptic.kernels.objects.collisions_carried_mesh import touch_carried_mesh
from mimics_app.rendering.haptic.kernels.objects.collisions_hulls import separate_hulls
from mimics_app.rendering.haptic.kernels.objects.collisions_mesh import touch_mesh
from mimics_app.rendering.haptic.kernels.objects.collisions_ridges import touch_ridged_mesh
from mimics_app.rendering.haptic.kernels.objects.collisions_round import touch_by_capsule, touch_by_sphere
from mimics_app.rendering.haptic.kernels.objects.collisions_walls import touch_wall
from mimics_app.rendering.haptic.kernels.objects.loads import load_bodies
from mimics_app.rendering.haptic.kernels.objects.manifold import lay_over, write_feature
from mimics_app.rendering.haptic.kernels.objects.mesh_tree import ANYWHERE
from mimics_app.rendering.haptic.kernels.objects.resolve import part, push_apart
from mimics_app.rendering.haptic.kernels.objects.sweep import find_pairs, near
from mimics_app.rendering.haptic.kernels.objects.triples import Three, dot, times

if TYPE_CHECKING:
    from mimics_app.contracts.record_types import (
        BodyRecord,
        DynamicsRecord,
        MeshTable,
        MotionRecord,
        ObjectCountsRecord,
        ObjectWork,
        PairRecord,
        RidgeTable,
        Rows,
        ScratchRecord,
        SolidRecord,
        SweepRecord,
        Table,
        TotalsRecord,
    )

__all__ = ["collide_bodies"]


_TILTED = 1e-2
"""1 - cosine between a normal and the nearer face from which the rounding of edges counts in full."""

_PRESSED = 0.01
"""A sleeper wakes when a contact's force differs by so much per mass from when it fell asleep [N/kg]."""


@kernel
def _lay_features(a: SolidRecord, b: SolidRecord, n: Three, rounded: float, room: ScratchRecord) -> int:
    """Contact points of two solids along n."""
    count_a, out_a, lone_a = write_feature(a, n, room.feature_a)
    count_b, out_b, lone_b = write_feature(b, times(-1.0, n), room.feature_b)
    lone = lone_a if count_a == 2 else lone_b if count_b == 2 else min(lone_a, lone_b)
    tilt = 1.0 - max(dot(out_a, n), -dot(out_b, n))
    correction = rounded * min(1.0, tilt / _TILTED)
    round_b = b.size[0] if b.kind == ShapeKind.CYLINDER else 0.0
    return lay_over(
        room.feature_a, count_a, out_a, room.feature_b, count_b, out_b, n, lone, round_b, correction,
        room.polygon, room.points,
    )  # fmt: skip


@kernel
def _touch(pair: PairRecord, a: SolidRecord, b: SolidRecord, room: ScratchRecord) -> int:
    """Contact points of one pair into `room.points`, and its normal; returns how many."""
    last = (pair.normal[0], pair.normal[1], pair.normal[2])
    count, n = 0, last
    if b.kind == ShapeKind.WALL:
        count, n = touch_wall(a, b, room.feature_a, room.points)
    elif a.kind == ShapeKind.SPHERE:
        count, n = touch_by_sphere(a, b, last, room.points)
    elif a.kind == ShapeKind.CAPSULE:
        count, n = touch_by_capsule(a, b, last, room.points)
    elif a.kind == ShapeKind.CYLINDER:
        overlap, rounded, n = separate_hulls(a, b, last, room.simplex)
        if overlap > 0.0:
            count = _lay_features(a, b, n, rounded, room)
    else:
        pair.feature, overlap, n = separate_boxes(a, b, pair.feature, last, room.cosines)
        if pair.feature > 0:
            count = _lay_features(a, b, n, 0.0, room)
    if count > 0:
        pair.normal[0], pair.normal[1], pair.normal[2] = n
    return count


@kernel
def _is_awake(bodies: Table[BodyRecord], motions: Table[MotionRecord], k: int) -> bool:
    """True for a body that can move and does not sleep."""
    return k >= 0 and motions[k].asleep == 0 and is_free(bodies[k])


@kernel
def _stir(
    pair: PairRecord, sleeper: MotionRecord, mover: MotionRecord, dynamics: DynamicsRecord, mass: float, doze: int
) -> None:
    """A neighbour that moves, or presses otherwise than it did, wakes a sleeper; a restless one keeps the other up."""
    if sleeper.asleep:
        if mover.quiet_ticks == 0 or abs(pair.force - pair.rest_force) > _PRESSED * mass:
            wake(sleeper)
    elif mover.quiet_ticks <= doze:
        dynamics.stirred = 1


@kernel
def _rouse(
    pair: PairRecord,
    bodies: Table[BodyRecord],
    motions: Table[MotionRecord],
    dynamics: Table[DynamicsRecord],
    doze: int,
) -> None:
    """What a contact means for the sleep of its two bodies."""
    i, j = pair.body_a, pair.body_b
    if i < 0 or j < 0 or not is_free(bodies[i]) or not is_free(bodies[j]):
        return
    first_awake, second_awake = motions[i].asleep == 0, motions[j].asleep == 0
    if second_awake:
        _stir(pair, motions[i], motions[j], dynamics[i], bodies[i].mass, doze)
    if first_awake:
        _stir(pair, motions[j], motions[i], dynamics[j], bodies[j].mass, doze)
    if first_awake and second_awake:
        pair.rest_force = pair.force


@kernel
def _touch_mesh(
    pair: PairRecord, a: SolidRecord, b: SolidRecord, table: MeshTable, ridges: RidgeTable, room: ScratchRecord
) -> int:
    """`_touch` of a mesh: it alone needs the tables of triangles."""
    last = (pair.normal[0], pair.normal[1], pair.normal[2])
    if a.kind == ShapeKind.MESH or b.body != STATIC:
        count, n = touch_carried_mesh(a, b, last if pair.touching else ANYWHERE, table, room)
    elif ridges.rows[b.mesh].ridges > 0 and a.kind != ShapeKind.SPHERE:  # a ball is exact by its middle
        count, n = touch_ridged_mesh(a, b, last if pair.touching else ANYWHERE, table, ridges, room)
    else:
        count, n = touch_mesh(a, b, last, table.rows, table.vertices, table.corners, table.boxes, room)
    pair.normal[0], pair.normal[1], pair.normal[2] = n
    return count


@kernel
def _tell_left_out(sweep: SweepRecord, totals: TotalsRecord) -> None:
    """Pairs without room are reported when there are more of them than ever before."""
    if sweep.left_out > sweep.most_left_out:
        sweep.most_left_out = sweep.left_out
        totals.left_out = sweep.left_out


@kernel
def _collide_pair(pair: PairRecord, rows: Rows, work: ObjectWork, doze: int, dt: float) -> None:
    """One pair of which a body is awake: its points, its forces, who wakes whom."""
    i, j = pair.body_a, pair.body_b
    a, b, room = work.solids[pair.a], work.solids[pair.b], work.scratch[0]
    found = 0
    if b.kind == ShapeKind.WALL or near(a, b):
        if a.kind == ShapeKind.MESH or b.kind == ShapeKind.MESH:
            found = _touch_mesh(pair, a, b, work.meshes, work.ridges, room)
        else:
            found = _touch(pair, a, b, room)
    if found == 0:
        part(pair)
        return
    first = work.motions[i] if i >= 0 else work.still[0]
    second = work.motions[j] if j >= 0 else work.still[0]
    push_apart(pair, room.points, found, first, second, work.totals[0], dt)
    _rouse(pair, rows.bodies, work.motions, work.dynamics, doze)


@kernel
def collide_bodies(rows: Rows, work: ObjectWork, counts: ObjectCountsRecord, dt: float) -> None:
    """Add F_aux, T_aux, weight and the forces of all contacts to the bodies; `totals.impact*` is the hardest.

    Deep overlaps (bodies spawned in one another) push out along the shortest direction, with the force of (17): at
    most the stiffness times half of the smaller body.

    Args:
        rows: `Rows` of this tick.
        work: `ObjectWork`; motions, pairs and totals are updated.
        counts: SCENE.objects.
        dt: Tick [s].
    """
    if counts.bodies == 0:
        return
    motions, sweep = work.motions, work.sweep[0]
    load_bodies(rows.bodies, motions, work.dynamics, work.aux_forces, work.aux_torques, counts.bodies)
    find_pairs(
        rows.bodies, rows.shapes, motions, work.dynamics, work.solids, work.meshes.rows, work.meshes.boxes,
        work.moving_shapes, work.order, work.next_moving, work.pairs, work.pair_slots, work.tracking[0], sweep, counts,
        dt,
    )  # fmt: skip
    _tell_left_out(sweep, work.totals[0])
    doze = rest_time(dt)
    for k in range(sweep.pairs):
        pair = work.pairs[k]
        if _is_awake(rows.bodies, motions, pair.body_a) or _is_awake(rows.bodies, motions, pair.body_b):
            _collide_pair(pair, rows, work, doze, dt)
