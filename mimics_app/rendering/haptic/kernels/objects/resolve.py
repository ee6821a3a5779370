"""Force of one contact of two bodies, (17) corrected: normal force at its points, friction at their middle.

All normal forces are along one n, so that they act as their sum N at the centre of pressure; there friction acts too,
and what the patch of points resists to twisting: both bodies get the same force at the same place, so momentum and
angular momentum are kept to rounding. Friction is the anchor form of Hayward and Armstrong (2000) with the stretch of
its spring carried along (Cundall & Strack 1979), so that a contact may roll: F = -(k_t s + b_t v_t) within the cone
mu N, with mu_s while it sticks and mu_d while it slides. At rest nothing but positions enter: a stack does not creep.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.haptic_objects import ForceLaw
from mimics_app.contracts.kernel import kernel
from mimics_app.rendering.haptic.kernels.contact_law import hunt_crossley, pair_force
from mimics_app.rendering.haptic.kernels.objects.pairs import forget_contact
from mimics_app.rendering.haptic.kernels.objects.triples import Three, along, cross, dot, minus, times

if TYPE_CHECKING:
    from mimics_app.contracts.record_types import Floats, MotionRecord, PairRecord, TotalsRecord

__all__ = ["part", "push_apart"]


_NEW_AFTER = 0.02
"""A contact that was apart for less than this [s] is not a new one: a box that rocks does not knock each tick."""

_SETTLING = 0.2
"""Share by which the touching part of the stiffness is followed in a tick: a corner that dips in is no step."""

_STILL = (0.0, 0.0, 0.0)


@kernel
def _vector(a: Floats) -> Three:
    return a[0], a[1], a[2]


@kernel
def _velocity_at(motion: MotionRecord, p: Three) -> Three:
    """Velocity of a body's matter at p [m/s]."""
    v = cross(_vector(motion.omega), minus(p, _vector(motion.centre)))
    return v[0] + motion.velocity[0], v[1] + motion.velocity[1], v[2] + motion.velocity[2]


@kernel
def _push(motion: MotionRecord, sign: float, force: Three, moment: Three, p: Three) -> None:
    """Give a body its side of a contact."""
    turning = cross(minus(p, _vector(motion.centre)), force)
    for i in range(3):
        motion.force[i] += sign * force[i]
        motion.torque[i] += sign * (turning[i] + moment[i])
    motion.collided = 1


@kernel
def _press(
    pair: PairRecord, points: F8, count: int, first: MotionRecord, second: MotionRecord, n: Three
) -> tuple[float, float, float, Three]:
    """(normal force [N], share of stiffness that touches, greatest approach speed [m/s], centre of pressure).

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
def _patch_radius(points: F8, count: int, total: float, centre: Three) -> float:
    """Root of the mean square distance of the pressure from its centre [m]."""
    if count < 2:
        return 0.0
    square = 0.0
    for k in range(count):
        arm = minus((points[k, 0], points[k, 1], points[k, 2]), centre)
        square += points[k, 3] * dot(arm, arm)
    return math.sqrt(square / total)


@kernel
def _hold(pair: PairRecord, slip: Three, spin: float, n: Three, total: float, dt: float) -> Three:
    """Tangential force on body a [N]; the stretch follows the contact."""
    # The contact turned by the mean of both bodies about n since the last tick, and the stretch with it.
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
    """Moment on body a about n [N m]: a patch of contact does not let it spin freely."""
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
    pair: PairRecord, totals: TotalsRecord, speed: float, force: float, p: Three, n: Three, dt: float
) -> None:
    """The strongest contact that began in this tick is the impact of the tick."""
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
def part(pair: PairRecord) -> None:
    """The two do not touch in this tick."""
    if pair.touching:
        forget_contact(pair)
        pair.ticks_apart = 0
    pair.ticks_apart += 1


@kernel
def push_apart(
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
        count: How many.
        first: MOTION of body a; its force, torque and `collided` are updated.
        second: MOTION of body b, likewise; of the static scene one at rest.
        totals: TOTALS; a new contact is counted there.
        dt: Tick [s].
    """
    n = _vector(pair.normal)
    total, share, speed, centre = _press(pair, points, count, first, second, n)
    pair.force = total
    if total <= 0.0:
        part(pair)
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
