"""Forces of the haptic tunnel (D2.1 4.2.10) for one tick: wall, end caps, drag along the tunnel, assistance.

D2.1 gives words and figures only; the equations are derived in docs/decisions/010-haptic-tunnel.md. With s* the closest
bisector point, e = p - C(s*), rho = |e|, u = e/rho, t the tangent, kappa the curvature vector and c = max(0, r_t - r_k)
the clearance of the ball of radius r_k in the tunnel of radius r_t:

    depth      d  = rho - c                       d' = u.v + r_k' - c' s',   s' = t.v / (1 - kappa.e)
    wall       F_t = -max(0, k d + b d') (u - c'/(1 - kappa.e) t)            while d > 0
    along      F_d = -(drag + growth max(0, r_k - r_t)) (v.t) t
    assistance -centring e  +  advance t

With its component along t the wall force is -grad(k d^2 / 2) where the radius varies; the radial force of figure 46
alone would generate energy on a closed path. A ball larger than the tunnel has no clearance (c = 0): it is held to the
bisector and dragged, instead of jumping across it.

Each end is closed by a flat wall perpendicular to the tangent, with the same clearance c beyond the last point: a ball
beyond it is pushed back along the tangent only, and a ball at rest at the end touches nothing.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.maths.vec import dot, fill, norm
from mimics_app.rendering.haptic.kernels.tunnel_frame import arc_at, write_frame
from mimics_app.rendering.haptic.kernels.tunnel_projection import axis, locate, project
from mimics_app.rendering.haptic.kernels.tunnel_state import TunnelStatus

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import TunnelRecord, TunnelStateRecord

__all__ = ["fade_at_end", "tunnel_force"]


_SMALLEST_OFFSET = 1e-15
"""Distance from the bisector below which the wall has no direction and no force [m]."""

_MIN_STRETCH = 0.05
"""Lower bound of 1 - kappa.e [-], which keeps the force finite at the centre of curvature, outside valid tunnels."""

_ADVANCE_FADE = 0.01
"""Length before the end over which the advance force fades [m]."""

_MAX_COORDINATE = 1e6
"""Magnitude from which a position or velocity counts as not finite [m, m/s]."""


@kernel
def _is_usable(p: Vec, v: Vec, ball_radius: float, rate: float) -> bool:
    """Whether position and velocity are finite and below `_MAX_COORDINATE`; the comparison is false for NaN."""
    total = abs(ball_radius) + abs(rate)
    for i in range(3):
        total += abs(p[i]) + abs(v[i])
    return total < _MAX_COORDINATE


@kernel
def fade_at_end(remaining: float) -> float:
    """Share 0-1 of an advancing force at a distance `remaining` [m] before the end."""
    return min(1.0, max(0.0, remaining) / _ADVANCE_FADE)


@kernel
def _release(state: TunnelStateRecord, status: int) -> None:
    """Set all forces to 0, and request a full search at the next call."""
    state.status = status
    state.tracking = 0
    state.penetration = 0.0
    state.approach_speed = 0.0
    state.wall_force = 0.0
    fill(state.force_world, 0.0)
    fill(state.assist_world, 0.0)
    fill(state.force_tnb, 0.0)


@kernel
def tunnel_force(tunnel: TunnelRecord, p: Vec, v: Vec, ball_radius: float, state: TunnelStateRecord) -> None:
    """Set the force of the tunnel on the user for one tick (D2.1 4.2.10), and the position of the ball in it.

    Deterministic; allocates nothing. The force is finite for every input: a position, velocity or ball radius that is
    not finite (or beyond 1e6) gives zero force, status NOT_FINITE and a full search afterwards.

    Args:
        tunnel: TUNNEL record.
        p: Ball centre, world [m], shape [3].
        v: Its velocity, world [m/s], shape [3].
        ball_radius: r_k [m], >= 0.
        state: Record of dtype TUNNEL_STATE; memory of the last call and all results.
    """
    if tunnel.pieces <= 0:
        _release(state, TunnelStatus.NO_TUNNEL)
        return
    if not _is_usable(p, v, ball_radius, state.ball_radius_rate):
        _release(state, TunnelStatus.NOT_FINITE)
        return
    state.status = TunnelStatus.FOLLOWING
    s = project(tunnel, p[0], p[1], p[2], state)
    piece, u = locate(tunnel, s)
    x, x1, x2 = axis(tunnel, piece, 0, u)
    y, y1, y2 = axis(tunnel, piece, 1, u)
    z, z1, z2 = axis(tunnel, piece, 2, u)
    speed2 = x1 * x1 + y1 * y1 + z1 * z1
    speed = math.sqrt(speed2)
    state.tangent[0] = x1 / speed
    state.tangent[1] = y1 / speed
    state.tangent[2] = z1 / speed
    write_frame(tunnel, piece, u, x, y, z, state)
    arc = arc_at(tunnel, piece, u)
    total = tunnel.arc_length[tunnel.pieces]
    state.progress = min(max(arc / total, 0.0), 1.0)

    a = tunnel.radius[piece]
    radius = tunnel.radius_scale * (a[0] + u * (a[1] + u * (a[2] + u * a[3])))
    radius_slope = tunnel.radius_scale * (a[1] + u * (2.0 * a[2] + 3.0 * u * a[3])) / speed
    if radius <= 0.0:
        radius = 0.0
        radius_slope = 0.0
    state.radius = radius

    ex = p[0] - x
    ey = p[1] - y
    ez = p[2] - z
    bend = (ex * x2 + ey * y2 + ez * z2) / speed2
    _add_forces(tunnel, (ex, ey, ez), bend, radius_slope, total - arc, v, ball_radius, state)


@kernel
def _push(tunnel: TunnelRecord, state: TunnelStateRecord, depth: float, rate: float) -> float:
    """Spring-damper of wall and caps [N], for a depth > 0 [m] that grows at `rate` [m/s]; it never pulls."""
    spring = tunnel.stiffness * (1.0 - state.softening) * depth
    return max(0.0, spring + tunnel.damping * (1.0 - state.damping_softening) * rate)


@kernel
def _within(value: float, most: float) -> float:
    """A value of a row within a limit; 0: no limit."""
    return min(value, most) if most > 0.0 else value


@kernel
def _wall(
    tunnel: TunnelRecord,
    e: tuple[float, float, float],
    lean: float,
    clearance: float,
    clearance_rate: float,
    v: Vec,
    state: TunnelStateRecord,
) -> tuple[float, float]:
    """Set the wall's force for the offset e across the tunnel; return its depth [m] and rate [m/s].

    `lean` = c' / (1 - kappa.e) tilts the force along the tunnel where the radius changes.
    """
    f = state.force_world
    rho = norm(e)
    if rho <= clearance or rho < _SMALLEST_OFFSET:
        fill(f, 0.0)
        return 0.0, 0.0
    dx = e[0] / rho - lean * state.tangent[0]
    dy = e[1] / rho - lean * state.tangent[1]
    dz = e[2] / rho - lean * state.tangent[2]
    rate = v[0] * dx + v[1] * dy + v[2] * dz - clearance_rate
    push = _push(tunnel, state, rho - clearance, rate)
    f[0] = -push * dx
    f[1] = -push * dy
    f[2] = -push * dz
    return rho - clearance, rate


@kernel
def _add_cap(
    tunnel: TunnelRecord, along: float, v_t: float, clearance: float, clearance_rate: float, state: TunnelStateRecord
) -> tuple[float, float]:
    """Add the force of a flat cap, `along` [m] beyond end (> 0) or start (< 0); return its depth [m] and rate [m/s]."""
    depth = abs(along) - clearance
    if depth <= 0.0:
        return 0.0, 0.0
    outwards = 1.0 if along > 0.0 else -1.0
    rate = outwards * v_t - clearance_rate
    push = _push(tunnel, state, depth, rate)
    for i in range(3):
        state.force_world[i] -= outwards * push * state.tangent[i]
    return depth, rate


@kernel
def _write_contact(wall: tuple[float, float], cap: tuple[float, float], state: TunnelStateRecord) -> None:
    """Set depth and rate of the deeper of wall and cap, and magnitude and direction of their sum."""
    deeper = cap if cap[0] > wall[0] else wall
    state.penetration = deeper[0]
    state.approach_speed = deeper[1]
    f = state.force_world
    state.wall_force = norm(f)
    if state.wall_force > 0.0:
        for i in range(3):
            state.normal_world[i] = f[i] / state.wall_force


@kernel
def _add_forces(
    tunnel: TunnelRecord,
    offset: tuple[float, float, float],
    bend: float,
    radius_slope: float,
    remaining: float,
    v: Vec,
    ball_radius: float,
    state: TunnelStateRecord,
) -> None:
    """Sum wall, cap, drag and assistance for offset = p - C(s) [m]; bend = kappa.e [-], remaining arc [m]."""
    tx = state.tangent[0]
    ty = state.tangent[1]
    tz = state.tangent[2]
    along = offset[0] * tx + offset[1] * ty + offset[2] * tz
    beyond = (state.s <= 0.0 and along < 0.0) or (state.s >= tunnel.pieces and along > 0.0)
    if not beyond:
        along = 0.0
    # Beyond an end the tunnel continues as a straight pipe up to the flat cap; e is what lies across it.
    e = (offset[0] - along * tx, offset[1] - along * ty, offset[2] - along * tz)
    v_t = v[0] * tx + v[1] * ty + v[2] * tz

    clearance = max(0.0, state.radius - ball_radius)
    clearance_rate = -state.ball_radius_rate if clearance > 0.0 else 0.0
    lean = 0.0 if beyond or clearance <= 0.0 else radius_slope / max(1.0 - bend, _MIN_STRETCH)
    wall = _wall(tunnel, e, lean, clearance, clearance_rate, v, state)
    cap = _add_cap(tunnel, along, v_t, clearance, clearance_rate, state)
    _write_contact(wall, cap, state)

    drag = -_within(tunnel.drag + tunnel.drag_growth * max(0.0, ball_radius - state.radius), state.most_drag) * v_t
    advance = 0.0 if along > 0.0 else tunnel.advance * fade_at_end(remaining)
    centring = _within(tunnel.centring, state.most_centring)
    helping = advance - centring * along
    for i in range(3):
        state.assist_world[i] = helping * state.tangent[i] - centring * e[i]
        state.force_world[i] += drag * state.tangent[i] + state.assist_world[i]
    _resolve(e, state)


@kernel
def _resolve(e: tuple[float, float, float], state: TunnelStateRecord) -> None:
    """Set offset and force along t, n, b; a force that is not finite becomes zero."""
    t = state.tangent
    n = state.normal_n
    b = state.binormal
    f = state.force_world
    state.offset_n = dot(e, n)
    state.offset_b = dot(e, b)
    state.force_tnb[0] = dot(f, t)
    state.force_tnb[1] = dot(f, n)
    state.force_tnb[2] = dot(f, b)
    if not math.isfinite(f[0] + f[1] + f[2]):
        _release(state, TunnelStatus.NOT_FINITE)
