"""Arc length along a tunnel's bisector, and the axes t, n, b at one of its points.

n and b are those of a rotation-minimising frame, b = t x n.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mimics_app.compiled.kernel import kernel
from mimics_app.rendering.haptic.kernels.tunnel_projection import axis

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import TunnelRecord, TunnelStateRecord

__all__ = ["arc_at", "write_frame"]

_NO_DIRECTION = 1e-24
"""Square of a length below which its direction is undefined [m^2]."""

_NO_NORMAL = 1e-12
"""Smallest length by which a blended normal is divided [-]."""

_GAUSS_3 = 0.5 * math.sqrt(0.6)
"""Offset of the outer nodes of three-point Gauss-Legendre from the midpoint of [0, 1]."""

_STRAIGHT = 1e-6
"""Curvature below which the bisector counts as straight [1/m]."""


@kernel
def _speed(tunnel: TunnelRecord, piece: int, u: float) -> float:
    """|dC/du| [m]."""
    _, x, _ = axis(tunnel, piece, 0, u)
    _, y, _ = axis(tunnel, piece, 1, u)
    _, z, _ = axis(tunnel, piece, 2, u)
    return math.sqrt(x * x + y * y + z * z)


@kernel
def _length_to(tunnel: TunnelRecord, piece: int, u: float) -> float:
    """Arc length of the piece from 0 to u [m] by three-point Gauss-Legendre."""
    outer = _speed(tunnel, piece, (0.5 - _GAUSS_3) * u) + _speed(tunnel, piece, (0.5 + _GAUSS_3) * u)
    return u * (5.0 * outer + 8.0 * _speed(tunnel, piece, 0.5 * u)) / 18.0


@kernel
def arc_at(tunnel: TunnelRecord, piece: int, u: float) -> float:
    """Arc length up to u of a piece [m]; the quadrature error is distributed over the piece: continuous at knots."""
    start = tunnel.arc_length[piece]
    missing = tunnel.arc_length[piece + 1] - start - _length_to(tunnel, piece, 1.0)
    arc: float = start + _length_to(tunnel, piece, u) + missing * u * u
    return arc


@kernel
def _reflect(ax: float, ay: float, az: float, x: float, y: float, z: float) -> tuple[float, float, float]:
    """Reflection of (x, y, z) in the plane with a normal (ax, ay, az) of any length; unchanged where that is 0."""
    square = ax * ax + ay * ay + az * az
    if square > _NO_DIRECTION:
        f = 2.0 * (ax * x + ay * y + az * z) / square
        return x - f * ax, y - f * ay, z - f * az
    return x, y, z


@kernel
def _carry_normal(
    tunnel: TunnelRecord, piece: int, end: int, x: float, y: float, z: float, tx: float, ty: float, tz: float
) -> tuple[float, float, float]:
    """Normal at a point of a piece, from that of one end by double reflection (Wang et al. 2008, table I)."""
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
    nx, ny, nz = _reflect(ax, ay, az, nx, ny, nz)
    tx0, ty0, tz0 = _reflect(ax, ay, az, tx0, ty0, tz0)
    return _reflect(tx - tx0, ty - ty0, tz - tz0, nx, ny, nz)


@kernel
def _frenet_normal(
    tunnel: TunnelRecord, piece: int, u: float, tx: float, ty: float, tz: float
) -> tuple[float, float, float, float]:
    """Unit normal towards the centre of curvature, and 1; zeros where the bisector is straight."""
    _, vx, ax = axis(tunnel, piece, 0, u)
    _, vy, ay = axis(tunnel, piece, 1, u)
    _, vz, az = axis(tunnel, piece, 2, u)
    along = ax * tx + ay * ty + az * tz
    ax -= along * tx
    ay -= along * ty
    az -= along * tz
    size = math.sqrt(ax * ax + ay * ay + az * az)
    if size <= _STRAIGHT * (vx * vx + vy * vy + vz * vz):
        return 0.0, 0.0, 0.0, 0.0
    return ax / size, ay / size, az / size, 1.0


@kernel
def write_frame(
    tunnel: TunnelRecord, piece: int, u: float, x: float, y: float, z: float, state: TunnelStateRecord
) -> None:
    """Set n and b at the closest point, blended from normals transported from both ends of the piece.

    The blend is continuous at knots. With `tunnel.frenet` n is the Frenet normal where the bisector bends.
    """
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
    size = max(math.sqrt(nx * nx + ny * ny + nz * nz), _NO_NORMAL)
    nx /= size
    ny /= size
    nz /= size
    if tunnel.frenet == 1:
        ax, ay, az, bent = _frenet_normal(tunnel, piece, u, tx, ty, tz)
        if bent == 1.0:
            nx, ny, nz = ax, ay, az
    state.normal_n[0] = nx
    state.normal_n[1] = ny
    state.normal_n[2] = nz
    state.binormal[0] = ty * nz - tz * ny
    state.binormal[1] = tz * nx - tx * nz
    state.binormal[2] = tx * ny - ty * nx
