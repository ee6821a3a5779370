"""Closest point of the tunnel's bisector: the tracking Newton method of the tick, and its rivals.

The square distance to a cubic piece is a polynomial of degree six, without a closed-form minimum. The tick therefore
corrects the parameter of the last tick by one or two guarded Newton steps. A search over all pieces replaces it when
the correction has failed, and every tick also searches a fraction of the pieces for a nearer branch.

The search prunes by a safe bound: no point of a piece is farther from its midpoint than the length of the piece.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.loop.haptic_objects import Projection

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import TunnelRecord, TunnelStateRecord

__all__ = [
    "axis",
    "locate",
    "project",
    "project_brute_force",
    "project_golden_section",
    "search",
    "slope",
    "track",
    "track_one_step",
]


_CONVERGED = 1e-12
"""Step along the bisector below which Newton has converged [m]."""

_ITERATIONS = 24
"""Largest number of Newton steps and halvings; a warm start needs two, a start at the far end of a piece about six."""

_TELEPORT = 0.01
"""Motion of the ball in one tick from which the whole bisector is searched [m] (10 m/s at 1 kHz)."""

_TIE = 0.005
"""Advantage in distance a later branch needs in the first search [m]: closed tunnels begin at s = 0."""

_SWITCH_MARGIN = 0.01
"""Advantage in distance another branch needs to replace the tracked one, at least [m]."""

_SLICES = 16
"""Ticks in which the whole bisector is searched once for a nearer branch."""

_STARTS = 5
"""Start points of Newton's method in the search of one piece."""

_FAR = 1e300
"""Distance [m] or square distance [m^2] beyond any in a tunnel."""

_GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)
"""Inverse of the golden ratio [-]."""

_GOLDEN_STEPS = 46
"""Steps of the golden-section search."""

_GOLDEN_SAMPLES = 8
"""Samples per piece that bracket the minimum for the golden-section search."""

_BRUTE_SAMPLES = 256
"""Samples per piece of the exhaustive search."""

_MIN_CONVEXITY = 0.1
"""Second derivative of the distance from which a Newton step is taken [|C'|^2]."""

_ROUNDING = 1e-12
"""Relative growth of a square distance up to which it counts as equal [-]."""

_NO_GROWTH = 1e-9
"""Tolerance of the growth of the distance beyond the motion of the ball [m]."""


@kernel
def locate(tunnel: TunnelRecord, s: float) -> tuple[int, float]:
    """Piece and local parameter u in [0, 1] of tunnel parameter s; s is clamped to the tunnel."""
    s = min(max(s, 0.0), float(tunnel.pieces))
    piece = min(int(s), tunnel.pieces - 1)
    return piece, s - piece


@kernel
def axis(tunnel: TunnelRecord, piece: int, i: int, u: float) -> tuple[float, float, float]:
    """Coordinate i of the bisector [m], and its first and second derivative with respect to u."""
    a0 = tunnel.centre[piece, i, 0]
    a1 = tunnel.centre[piece, i, 1]
    a2 = tunnel.centre[piece, i, 2]
    a3 = tunnel.centre[piece, i, 3]
    return a0 + u * (a1 + u * (a2 + u * a3)), a1 + u * (2.0 * a2 + 3.0 * u * a3), 2.0 * a2 + 6.0 * u * a3


@kernel
def slope(tunnel: TunnelRecord, px: float, py: float, pz: float, s: float) -> tuple[float, float, float, float]:
    """Square distance D = |C(s) - p|^2 [m^2], D'/2, D''/2 and |C'(s)|^2."""
    piece, u = locate(tunnel, s)
    x, x1, x2 = axis(tunnel, piece, 0, u)
    y, y1, y2 = axis(tunnel, piece, 1, u)
    z, z1, z2 = axis(tunnel, piece, 2, u)
    x -= px
    y -= py
    z -= pz
    speed2 = x1 * x1 + y1 * y1 + z1 * z1
    return (
        x * x + y * y + z * z,
        x * x1 + y * y1 + z * z1,
        speed2 + x * x2 + y * y2 + z * z2,
        speed2,
    )


@kernel
def _distance2(tunnel: TunnelRecord, px: float, py: float, pz: float, piece: int, u: float) -> float:
    """Square distance of p to one point of the bisector [m^2]."""
    x, _, _ = axis(tunnel, piece, 0, u)
    y, _, _ = axis(tunnel, piece, 1, u)
    z, _, _ = axis(tunnel, piece, 2, u)
    return (x - px) ** 2 + (y - py) ** 2 + (z - pz) ** 2


@kernel
def _newton_step(gradient: float, bend: float, speed2: float) -> float:
    """Newton step in s; where the distance is not convex (beyond the centre of curvature) the Gauss-Newton step."""
    convexity = bend if bend > _MIN_CONVEXITY * speed2 else speed2
    return min(max(-gradient / convexity, -0.5), 0.5)


@kernel
def _refine(tunnel: TunnelRecord, px: float, py: float, pz: float, s: float) -> tuple[float, float, bool]:
    """Nearest local minimum of the distance, by Newton steps halved until they descend.

    Returns:
        (s [pieces], square distance [m^2], whether it ended in a minimum or at an end of the tunnel).
    """
    last = float(tunnel.pieces)
    s = min(max(s, 0.0), last)
    distance2, gradient, bend, speed2 = slope(tunnel, px, py, pz, s)
    step = _newton_step(gradient, bend, speed2)
    for _ in range(_ITERATIONS):
        trial = min(max(s + step, 0.0), last)
        if abs(trial - s) * math.sqrt(speed2) <= _CONVERGED:
            at_end = (s <= 0.0 and gradient >= 0.0) or (s >= last and gradient <= 0.0)
            return s, distance2, at_end or bend >= 0.0
        trial2, trial_gradient, trial_bend, trial_speed2 = slope(tunnel, px, py, pz, trial)
        if trial2 > distance2 * (1.0 + _ROUNDING):
            step = 0.5 * (trial - s)
            continue
        s, distance2, gradient, bend, speed2 = trial, trial2, trial_gradient, trial_bend, trial_speed2
        step = _newton_step(gradient, bend, speed2)
    return s, distance2, False


@kernel
def _best_in_piece(tunnel: TunnelRecord, px: float, py: float, pz: float, piece: int) -> tuple[float, float, bool]:
    """(s, distance [m], whether it is a minimum) of the closest point found from one piece.

    Newton starts at each of five points that is nearer than its neighbours: a piece that bends back on itself, as in a
    closed tunnel of one piece, has more than one minimum.
    """
    best, best2, best_found = float(piece), _FAR, False
    before, here = _FAR, _distance2(tunnel, px, py, pz, piece, 0.0)
    for i in range(_STARTS):
        after = _distance2(tunnel, px, py, pz, piece, (i + 1) / (_STARTS - 1)) if i + 1 < _STARTS else _FAR
        if here <= before and here <= after:
            s, distance2, found = _refine(tunnel, px, py, pz, piece + i / (_STARTS - 1))
            if distance2 < best2:
                best, best2, best_found = s, distance2, found
        before, here = here, after
    return best, math.sqrt(best2), best_found


@kernel
def _search_pieces(
    tunnel: TunnelRecord, px: float, py: float, pz: float, first: int, stop: int, s: float, bound: float, tie: float
) -> tuple[float, float]:
    """Search pieces first..stop-1 for a point nearer than `bound` [m]; a later minimum must be nearer by `tie` [m]."""
    for piece in range(first, stop):
        length = tunnel.arc_length[piece + 1] - tunnel.arc_length[piece]
        if math.sqrt(_distance2(tunnel, px, py, pz, piece, 0.5)) - length < bound:
            candidate, distance, found = _best_in_piece(tunnel, px, py, pz, piece)
            if distance < bound:
                s = candidate
                bound = distance - tie if found else distance
    return s, bound


@kernel
def search(tunnel: TunnelRecord, px: float, py: float, pz: float, tie: float) -> float:
    """Parameter s of the closest point of the whole bisector; a later one must be nearer by `tie` [m]."""
    s, _ = _search_pieces(tunnel, px, py, pz, 0, tunnel.pieces, 0.0, _FAR, tie)
    return s


@kernel
def _radius_here(tunnel: TunnelRecord, s: float) -> float:
    """Scaled tunnel radius at s, >= 0 [m]."""
    piece, u = locate(tunnel, s)
    a = tunnel.radius[piece]
    radius: float = max(0.0, tunnel.radius_scale * (a[0] + u * (a[1] + u * (a[2] + u * a[3]))))
    return radius


@kernel
def track(tunnel: TunnelRecord, px: float, py: float, pz: float, state: TunnelStateRecord) -> float:
    """Track the closest point from tick to tick; the method of the 1 kHz loop.

    The point stays on its branch, so that crossing and closed tunnels keep their progress, until the branch is lost:
    Newton does not end in a minimum, the distance grew by more than the motion of the ball (impossible on one branch),
    the ball moved farther than a tick allows, or another branch is nearer by the tunnel radius and by 10 mm at least.

    Args:
        tunnel: TUNNEL record with pieces > 0.
        px: Ball centre, world [m].
        py: Ball centre, world [m].
        pz: Ball centre, world [m].
        state: TUNNEL_STATE record; reads and writes its tracking fields.

    Returns:
        Tunnel parameter s of the closest point [pieces], 0 to tunnel.pieces.
    """
    s, distance2, found = _refine(tunnel, px, py, pz, state.s)
    return _keep_branch(tunnel, px, py, pz, state, s, distance2, found)


@kernel
def track_one_step(tunnel: TunnelRecord, px: float, py: float, pz: float, state: TunnelStateRecord) -> float:
    """Rival: `track` with a single Newton step per tick; its error is quadratic in the motion of a tick.

    A step that ascends, or starts where the distance is not convex, is replaced by the guarded steps of `track`.
    """
    last = float(tunnel.pieces)
    before2, gradient, bend, speed2 = slope(tunnel, px, py, pz, state.s)
    s = min(max(state.s + _newton_step(gradient, bend, speed2), 0.0), last)
    piece, u = locate(tunnel, s)
    distance2 = _distance2(tunnel, px, py, pz, piece, u)
    found = bend > _MIN_CONVEXITY * speed2
    if not found or distance2 > before2 * (1.0 + _ROUNDING):
        s, distance2, found = _refine(tunnel, px, py, pz, state.s)
    return _keep_branch(tunnel, px, py, pz, state, s, distance2, found)


@kernel
def _keep_branch(
    tunnel: TunnelRecord,
    px: float,
    py: float,
    pz: float,
    state: TunnelStateRecord,
    s: float,
    distance2: float,
    found: bool,
) -> float:
    """Accept s as the tracked point, unless the branch is lost; see `track`."""
    moved = math.sqrt((px - state.tracked[0]) ** 2 + (py - state.tracked[1]) ** 2 + (pz - state.tracked[2]) ** 2)
    distance = math.sqrt(distance2)
    state.ticks += 1
    if state.tracking == 0 or moved > _TELEPORT or not found or distance > state.distance + moved + _NO_GROWTH:
        s = search(tunnel, px, py, pz, _TIE if state.tracking == 0 else 0.0)
        state.tracking = 1
        state.ticks = 0
        state.restarts += 1
    else:
        part = state.ticks % _SLICES
        first = tunnel.pieces * part // _SLICES
        stop = tunnel.pieces * (part + 1) // _SLICES
        bound = distance - max(_SWITCH_MARGIN, _radius_here(tunnel, s))
        if bound > 0.0 and stop > first:
            s, _ = _search_pieces(tunnel, px, py, pz, first, stop, s, bound, 0.0)
    piece, u = locate(tunnel, s)
    state.s = s
    state.distance = math.sqrt(_distance2(tunnel, px, py, pz, piece, u))
    state.tracked[0] = px
    state.tracked[1] = py
    state.tracked[2] = pz
    return s


@kernel
def project(tunnel: TunnelRecord, px: float, py: float, pz: float, state: TunnelStateRecord) -> float:
    """Closest point by the method of the parameter block (contracts.loop.haptic.Projection)."""
    if tunnel.projection == Projection.NEWTON_ONE_STEP:
        return track_one_step(tunnel, px, py, pz, state)
    if tunnel.projection == Projection.GOLDEN_SECTION:
        s = project_golden_section(tunnel, px, py, pz, state)
    elif tunnel.projection == Projection.BRUTE_FORCE:
        s = project_brute_force(tunnel, px, py, pz, state)
    else:
        return track(tunnel, px, py, pz, state)
    piece, u = locate(tunnel, s)
    state.s = s
    state.distance = math.sqrt(_distance2(tunnel, px, py, pz, piece, u))
    state.tracking = 0  # a change back to tracking begins with a full search
    return s


@kernel
def project_brute_force(tunnel: TunnelRecord, px: float, py: float, pz: float, state: TunnelStateRecord) -> float:
    """Rival: the nearest of 256 points per piece, exact to half their spacing; `state` is not changed."""
    best2 = _FAR
    best: float = state.s
    for piece in range(tunnel.pieces):
        for i in range(_BRUTE_SAMPLES + 1):
            u = i / _BRUTE_SAMPLES
            distance2 = _distance2(tunnel, px, py, pz, piece, u)
            if distance2 < best2:
                best2 = distance2
                best = piece + u
    return best


@kernel
def project_golden_section(tunnel: TunnelRecord, px: float, py: float, pz: float, state: TunnelStateRecord) -> float:
    """Rival: golden-section search around the nearest of 8 points per piece, without derivatives.

    It compares distances, hence finds s to the square root of machine precision only; `state` is not changed.
    """
    best2 = _FAR
    best = state.s
    for i in range(tunnel.pieces * _GOLDEN_SAMPLES + 1):
        piece, u = locate(tunnel, i / _GOLDEN_SAMPLES)
        distance2 = _distance2(tunnel, px, py, pz, piece, u)
        if distance2 < best2:
            best2 = distance2
            best = piece + u
    low = max(best - 1.0 / _GOLDEN_SAMPLES, 0.0)
    high = min(best + 1.0 / _GOLDEN_SAMPLES, float(tunnel.pieces))
    s = _golden_section(tunnel, px, py, pz, low, high)
    # The bracket never reaches its own ends; at an end of the tunnel that would miss the cap.
    found, _, _, _ = slope(tunnel, px, py, pz, s)
    if low == 0.0 and slope(tunnel, px, py, pz, low)[0] <= found:
        return low
    if high == float(tunnel.pieces) and slope(tunnel, px, py, pz, high)[0] <= found:
        return high
    return s


@kernel
def _golden_section(tunnel: TunnelRecord, px: float, py: float, pz: float, low: float, high: float) -> float:
    left = high - _GOLDEN * (high - low)
    right = low + _GOLDEN * (high - low)
    left2, _, _, _ = slope(tunnel, px, py, pz, left)
    right2, _, _, _ = slope(tunnel, px, py, pz, right)
    for _ in range(_GOLDEN_STEPS):
        if left2 <= right2:
            high, right, right2 = right, left, left2
            left = high - _GOLDEN * (high - low)
            left2, _, _, _ = slope(tunnel, px, py, pz, left)
        else:
            low, left, left2 = left, right, right2
            right = low + _GOLDEN * (high - low)
            right2, _, _, _ = slope(tunnel, px, py, pz, right)
    return 0.5 * (low + high)
