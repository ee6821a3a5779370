"""Force of one contact of two bodies, (17) corrected: normal forces at its points, friction at the centre of pressure.

All normal forces are along one n, so that they act as their sum N at the centre of pressure, where friction and the
torsional friction of the patch act too: both bodies get opposite forces at the same point, so momentum and angular
momentum are conserved to rounding. Friction is the anchor form of Hayward and Armstrong (2000) with the stretch of its
spring as state (Cundall & Strack 1979), so that a contact may roll: F = -(k_t s + b_t v_t) within the cone mu N, with
mu_s while it sticks and mu_d while it slides. At rest only positions enter: a stack does not creep.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import F8, Vec3
from mimics_app.contracts.loop.haptic_objects import ForceLaw
from mimics_app.maths.triple_kernels import along, cross, minus, times
from mimics_app.maths.vec import dot
from mimics_app.rendering.haptic.kernels.contact_law import hunt_crossley, pair_force
from mimics_app.rendering.haptic.kernels.objects.pairs import forget_contact

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import Floats, MotionRecord, PairRecord, TotalsRecord

__all__ = ["apply_contact", "end_contact"]


_NEW_AFTER = 0.02
"""Time apart from which a contact counts as new [s]: a rocking box does not cause an impact in each tick."""

_SETTLING = 0.2
"""Share of the change of the touching stiffness that is followed per tick [-]: a new corner causes no step."""

_STILL = (0.0, 0.0, 0.0)


@kernel
def _vector(a: Floats) -> Vec3:
    """Three numbers of a record as a tuple."""
    return a[0], a[1], a[2]


@kernel
def _velocity_at(motion: MotionRecord, p: Vec3) -> Vec3:
    """Velocity of a body at the point p [m/s]."""
    v = cross(_vector(motion.omega), minus(p, _vector(motion.centre)))
    return v[0] + motion.velocity[0], v[1] + motion.velocity[1], v[2] + motion.velocity[2]


@kernel
def _push(motion: MotionRecord, sign: float, force: Vec3, moment: Vec3, p: Vec3) -> None:
    """Add force and moment of a contact to one body."""
    turning = cross(minus(p, _vector(motion.centre)), force)
    for i in range(3):
        motion.force[i] += sign * force[i]
        motion.torque[i] += sign * (turning[i] + moment[i])
    motion.collided = 1


@kernel
def _press(
    pair: PairRecord, points: F8, count: int, first: MotionRecord, second: MotionRecord, n: Vec3
) -> tuple[float, float, float, Vec3]:
    """(normal force [N], touching share of the stiffness, largest approach speed [m/s], centre of pressure).

    Column 3 of the points, their depth, is replaced by their force.
    """
    total, share, fastest = 0.0, 0.0, 0.0
    x, y, z = 0.0, 0.0, 0.0
    for k in range(count):
        p = (points[k, 0], points[k, 1], points[k, 2])
        closing = minus(_velocity_at(first, p), _velocity_at(second, p))
        rate = dot(closing, n)
        if pair.law == ForceLaw.HUNT_CROSSLEY:
            force = hunt_crossley(points[k, 3], rate, pair.stiffness, pair.stiffness * pair.damping, pair.exponent)
        else:
            force = pair_force(points[k, 3], rate, pair.stiffness, pair.damping)
        force *= points[k, 4]
        points[k, 3] = force
        share += points[k, 4]
        fastest = max(fastest, rate)
        total += force
        x += force * p[0]
        y += force * p[1]
        z += force * p[2]
    if total <= 0.0:
        return 0.0, share, fastest, _STILL
    return total, share, fastest, (x / total, y / total, z / total)


@kernel
def _patch_radius(points: F8, count: int, total: float, centre: Vec3) -> float:
    """Root mean square distance of the pressure from its centre [m]."""
    if count < 2:
        return 0.0
    square = 0.0
    for k in range(count):
        arm = minus((points[k, 0], points[k, 1], points[k, 2]), centre)
        square += points[k, 3] * dot(arm, arm)
    return math.sqrt(square / total)


@kernel
def _hold(pair: PairRecord, slip: Vec3, spin: float, n: Vec3, total: float, dt: float) -> Vec3:
    """Friction force on body a [N]; updates the stretch.

    Args:
        pair: PAIR.
        slip: Tangential velocity of body a against body b [m/s].
        spin: Mean angular velocity of both bodies about n [rad/s], by which the stretch rotates.
        n: Unit normal from a to b.
        total: Normal force [N].
        dt: Tick [s].
    """
    s = _vector(pair.stretch)
    s = along(s, dt * spin, cross(n, s))
    s = along(s, dt, slip)
    s = along(s, -dot(s, n), n)
    k = pair.friction_stiffness * pair.share
    b = pair.friction_damping * pair.share
    pull = along(times(k, s), b, slip)
    size = math.sqrt(dot(pull, pull))
    limit = (pair.friction_static if pair.sticking else pair.friction_dynamic) * total
    pair.sticking = 1 if size <= limit else 0
    if size > limit:
        limit = min(limit, pair.friction_dynamic * total)
        pull = times(limit / size, pull)
        reach = limit / k
        far = math.sqrt(dot(s, s))
        if far > reach:
            s = times(reach / far, s)
    pair.stretch[0], pair.stretch[1], pair.stretch[2] = s
    return times(-1.0, pull)


@kernel
def _hold_twist(pair: PairRecord, rate: float, radius: float, total: float, dt: float) -> float:
    """Torsional friction on body a about n [N m]: a spring and damper of the patch within its Coulomb limit."""
    k = pair.friction_stiffness * pair.share * radius * radius
    if k <= 0.0:
        pair.twist = 0.0
        return 0.0
    b = pair.friction_damping * pair.share * radius * radius
    limit = (pair.friction_static if pair.sticking else pair.friction_dynamic) * total * radius
    pair.twist += dt * rate
    moment = k * pair.twist + b * rate
    if abs(moment) > limit:
        moment = math.copysign(limit, moment)
        pair.twist = min(max(pair.twist, -limit / k), limit / k)
    return -moment


@kernel
def _note_impact(
    pair: PairRecord, totals: TotalsRecord, speed: float, force: float, p: Vec3, n: Vec3, dt: float
) -> None:
    """Report the contact as the impact of the tick if it is new and the fastest."""
    if pair.ticks_apart * dt < _NEW_AFTER or speed <= totals.impact:
        return
    totals.impact = speed
    totals.impact_force = force
    totals.impact_a = pair.body_a
    totals.impact_b = pair.body_b
    for i in range(3):
        totals.impact_position[i] = p[i]
        totals.impact_normal[i] = -n[i]


@kernel
def end_contact(pair: PairRecord) -> None:
    """Note that the two shapes do not touch in this tick."""
    if pair.touching:
        forget_contact(pair)
        pair.ticks_apart = 0
    pair.ticks_apart += 1


@kernel
def apply_contact(
    pair: PairRecord,
    points: F8,
    count: int,
    first: MotionRecord,
    second: MotionRecord,
    totals: TotalsRecord,
    dt: float,
) -> None:
    """Apply the forces of one contact to both of its bodies.

    Args:
        pair: PAIR; its normal is that of this tick, its friction is advanced.
        points: Contact points, see `manifold`; depths become forces.
        count: Number of points.
        first: MOTION of body a; its force, torque and `collided` are updated.
        second: MOTION of body b, likewise; for the static scene one at rest.
        totals: TOTALS; receives a new impact.
        dt: Tick [s].
    """
    n = _vector(pair.normal)
    total, share, speed, centre = _press(pair, points, count, first, second, n)
    pair.force = total
    if total <= 0.0:
        end_contact(pair)
        return
    if not pair.touching:
        _note_impact(pair, totals, speed, total, centre, n, dt)
        pair.touching = 1
        pair.share = share
    pair.ticks_apart = 0
    pair.share += _SETTLING * (share - pair.share)
    force = times(-total, n)
    moment = _STILL
    if pair.friction_static > 0.0:
        closing = minus(_velocity_at(first, centre), _velocity_at(second, centre))
        slip = along(closing, -dot(closing, n), n)
        rate_a, rate_b = dot(_vector(first.omega), n), dot(_vector(second.omega), n)
        held = _hold(pair, slip, 0.5 * (rate_a + rate_b), n, total, dt)
        force = along(force, 1.0, held)
        radius = _patch_radius(points, count, total, centre)
        moment = times(_hold_twist(pair, rate_a - rate_b, radius, total, dt), n)
    _push(first, 1.0, force, moment, centre)
    _push(second, -1.0, force, moment, centre)
