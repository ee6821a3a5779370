"""Two-bone inverse kinematics in closed form: shoulder, elbow, hand, or hip, knee, foot.

The triangle of the bones lies in the plane through the pole; near full stretch the reach gives way, so that the elbow
never moves much faster than the hand; where the plane is not given it is kept from the time before.
"""

from __future__ import annotations

import math

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import F8, I4
from mimics_app.maths.vec import dot

__all__ = ["reach_two_bones"]


_AT_SHOULDER, _TOO_FAR, _TOO_NEAR, _ON_POLE, _NO_LENGTH, _NOT_FINITE, _TURNING = 1, 2, 4, 8, 16, 32, 64
"""Cases of `reach.ReachCase`."""

_NEAR = 1e-6
"""Share of the limb's length below which a distance has no direction."""

_OPPOSED = 1e-9
"""1 + cosine below which two directions are opposite and the shortest arc is not unique."""

_ASKED = 9
"""Components of a request: shoulder, target and pole."""

_LONGEST_LIMB = 1e9
"""Length of a limb beyond which it counts as not finite [m]."""

_SOON_NEAR = 1e-6
"""Square of the share of the limb's length below which a target is left to the general solver."""


@kernel
def _soften(distance: float, longest: float, shortest: float, soft: float) -> float:
    """Return the soft distance of the hand, which approaches full extension and the inner limit asymptotically.

    Beyond 1 - soft of the length what is missing falls off exponentially; so, mirrored, before the inner limit.
    """
    zone = soft * longest
    if zone <= 0.0:
        return min(max(distance, shortest), longest)
    outer = longest - zone
    if distance > outer:
        distance = outer + zone * (1.0 - math.exp(-(distance - outer) / zone))
    inner_zone = min(zone, 0.5 * (outer - shortest))
    if shortest > _NEAR * longest and distance < shortest + inner_zone:
        distance = shortest + inner_zone * math.exp((distance - shortest - inner_zone) / inner_zone)
    return min(max(distance, shortest), longest)


@kernel
def _unit_or(x: float, y: float, z: float, least: float, out: F8) -> bool:
    """Set out to the direction of a vector longer than the minimum; return True where it is."""
    length = math.sqrt(x * x + y * y + z * z)
    if not length > least:
        return False
    out[0], out[1], out[2] = x / length, y / length, z / length
    return True


@kernel
def _square_to(u: F8, v: F8, out: F8) -> None:
    """Set out to the unit component of v perpendicular to u; where v has none, of the axis farthest from u."""
    along = dot(u, v)
    if _unit_or(v[0] - along * u[0], v[1] - along * u[1], v[2] - along * u[2], _NEAR, out):
        return
    k = 0
    if abs(u[1]) < abs(u[k]):
        k = 1
    if abs(u[2]) < abs(u[k]):
        k = 2
    x, y, z = -u[k] * u[0], -u[k] * u[1], -u[k] * u[2]
    out[0], out[1], out[2] = x + (k == 0), y + (k == 1), z + (k == 2)
    _unit_or(out[0], out[1], out[2], 0.0, out)


@kernel
def _carry(states: F8, i: int, u: F8, w: F8) -> None:
    """Rotate the previous elbow direction by the shortest arc from the previous limb direction to u."""
    a, b, c = states[i, 0], states[i, 1], states[i, 2]
    d, e, f = states[i, 3], states[i, 4], states[i, 5]
    x, y, z = b * u[2] - c * u[1], c * u[0] - a * u[2], a * u[1] - b * u[0]
    cosine = a * u[0] + b * u[1] + c * u[2]
    if cosine > -1.0 + _OPPOSED:
        along = (x * d + y * e + z * f) / (1.0 + cosine)
        w[0] = cosine * d + y * f - z * e + along * x
        w[1] = cosine * e + z * d - x * f + along * y
        w[2] = cosine * f + x * e - y * d + along * z
    else:
        w[0], w[1], w[2] = d, e, f
    _square_to(u, w, w)


@kernel
def _swing(u: F8, before: F8, wanted: F8, most: float) -> bool:
    """Limit the angle [rad] of `wanted` from `before` about u; return True where it was limited."""
    cosine = dot(before, wanted)
    cx = before[1] * wanted[2] - before[2] * wanted[1]
    cy = before[2] * wanted[0] - before[0] * wanted[2]
    cz = before[0] * wanted[1] - before[1] * wanted[0]
    angle = math.atan2(u[0] * cx + u[1] * cy + u[2] * cz, cosine)
    if abs(angle) <= most:
        return False
    turn = most if angle > 0.0 else -most
    c, s = math.cos(turn), math.sin(turn)
    x = c * before[0] + s * (u[1] * before[2] - u[2] * before[1])
    y = c * before[1] + s * (u[2] * before[0] - u[0] * before[2])
    z = c * before[2] + s * (u[0] * before[1] - u[1] * before[0])
    wanted[0], wanted[1], wanted[2] = x, y, z
    return True


@kernel
def _choose_side(asked: F8, limbs: F8, states: F8, i: int, u: F8, w: F8, before: F8) -> int:
    """Compute the elbow direction w, perpendicular to u, from the pole, the previous one, or any axis."""
    px, py, pz = asked[i, 6] - asked[i, 0], asked[i, 7] - asked[i, 1], asked[i, 8] - asked[i, 2]
    along = px * u[0] + py * u[1] + pz * u[2]
    least = _NEAR * (limbs[i, 0] + limbs[i, 1])
    has_pole = _unit_or(px - along * u[0], py - along * u[1], pz - along * u[2], least, w)
    known = states[i, 6] > 0.0
    if has_pole and (not known or limbs[i, 3] == math.inf):
        return 0
    if not known:
        _square_to(u, u, w)
        return _ON_POLE
    _carry(states, i, u, before)
    if has_pole:
        return _TURNING if _swing(u, before, w, limbs[i, 3]) else 0
    w[0], w[1], w[2] = before[0], before[1], before[2]
    return _ON_POLE


@kernel
def _reach_one(asked: F8, limbs: F8, states: F8, i: int, out: F8, u: F8, w: F8, before: F8) -> int:
    """Solve one limb; see `reach_two_bones`."""
    finite = 0.0
    for k in range(_ASKED):
        finite += 0.0 * asked[i, k]
    a, b = limbs[i, 0], limbs[i, 1]
    # A comparison with what is not a number is false.
    known = limbs[i, 2] >= 0.0 and limbs[i, 2] < math.inf and limbs[i, 3] >= 0.0
    if not (finite == 0.0 and known and a >= 0.0 and b >= 0.0 and a + b < _LONGEST_LIMB):
        return _NOT_FINITE
    longest, shortest, case = a + b, abs(a - b), 0
    if not longest > 0.0:
        for k in range(3):
            out[i, k] = out[i, 3 + k] = asked[i, k]
        return _NO_LENGTH
    dx, dy, dz = asked[i, 3] - asked[i, 0], asked[i, 4] - asked[i, 1], asked[i, 5] - asked[i, 2]
    distance = math.sqrt(dx * dx + dy * dy + dz * dz)
    if not _unit_or(dx, dy, dz, _NEAR * longest, u):
        case |= _AT_SHOULDER
        u[0], u[1], u[2] = 0.0, -1.0, 0.0
        if states[i, 6] > 0.0:
            u[0], u[1], u[2] = states[i, 0], states[i, 1], states[i, 2]
    case |= _TOO_FAR if distance > longest else 0
    case |= _TOO_NEAR if distance < shortest else 0
    length = _soften(distance, longest, shortest, limbs[i, 2])
    case |= _choose_side(asked, limbs, states, i, u, w, before)
    x = (a * a - b * b + length * length) / (2.0 * length) if length > 0.0 else 0.0
    x = min(max(x, -a), a)
    h = math.sqrt(max((a - x) * (a + x), 0.0))
    for k in range(3):
        out[i, k] = asked[i, k] + x * u[k] + h * w[k]
        out[i, 3 + k] = asked[i, k] + length * u[k]
        states[i, k], states[i, 3 + k] = u[k], w[k]
    states[i, 6] = 1.0
    return case


@kernel
def _reach_plain(asked: F8, limbs: F8, states: F8, first: int, out: F8, cases: I4) -> int:
    """Solve successive limbs without special cases, in registers alone; return the index of the first other one.

    The loop is within one call: passing five arrays costs more than solving a limb.
    """
    for i in range(first, asked.shape[0]):
        a, b = limbs[i, 0], limbs[i, 1]
        sx, sy, sz = asked[i, 0], asked[i, 1], asked[i, 2]
        dx, dy, dz = asked[i, 3] - sx, asked[i, 4] - sy, asked[i, 5] - sz
        px, py, pz = asked[i, 6] - sx, asked[i, 7] - sy, asked[i, 8] - sz
        d2 = dx * dx + dy * dy + dz * dz
        outer, inner = (1.0 - limbs[i, 2]) * (a + b), abs(a - b) + limbs[i, 2] * (a + b)
        # Whatever is not finite fails one of these.
        if not (
            d2 < outer * outer and d2 > inner * inner and d2 > _SOON_NEAR * (a + b) ** 2 and limbs[i, 3] == math.inf
        ):
            return i
        share = (px * dx + py * dy + pz * dz) / d2
        px, py, pz = px - share * dx, py - share * dy, pz - share * dz
        p2 = px * px + py * py + pz * pz
        if not (p2 > (_NEAR * (a + b)) ** 2 and p2 < math.inf):
            return i
        r = math.sqrt(d2)
        x = (a * a - b * b + d2) / (2.0 * r)
        h = math.sqrt(max((a - x) * (a + x), 0.0))
        along, side = 1.0 / r, 1.0 / math.sqrt(p2)
        ux, uy, uz = dx * along, dy * along, dz * along
        wx, wy, wz = px * side, py * side, pz * side
        out[i, 0], out[i, 1], out[i, 2] = sx + x * ux + h * wx, sy + x * uy + h * wy, sz + x * uz + h * wz
        out[i, 3], out[i, 4], out[i, 5] = asked[i, 3], asked[i, 4], asked[i, 5]
        states[i, 0], states[i, 1], states[i, 2] = ux, uy, uz
        states[i, 3], states[i, 4], states[i, 5], states[i, 6] = wx, wy, wz, 1.0
        cases[i] = 0
    return asked.shape[0]


@kernel
def reach_two_bones(asked: F8, limbs: F8, states: F8, out: F8, cases: I4) -> None:
    """Solve limbs for elbow and hand.

    Args:
        asked: Shoulder, target, and pole (a point the elbow points to) of each limb [m], [n, 9].
        limbs: Lengths of the two bones [m], share of their sum in which the reach gives way (0: none), and the
            greatest angle the elbow may swing about the line to the hand in this step [rad]; [n, 4].
        states: Kept from step to step: direction to the hand, direction of the elbow, 1 where they are known; [n, 7].
        out: Elbow and hand [m], written, [n, 6]; as before where what is asked is not finite.
        cases: Special cases, bits of `ReachCase`, written, [n].
    """
    u, w, before = np.empty(3), np.empty(3), np.empty(3)
    i = _reach_plain(asked, limbs, states, 0, out, cases)
    while i < asked.shape[0]:
        cases[i] = _reach_one(asked, limbs, states, i, out, u, w, before)
        i = _reach_plain(asked, limbs, states, i + 1, out, cases)
