"""Collisions of haptic objects (4.2.9): broad phase, contact points, contact forces, and the waking of sleeping bodies.

Extends figures 40-44 to each pair of sphere, capsule, cylinder, box, wall and mesh; a body has any number of shapes.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec, Vec3
from mimics_app.contracts.loop.haptic_objects import STATIC, ShapeKind
from mimics_app.maths.triple_kernels import times
from mimics_app.maths.vec import copy, dot
from mimics_app.rendering.haptic.kernels.objects.bodies import is_free, rest_time, wake
from mimics_app.rendering.haptic.kernels.objects.collisions_boxes import separate_boxes
from mimics_app.rendering.haptic.kernels.objects.collisions_carried_mesh import touch_carried_mesh
from mimics_app.rendering.haptic.kernels.objects.collisions_hulls import separate_hulls
from mimics_app.rendering.haptic.kernels.objects.collisions_mesh import touch_mesh
from mimics_app.rendering.haptic.kernels.objects.collisions_ridges import touch_ridged_mesh
from mimics_app.rendering.haptic.kernels.objects.collisions_round import touch_by_capsule, touch_by_sphere
from mimics_app.rendering.haptic.kernels.objects.collisions_walls import touch_wall
from mimics_app.rendering.haptic.kernels.objects.manifold import lay_over, write_feature
from mimics_app.rendering.haptic.kernels.objects.mesh_tree import ANY_DIRECTION
from mimics_app.rendering.haptic.kernels.objects.resolve import apply_contact, end_contact
from mimics_app.rendering.haptic.kernels.objects.sweep_and_prune import find_pairs, near

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import (
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

__all__ = ["collide_bodies", "load_bodies"]


_TILTED = 1e-2
"""1 - cosine between the contact normal and the nearer face's normal from which rounding is corrected in full [-]."""

_PRESSED = 0.01
"""Change of a contact force per mass since a body fell asleep from which it wakes [N/kg]."""


_SAME_LOAD = 1e-9
"""Relative change of the load on a sleeping body from which it wakes [-]."""


@kernel
def _lay_features(a: SolidRecord, b: SolidRecord, n: Vec3, rounded: float, scratch: ScratchRecord) -> int:
    """Write the contact points of two solids along n to `scratch.points`; return their number.

    Args:
        a: SOLID of one.
        b: SOLID of the other.
        n: Unit normal from a to b.
        rounded: Further overlap of the sharp solids along n [m], see `separate_hulls`.
        scratch: SCRATCH.
    """
    ours = write_feature(a, n, scratch.feature_a)
    theirs = write_feature(b, times(-1.0, n), scratch.feature_b)
    lone = (
        ours.share
        if ours.corner_count == 2
        else theirs.share
        if theirs.corner_count == 2
        else min(ours.share, theirs.share)
    )
    tilt = 1.0 - max(dot(ours.normal, n), -dot(theirs.normal, n))
    correction = rounded * min(1.0, tilt / _TILTED)
    round_b = b.size[0] if b.kind == ShapeKind.CYLINDER else 0.0
    return lay_over(ours, theirs, n, lone, round_b, correction, scratch.polygon, scratch.points)


@kernel
def _touch(pair: PairRecord, a: SolidRecord, b: SolidRecord, scratch: ScratchRecord) -> int:
    """Write the contact points of one pair to `scratch.points`, and its normal; return their number."""
    last = (pair.normal[0], pair.normal[1], pair.normal[2])
    count, n = 0, last
    if b.kind == ShapeKind.WALL:
        count, n = touch_wall(a, b, scratch.feature_a, scratch.points)
    elif a.kind == ShapeKind.SPHERE:
        count, n = touch_by_sphere(a, b, last, scratch.points)
    elif a.kind == ShapeKind.CAPSULE:
        count, n = touch_by_capsule(a, b, last, scratch.points)
    elif a.kind == ShapeKind.CYLINDER:
        overlap, rounded, n = separate_hulls(a, b, last, scratch.simplex)
        if overlap > 0.0:
            count = _lay_features(a, b, n, rounded, scratch)
    else:
        pair.feature, overlap, n = separate_boxes(a, b, pair.feature, last, scratch.cosines)
        if pair.feature > 0:
            count = _lay_features(a, b, n, 0.0, scratch)
    if count > 0:
        pair.normal[0], pair.normal[1], pair.normal[2] = n
    return count


@kernel
def _is_awake(bodies: Table[BodyRecord], motions: Table[MotionRecord], k: int) -> bool:
    """True for a body that can move and is not asleep."""
    return k >= 0 and motions[k].asleep == 0 and is_free(bodies[k])


@kernel
def _disturb(
    pair: PairRecord, sleeper: MotionRecord, mover: MotionRecord, dynamics: DynamicsRecord, mass: float, doze: int
) -> None:
    """Wake a sleeper by a moving neighbour or a changed contact force; a neighbour that is not at rest delays sleep."""
    if sleeper.asleep:
        if mover.quiet_ticks == 0 or abs(pair.force - pair.rest_force) > _PRESSED * mass:
            wake(sleeper)
    elif mover.quiet_ticks <= doze:
        dynamics.stirred = 1


@kernel
def _wake_neighbours(
    pair: PairRecord,
    bodies: Table[BodyRecord],
    motions: Table[MotionRecord],
    dynamics: Table[DynamicsRecord],
    doze: int,
) -> None:
    """Apply the effect of a contact on the sleep of its two bodies."""
    i, j = pair.body_a, pair.body_b
    if i < 0 or j < 0 or not is_free(bodies[i]) or not is_free(bodies[j]):
        return
    first_awake, second_awake = motions[i].asleep == 0, motions[j].asleep == 0
    if second_awake:
        _disturb(pair, motions[i], motions[j], dynamics[i], bodies[i].mass, doze)
    if first_awake:
        _disturb(pair, motions[j], motions[i], dynamics[j], bodies[j].mass, doze)
    if first_awake and second_awake:
        pair.rest_force = pair.force


@kernel
def _touch_mesh(
    pair: PairRecord, a: SolidRecord, b: SolidRecord, table: MeshTable, ridges: RidgeTable, scratch: ScratchRecord
) -> int:
    """`_touch` for a pair with a mesh, which needs the tables of triangles."""
    last = (pair.normal[0], pair.normal[1], pair.normal[2])
    if a.kind == ShapeKind.MESH or b.body != STATIC:
        count, n = touch_carried_mesh(a, b, last if pair.touching else ANY_DIRECTION, table, scratch)
    elif ridges.rows[b.mesh].ridges > 0 and a.kind != ShapeKind.SPHERE:  # a sphere is exact by its centre
        count, n = touch_ridged_mesh(a, b, last if pair.touching else ANY_DIRECTION, table, ridges, scratch)
    else:
        count, n = touch_mesh(a, b, last, table, scratch)
    pair.normal[0], pair.normal[1], pair.normal[2] = n
    return count


@kernel
def _report_left_out(sweep: SweepRecord, totals: TotalsRecord) -> None:
    """Report the pairs beyond the capacity of the table when their number is a new maximum."""
    if sweep.left_out > sweep.most_left_out:
        sweep.most_left_out = sweep.left_out
        totals.left_out = sweep.left_out


@kernel
def _collide_pair(pair: PairRecord, rows: Rows, work: ObjectWork, doze: int, dt: float) -> None:
    """Collide one pair with an awake body: contact points, forces, and the waking of bodies."""
    i, j = pair.body_a, pair.body_b
    a, b, scratch = work.solids[pair.a], work.solids[pair.b], work.scratch[0]
    found = 0
    if b.kind == ShapeKind.WALL or near(a, b):
        if a.kind == ShapeKind.MESH or b.kind == ShapeKind.MESH:
            found = _touch_mesh(pair, a, b, work.meshes, work.ridges, scratch)
        else:
            found = _touch(pair, a, b, scratch)
    if found == 0:
        end_contact(pair)
        return
    first = work.motions[i] if i >= 0 else work.still[0]
    second = work.motions[j] if j >= 0 else work.still[0]
    apply_contact(pair, scratch.points, found, first, second, work.totals[0], dt)
    _wake_neighbours(pair, rows.bodies, work.motions, work.dynamics, doze)


@kernel
def _differs(a: Vec, b: Vec) -> bool:
    """True when a differs from b by more than rounding."""
    square, apart = 0.0, 0.0
    for i in range(3):
        square += b[i] * b[i]
        apart += (a[i] - b[i]) * (a[i] - b[i])
    return apart > _SAME_LOAD * _SAME_LOAD * square


@kernel
def load_bodies(rows: Rows, work: ObjectWork, counts: ObjectCountsRecord) -> None:
    """Add F_aux, T_aux and weight to the forces of touch, effects and grip; a changed load wakes a sleeping body.

    Args:
        rows: `Rows` of this tick.
        work: `ObjectWork`; motions and dynamics are updated.
        counts: SCENE.objects.
    """
    for k in range(counts.bodies):
        body, motion, dynamic = rows.bodies[k], work.motions[k], work.dynamics[k]
        for i in range(3):
            motion.force[i] += work.aux_forces[k, i] + body.mass * body.gravity[i]
            motion.torque[i] += work.aux_torques[k, i]
        if motion.asleep:
            changed = _differs(motion.force, dynamic.rest_force) or _differs(motion.torque, dynamic.rest_torque)
            if not (changed or motion.touched):
                continue
            wake(motion)
        copy(motion.force, dynamic.rest_force)
        copy(motion.torque, dynamic.rest_torque)
        dynamic.stirred = 0


@kernel
def collide_bodies(rows: Rows, work: ObjectWork, counts: ObjectCountsRecord, dt: float) -> None:
    """Add F_aux, T_aux, weight and the forces of all contacts to the bodies; `totals.impact*` is the hardest impact.

    Deep overlaps, as of bodies spawned in one another, push out along the shortest direction by (17), with at most the
    stiffness times half of the smaller body.

    Args:
        rows: `Rows` of this tick.
        work: `ObjectWork`; motions, pairs and totals are updated.
        counts: SCENE.objects.
        dt: Tick [s].
    """
    if counts.bodies == 0:
        return
    motions, sweep = work.motions, work.sweep[0]
    load_bodies(rows, work, counts)
    find_pairs(rows, work, counts, dt)
    _report_left_out(sweep, work.totals[0])
    doze = rest_time(dt)
    for k in range(sweep.pairs):
        pair = work.pairs[k]
        if _is_awake(rows.bodies, motions, pair.body_a) or _is_awake(rows.bodies, motions, pair.body_b):
            _collide_pair(pair, rows, work, doze, dt)
