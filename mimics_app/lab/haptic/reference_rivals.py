"""Rivals of a joint's reference, and the movement with which they are measured.

Probe: a knee-like movement 0.5 exp(0.9 cos a + 0.4 sin 2a) - 0.35 [rad] with a = 2 pi phase, which has every harmonic
and whose derivatives are known, at one cycle per second. A series has its Fourier coefficients, a table its values at
even phases: each as many numbers as its name says.
"""

from __future__ import annotations

import math
from functools import cache

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import F8, Records
from mimics_app.contracts.loop.reference_rows import CURVE, CurveKind
from mimics_app.lab.probe import shortest_us
from mimics_app.lab.rivals import Rival
from mimics_app.rendering.haptic.reference.cycle_curves import SLOPES, curve_at
from mimics_app.rendering.haptic.scene_reference import spline_bends

__all__ = ["REFERENCE_RIVALS", "cost_us", "jerk_error", "position_error"]

_SIZES = (11, 21, 32, 64)
_CADENCE = 1.0  # [1/s]
_TICKS = 1000  # of one cycle
_CALLS = 20

_SOURCES = {
    "series": "Fourier series of {} harmonics, summed by rotation",
    "cubic table": "periodic cubic spline of {} knots: curvature continuous",
    "linear table": "{} knots joined by straight lines",
}
_RANGES = {
    "series": "smooth cycles; all derivatives exact and continuous",
    "cubic table": "any smooth cycle; its jerk jumps at the knots",
    "linear table": "slow cycles; its velocity jumps at the knots",
}


def _movement(phase: F8) -> F8:
    a = 2.0 * np.pi * phase
    return np.asarray(0.5 * np.exp(0.9 * np.cos(a) + 0.4 * np.sin(2.0 * a)) - 0.35)


@cache
def _spectrum() -> F8:
    """Return the Fourier coefficients of the movement: mean, then cosine and sine of each harmonic."""
    count = 512
    found = np.fft.rfft(_movement(np.arange(count) / count)) / count
    out = np.zeros(2 * len(found) - 1)
    out[0], out[1::2], out[2::2] = found[0].real, 2.0 * found[1:].real, -2.0 * found[1:].imag
    return out


def _row(kind: str, numbers: int) -> Records:
    row = np.zeros(1, CURVE)
    row["used"] = numbers
    if kind == "series":
        row["kind"] = CurveKind.SERIES
        row["values"][0, 0, :numbers] = _spectrum()[:numbers]
        return row
    knots = _movement(np.arange(numbers) / numbers)
    row["values"][0, 0, :numbers] = knots
    row["kind"] = CurveKind.LINEAR
    if kind == "cubic table":
        row["kind"] = CurveKind.CUBIC
        row["values"][0, 1, :numbers] = spline_bends(knots)
    return row


@kernel
def _cycle(curves: Records, slopes: Records, rounds: int, out: F8) -> None:
    """Evaluate a cycle tick by tick, `rounds` times."""
    for _ in range(rounds):
        for k in range(out.shape[0]):
            curve_at(curves[0], k / out.shape[0], 0.0, slopes[0])
            out[k, 0], out[k, 1], out[k, 2] = slopes[0].value, slopes[0].by_phase, slopes[0].by_phase_twice


def _evaluated(kind: str, numbers: int) -> F8:
    """Return position [rad], velocity [rad/s] and acceleration [rad/s^2] of every tick, shape [_TICKS, 3]."""
    out = np.zeros((_TICKS, 3))
    _cycle(_row(kind, numbers), np.zeros(1, SLOPES), 1, out)
    return out * np.array([1.0, _CADENCE, _CADENCE**2])


def position_error(kind: str, numbers: int) -> float:
    """Return the largest difference of a rival's position from the movement [rad]."""
    phase = np.arange(_TICKS) / _TICKS
    return float(np.abs(_evaluated(kind, numbers)[:, 0] - _movement(phase)).max())


def jerk_error(kind: str, numbers: int) -> float:
    """Return the largest jerk that a rival adds to the movement at 1 kHz [rad/s^3].

    The jerk of a tick is the second difference of the velocities that a drive gets, for the rival and for the movement.
    """
    velocity = _evaluated(kind, numbers)[:, 1]
    true = _velocity()
    extra = velocity - true
    return float(np.abs(np.roll(extra, -1) - 2.0 * extra + np.roll(extra, 1)).max()) * 1e6


def _velocity() -> F8:
    """Return the velocity of the movement at every tick [rad/s]."""
    a = 2.0 * np.pi * np.arange(_TICKS) / _TICKS
    slope = -0.9 * np.sin(a) + 0.8 * np.cos(2.0 * a)
    return np.asarray(2.0 * math.pi * _CADENCE * slope * (_movement(a / (2.0 * np.pi)) + 0.35))


def cost_us(kind: str, numbers: int) -> float:
    """Return the cost of one joint in one tick [us]."""
    row, slopes, out = _row(kind, numbers), np.zeros(1, SLOPES), np.zeros((_TICKS, 3))
    return shortest_us(lambda: _cycle(row, slopes, _CALLS, out), _CALLS * _TICKS)


def _rival(kind: str, numbers: int) -> Rival:
    parts = numbers // 2 if kind == "series" else numbers
    settings = {"kind": kind.partition(" ")[0], "values": numbers}
    return Rival(f"{kind}, {numbers}", _SOURCES[kind].format(parts), _RANGES[kind], settings, probed=(kind, numbers))


REFERENCE_RIVALS = tuple(
    _rival(kind, numbers) for kind in _SOURCES for numbers in (_SIZES[:2] if kind == "series" else _SIZES[1:])
)
"""Series, cubic and linear tables of several sizes."""
