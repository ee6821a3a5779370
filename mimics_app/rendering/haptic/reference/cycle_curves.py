"""Curves over a cycle with their derivatives: Fourier series, cubic table, linear table.

Each writes a SLOPES record: the value c of a curve at a phase, its derivatives by the phase, and, for a series whose
coefficients are a + b u + d u^2, those by u.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.loop.reference_rows import CurveKind

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import CurveRecord, SlopesRecord

__all__ = ["SLOPES", "cubic_at", "curve_at", "linear_at", "series_at"]

_SIXTH = 1.0 / 6.0
"""Coefficient of a spline's second derivatives."""

SLOPES = np.dtype(
    [
        ("value", "f8"),  # c [m, rad]
        ("by_phase", "f8"),  # dc/dphase [per cycle]
        ("by_phase_twice", "f8"),  # its second derivative by the phase
        ("by_u", "f8"),  # dc/du
        ("by_u_twice", "f8"),
        ("by_both", "f8"),  # by phase and u
    ],
    align=True,
)
"""A curve at one phase."""


@kernel
def _clear(out: SlopesRecord) -> None:
    out.value = out.by_phase = out.by_phase_twice = out.by_u = out.by_u_twice = out.by_both = 0.0


@kernel
def series_at(curve: CurveRecord, phase: float, u: float, out: SlopesRecord) -> None:
    """Evaluate a Fourier series; cosine and sine of the harmonics follow from the first by rotation."""
    _clear(out)
    a, b, d = curve.values[0, 0], curve.values[1, 0], curve.values[2, 0]
    out.value, out.by_u, out.by_u_twice = a + u * (b + u * d), b + 2.0 * u * d, 2.0 * d
    first = 2.0 * math.pi * phase
    c1, s1 = math.cos(first), math.sin(first)
    c, s = 1.0, 0.0
    for n in range(1, (curve.used + 1) // 2):
        c, s = c * c1 - s * s1, s * c1 + c * s1
        w, i = 2.0 * math.pi * n, 2 * n - 1
        p = curve.values[0, i] + u * (curve.values[1, i] + u * curve.values[2, i])
        q = curve.values[0, i + 1] + u * (curve.values[1, i + 1] + u * curve.values[2, i + 1])
        p1, q1 = (
            curve.values[1, i] + 2.0 * u * curve.values[2, i],
            curve.values[1, i + 1] + 2.0 * u * curve.values[2, i + 1],
        )
        out.value += p * c + q * s
        out.by_phase += w * (q * c - p * s)
        out.by_phase_twice -= w * w * (p * c + q * s)
        out.by_u += p1 * c + q1 * s
        out.by_both += w * (q1 * c - p1 * s)
        out.by_u_twice += 2.0 * (curve.values[2, i] * c + curve.values[2, i + 1] * s)


@kernel
def cubic_at(curve: CurveRecord, phase: float, out: SlopesRecord) -> None:
    """Evaluate a periodic cubic spline from its knots and their second derivatives; continuous up to the second."""
    _clear(out)
    count = curve.used
    place = phase * count
    k = min(int(place), count - 1)
    n = (k + 1) % count
    x, h = place - k, 1.0 / count
    a, b = curve.values[0, k], curve.values[0, n]
    bend_a, bend_b = curve.values[1, k], curve.values[1, n]
    y = 1.0 - x
    out.value = y * a + x * b + _SIXTH * h * h * ((y * y * y - y) * bend_a + (x * x * x - x) * bend_b)
    out.by_phase = (b - a) / h + h * ((0.5 * x * x - _SIXTH) * bend_b - (0.5 * y * y - _SIXTH) * bend_a)
    out.by_phase_twice = y * bend_a + x * bend_b


@kernel
def linear_at(curve: CurveRecord, phase: float, out: SlopesRecord) -> None:
    """Interpolate a table linearly: its velocity jumps at every knot, and its acceleration is 0 between them."""
    _clear(out)
    count = curve.used
    place = phase * count
    k = min(int(place), count - 1)
    a, b = curve.values[0, k], curve.values[0, (k + 1) % count]
    out.value, out.by_phase = a + (place - k) * (b - a), (b - a) * count


@kernel
def curve_at(curve: CurveRecord, phase: float, u: float, out: SlopesRecord) -> None:
    """Evaluate the curve of a joint.

    Args:
        curve: CURVE record.
        phase: Phase of the joint's cycle, 0 to 1.
        u: Speed or step on which a series depends.
        out: SLOPES record; of no curve 0.
    """
    if curve.kind == CurveKind.SERIES:
        series_at(curve, phase, u, out)
    elif curve.kind == CurveKind.CUBIC:
        cubic_at(curve, phase, out)
    elif curve.kind == CurveKind.LINEAR:
        linear_at(curve, phase, out)
    else:
        _clear(out)
