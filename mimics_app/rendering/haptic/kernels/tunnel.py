"""Forces of the haptic tunnel (D2.1 4.2.10) for one tick: wall, end caps, drag along the tunnel, assistance.

D2.1 gives words and figures only; the form used is derived in docs/decisions/tunnel.md. With s* the closest bisector
point, e = p - C(s*), rho = |e|, u = e/rho, t the tangent, kappa the curvature vector and c = max(0, r_t - r_k) the room
the ball of radius r_k has in the tunnel of radius r_t:

    depth      d  = rho - c                       d' = u.v + r_k' - c' s',   s' = t.v / (1 - kappa.e)
    wall       F_t = -max(0, k d + b d') (u - c'/(1 - kappa.e) t)            while d > 0
    along      F_d = -(drag + growth max(0, r_k - r_t)) (v.t) t
    assistance -centring e  +  advance t

The t-part of the wall force makes it -grad(k d^2 / 2) where the radius varies; the radial force drawn in figure 46 alone
would let a person gain energy on a loop. A ball larger than the tunnel has no room (c = 0): it is held to the bisector
and dragged, instead of being thrown across it.

Each end is closed by a flat wall, square to the tangent, that leaves the same room c beyond the last point: a ball that
leaves through it is pushed back along the tangent only, and a ball at rest at the end touches nothing.

Angles of t, n, b: n and b turn with the curve as little as possible (rotation-minimising frame), b = t x n.
"""

from __future__ import annotations

import math
from enum import IntEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.kernel import kernel
from mimics_app.rendering.haptic.kernels.tunnel_projection import axis, locate, track

__all__ = ["TUNNEL_STATE", "TunnelStatus", "restart_tracking", "tunnel_force"]

Vec = NDArray[np.float64]


class TunnelStatus(IntEnum):
    """What the last call of `tunnel_force` could do; the force is zero unless FOLLOWING."""

    NO_TUNNEL = 0
    FOLLOWING = 1
    NOT_FINITE = 2


TUNNEL_STATE = np.dtype(
    [
        # input, optional
        ("ball_radius_rate", "f8"),  # r_k' [m/s]; the caller sets it where the ball changes size, else 0
        # tracking: zero means "start afresh" (see restart_tracking)
        ("tracking", "i8"),  # 0: the next call searches the whole tunnel
        ("s", "f8"),  # tunnel parameter of the closest bisector point [pieces], warm start of the next call
        ("distance", "f8"),  # of the ball centre from the bisector [m]
        ("tracked", "f8", (3,)),  # ball centre of the last call, world [m]
        ("ticks", "i8"),  # calls since the last full search
        ("restarts", "i8"),  # full searches since the state was zeroed
        # outputs
        ("status", "i8"),  # TunnelStatus
        ("progress", "f8"),  # share of the arc length, 0-1
        ("offset_n", "f8"),  # of the ball centre along n [m]
        ("offset_b", "f8"),  # of the ball centre along b [m]
        ("radius", "f8"),  # tunnel radius at s, scaled [m]
        ("penetration", "f8"),  # of the ball into wall or end cap, the deeper of the two, >= 0 [m]
        ("approach_speed", "f8"),  # rate of that depth [m/s], > 0: going in
        ("force_world", "f8", (3,)),  # all of the tunnel on the user [N]
        ("force_tnb", "f8", (3,)),  # the same along t, n, b [N]
        ("wall_force", "f8"),  # magnitude of wall and cap alone, >= 0 [N]
        ("normal_world", "f8", (3,)),  # out of the touched surface, unit; kept from the last contact
        ("tangent", "f8", (3,)),  # world, unit, towards the end
        ("normal_n", "f8", (3,)),  # n, world, unit
        ("binormal", "f8", (3,)),  # b, world, unit
    ],
    align=True,
)
"""Memory and results of one ball in one tunnel. All zero is a valid start."""

_MIN_STRETCH = 0.05
"""Floor of 1 - kappa.e: at the centre of curvature, outside any lawful tunnel, the force stays finite."""

_ADVANCE_FADE = 0.01
"""The advance force fades over this length before the end [m]."""

_MAX_COORDINATE = 1e6
"""Beyond this [m, m/s] a position or velocity counts as not finite."""


@kernel
def restart_tracking(state: Any) -> None:
    """Forget the branch: the next call searches the whole tunnel and, in a tie, starts at the beginning."""
    state.tracking = 0
    state.s = 0.0


@kernel
def _is_usable(p: Vec, v: Vec, ball_radius: float, rate: float) -> bool:
    """False for NaN, infinities and absurd sizes; written so that NaN fails every comparison."""
    total = abs(ball_radius) + abs(rate)
    for i in range(3):
        total += abs(p[i]) + abs(v[i])
    return total < _MAX_COORDINATE


@kernel
def _arc_at(tunnel: Any, piece: int, u: float) -> float:
    """Arc length [m] at u by the cubic that has the exact length and speed at both ends of the piece."""
    start = tunnel.arc_length[piece]
    length = tunnel.arc_length[piece + 1] - start
    speed_0 = 0.0
    speed_1 = 0.0
    for i in range(3):
        _, first, _ = axis(tunnel, piece, i, 0.0)
        _, last, _ = axis(tunnel, piece, i, 1.0)
        speed_0 += first * first
        speed_1 += last * last
    speed_0 = math.sqrt(speed_0)
    speed_1 = math.sqrt(speed_1)
    return start + u * (speed_0 + u * (3.0 * length - 2.0 * speed_0 - speed_1 + u * (speed_0 + speed_1 - 2.0 * length)))


@kernel
def _carry_normal(
    tunnel: Any, piece: int, end: int, x: float, y: float, z: float, tx: float, ty: float, tz: float
) -> tuple[float, float, float]:
    """Normal at a point of a piece, carried from one of its ends by double reflection (Wang et al. 2008, table I)."""
    x0, tx0, _ = axis(tunnel, piece, 0, float(end))
    y0, ty0, _ = axis(tunnel, piece, 1, float(end))
    z0, tz0, _ = axis(tunnel, piece, 2, float(end))
    speed = math.sqrt(tx0 * tx0 + ty0 * ty0 + tz0 * tz0)
    tx0 /= speed
    ty0 /= speed
    tz0 /= speed
    nx = tunnel.normal[piece + end, 0]
    ny = tunnel.normal[piece + end, 1]
    nz = tunnel.normal[piece + end, 2]
    ax = x - x0
    ay = y - y0
    az = z - z0
    square = ax * ax + ay * ay + az * az
    if square > 1e-24:
        f = 2.0 * (ax * nx + ay * ny + az * nz) / square
        nx -= f * ax
        ny -= f * ay
        nz -= f * az
        f = 2.0 * (ax * tx0 + ay * ty0 + az * tz0) / square
        tx0 -= f * ax
        ty0 -= f * ay
        tz0 -= f * az
    ax = tx - tx0
    ay = ty - ty0
    az = tz - tz0
    square = ax * ax + ay * ay + az * az
    if square > 1e-24:
        f = 2.0 * (ax * nx + ay * ny + az * nz) / square
        nx -= f * ax
        ny -= f * ay
        nz -= f * az
    return nx, ny, nz


@kernel
def _write_frame(tunnel: Any, piece: int, u: float, x: float, y: float, z: float, state: Any) -> None:
    """n and b at the closest point: normals carried from both ends of the piece, blended, so that no knot shows."""
    tx = state.tangent[0]
    ty = state.tangent[1]
    tz = state.tangent[2]
    ax, ay, az = _carry_normal(tunnel, piece, 0, x, y, z, tx, ty, tz)
    bx, by, bz = _carry_normal(tunnel, piece, 1, x, y, z, tx, ty, tz)
    nx = (1.0 - u) * ax + u * bx
    ny = (1.0 - u) * ay + u * by
    nz = (1.0 - u) * az + u * bz
    along = nx * tx + ny * ty + nz * tz
    nx -= along * tx
    ny -= along * ty
    nz -= along * tz
    size = math.sqrt(nx * nx + ny * ny + nz * nz)
    nx /= size
    ny /= size
    nz /= size
    state.normal_n[0] = nx
    state.normal_n[1] = ny
    state.normal_n[2] = nz
    state.binormal[0] = ty * nz - tz * ny
    state.binormal[1] = tz * nx - tx * nz
    state.binormal[2] = tx * ny - ty * nx


@kernel
def _release(state: Any, status: int) -> None:
    """No force, and a fresh search at the next call."""
    state.status = status
    state.tracking = 0
    state.penetration = 0.0
    state.approach_speed = 0.0
    state.wall_force = 0.0
    for i in range(3):
        state.force_world[i] = 0.0
        state.force_tnb[i] = 0.0


@kernel
def tunnel_force(tunnel: Any, p: Vec, v: Vec, ball_radius: float, state: Any) -> None:
    """Force of the tunnel on the user for one tick (D2.1 4.2.10), and where the ball is in it.

    Deterministic; allocates nothing. The force is finite for every input: a position, velocity or ball radius that is
    not finite (or beyond 1e6) gives zero force, status NOT_FINITE and a fresh search afterwards.

    Args:
        tunnel: Record of dtype contracts.haptic.TUNNEL.
        p: Ball centre, world [m], shape [3].
        v: Its velocity, world [m/s], shape [3].
        ball_radius: r_k [m], >= 0.
        state: Record of dtype TUNNEL_STATE; memory of the last call and all results.
    """
    if tunnel.pieces <= 0:
        _release(state, 0)
        return
    if not _is_usable(p, v, ball_radius, state.ball_radius_rate):
        _release(state, 2)
        return
    state.status = 1
    s = track(tunnel, p[0], p[1], p[2], state)
    piece, u = locate(tunnel, s)
    x, x1, x2 = axis(tunnel, piece, 0, u)
    y, y1, y2 = axis(tunnel, piece, 1, u)
    z, z1, z2 = axis(tunnel, piece, 2, u)
    speed2 = x1 * x1 + y1 * y1 + z1 * z1
    speed = math.sqrt(speed2)
    state.tangent[0] = x1 / speed
    state.tangent[1] = y1 / speed
    state.tangent[2] = z1 / speed
    _write_frame(tunnel, piece, u, x, y, z, state)
    arc = _arc_at(tunnel, piece, u)
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
    _add_forces(tunnel, ex, ey, ez, bend, radius_slope, total - arc, v, ball_radius, state)


@kernel
def _add_forces(
    tunnel: Any,
    ex: float,
    ey: float,
    ez: float,
    bend: float,
    radius_slope: float,
    remaining: float,
    v: Vec,
    ball_radius: float,
    state: Any,
) -> None:
    """Sum wall, cap, drag and assistance for the offset e = p - C(s) [m]; bend = kappa.e [-], remaining arc [m]."""
    tx = state.tangent[0]
    ty = state.tangent[1]
    tz = state.tangent[2]
    along = ex * tx + ey * ty + ez * tz
    v_t = v[0] * tx + v[1] * ty + v[2] * tz
    room = state.radius - ball_radius
    excess = max(0.0, -room)
    room_rate = -state.ball_radius_rate if room > 0.0 else 0.0
    room_slope = radius_slope if room > 0.0 else 0.0
    room = max(0.0, room)
    at_end = (state.s <= 0.0 and along < 0.0) or (state.s >= tunnel.pieces and along > 0.0)
    if at_end:
        # Beyond an end the tunnel goes on as a straight pipe up to the flat cap.
        room_slope = 0.0
        bend = 0.0
        ex -= along * tx
        ey -= along * ty
        ez -= along * tz

    cap_force, cap_depth, cap_rate = 0.0, 0.0, 0.0
    if at_end and abs(along) > room:
        out = 1.0 if along > 0.0 else -1.0
        cap_depth = abs(along) - room
        cap_rate = out * v_t - room_rate
        cap_force = -out * max(0.0, tunnel.stiffness * cap_depth + tunnel.damping * cap_rate)

    rho = math.sqrt(ex * ex + ey * ey + ez * ez)
    wall_x, wall_y, wall_z, wall_depth, wall_rate = 0.0, 0.0, 0.0, 0.0, 0.0
    if rho > room and rho > 1e-300:
        wall_depth = rho - room
        lean = room_slope / max(1.0 - bend, _MIN_STRETCH)
        dx = ex / rho - lean * tx
        dy = ey / rho - lean * ty
        dz = ez / rho - lean * tz
        wall_rate = v[0] * dx + v[1] * dy + v[2] * dz - room_rate
        push = max(0.0, tunnel.stiffness * wall_depth + tunnel.damping * wall_rate)
        wall_x = -push * dx
        wall_y = -push * dy
        wall_z = -push * dz

    fx = wall_x + cap_force * tx
    fy = wall_y + cap_force * ty
    fz = wall_z + cap_force * tz
    contact = math.sqrt(fx * fx + fy * fy + fz * fz)
    if contact > 0.0:
        state.normal_world[0] = fx / contact
        state.normal_world[1] = fy / contact
        state.normal_world[2] = fz / contact
    state.wall_force = contact
    state.penetration = max(wall_depth, cap_depth)
    state.approach_speed = cap_rate if cap_depth > wall_depth else wall_rate

    drag = -(tunnel.drag + tunnel.drag_growth * excess) * v_t
    beyond = state.s >= tunnel.pieces and along > 0.0
    advance = 0.0 if beyond else tunnel.advance * min(1.0, max(0.0, remaining) / _ADVANCE_FADE)
    tangential = drag + advance
    if at_end:
        tangential -= tunnel.centring * along
    state.force_world[0] = fx + tangential * tx - tunnel.centring * ex
    state.force_world[1] = fy + tangential * ty - tunnel.centring * ey
    state.force_world[2] = fz + tangential * tz - tunnel.centring * ez
    _resolve(ex, ey, ez, state)


@kernel
def _resolve(ex: float, ey: float, ez: float, state: Any) -> None:
    """Offset and force along t, n, b; a force that is not finite is released as zero."""
    t = state.tangent
    n = state.normal_n
    b = state.binormal
    f = state.force_world
    state.offset_n = ex * n[0] + ey * n[1] + ez * n[2]
    state.offset_b = ex * b[0] + ey * b[1] + ez * b[2]
    state.force_tnb[0] = f[0] * t[0] + f[1] * t[1] + f[2] * t[2]
    state.force_tnb[1] = f[0] * n[0] + f[1] * n[1] + f[2] * n[2]
    state.force_tnb[2] = f[0] * b[0] + f[1] * b[1] + f[2] * b[2]
    if not math.isfinite(f[0] + f[1] + f[2]):
        _release(state, 2)
