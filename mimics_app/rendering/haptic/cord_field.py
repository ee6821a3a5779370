"""Force field of a cord: a tube around a catenary, whose parameters follow the moving cord."""

from __future__ import annotations

import math

import numpy as np

from mimics_app.compiled.kernel import kernel, typed_kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.loop.loop_ports import FIELD

__all__ = ["cord"]


_SAMPLES = 16
"""Samples along the cord for the start of Newton's method."""

_STEPS = 4
"""Newton steps."""

_MIN_SLOPE = 0.2
"""Smallest derivative of the function whose zero is sought: it vanishes near the centre of a bend."""

_PLACE = 4
"""Components of a point of the cord: position along and up, tangent along and up."""

_ON_THE_LINE = 1e-6
"""Distance from the centre line below which there is no normal [m]."""


@kernel
def _place(a: float, q: float, s: float, out: Vec) -> None:
    """Write position and tangent of the centre line, along and up, at arc length s; see maths.cord.Catenary.point."""
    w = s / a
    p = q + w
    root_p, root_q = math.sqrt(1.0 + p * p), math.sqrt(1.0 + q * q)
    apart = w * (p + q) / (p * root_q + q * root_p) if p * q > 0.0 else p * root_q - q * root_p
    out[0] = a * math.asinh(apart)
    out[1] = s * (p + q) / (root_p + root_q)
    out[2] = 1.0 / root_p
    out[3] = p / root_p


@kernel
def _nearest(a: float, q: float, length: float, x: float, y: float, at: Vec) -> None:
    """Write the closest point of the cord in its own plane into `at`, as `_place` does."""
    best, s = np.inf, 0.0
    for k in range(_SAMPLES + 1):
        _place(a, q, length * k / _SAMPLES, at)
        away = (x - at[0]) ** 2 + (y - at[1]) ** 2
        if away < best:
            best, s = away, length * k / _SAMPLES
    for _ in range(_STEPS):
        _place(a, q, s, at)
        dx, dy = x - at[0], y - at[1]
        bend = at[2] * at[2] / a
        slope = 1.0 - bend * (dy * at[2] - dx * at[3])
        s += (dx * at[2] + dy * at[3]) / max(slope, _MIN_SLOPE)
        s = min(max(s, 0.0), length)
    _place(a, q, s, at)


@typed_kernel(FIELD)
def cord(parameters: Vec, p: Vec, v: Vec, t: float, out: Vec) -> None:
    """Tube around a catenary: spring and damper along its normal, outward only.

    The field's position is the start of the cord. Parameters: direction of the other end along world x and z (unit),
    a [m] and the slope at the start (maths.cord.Catenary), length [m], sum of the radii of tube and HIP [m],
    stiffness [N/m], damping [N s/m]. Length 0: no force.
    """
    out[0] = out[1] = out[2] = 0.0
    ax, az, a, length, radius = parameters[0], parameters[1], parameters[2], parameters[4], parameters[5]
    if length <= 0.0 or a <= 0.0:
        return
    x, z = ax * p[0] + az * p[2], ax * p[2] - az * p[0]
    at = np.empty(_PLACE)
    _nearest(a, parameters[3], length, x, p[1], at)
    dx, dy = x - at[0], p[1] - at[1]
    away = math.sqrt(dx * dx + dy * dy + z * z)
    if away >= radius or away < _ON_THE_LINE:
        return
    nx, ny, nz = (ax * dx - az * z) / away, dy / away, (az * dx + ax * z) / away
    leaving = nx * v[0] + ny * v[1] + nz * v[2]
    force = max(0.0, parameters[6] * (radius - away) - parameters[7] * leaving)
    out[0], out[1], out[2] = force * nx, force * ny, force * nz
