"""Differences of the reference gait from published tables: the one it is fitted to, and those it is compared with."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.lab.published_gait import HIP, HIP_EVENTS, KNEE, SPEED, TILT
from mimics_app.maths.gait_series import knee_series, leg_length, series_at, step_of, thigh_series
from mimics_app.world.content.motion.reference_gait import NATURAL, SAMPLES, curve_by_events, knee_by_speed
from mimics_app.world.content.motion.reference_gait import TILT as BOVI_TILT

__all__ = ["Difference", "gait_differences", "hip_difference", "knee_of", "speed_of", "thigh_of"]

_HEIGHT = 1.75
_GRAVITY = 9.81
_PHASE = np.arange(SAMPLES) / SAMPLES
_MOST_SHIFT = 0.045
"""Largest difference of the begins of two authors' cycles that is tried [cycles]."""
_SLOWEST = 0.5 / 3.6
_FREE = "free"
_TILT = float(np.mean([TILT[group] for group in SPEED]))
"""Forward tilt of the pelvis of the table that the reference is fitted to [degrees]."""


class Difference(NamedTuple):
    """Root mean square difference of a joint from a table.

    Attributes:
        table: Joint and author.
        kmh: Speed [km/h].
        degrees: The difference [degrees].
    """

    table: str
    kmh: float
    degrees: float


def thigh_of(speed: float, phase: F8 = _PHASE) -> F8:
    """Return the thigh of the reference at a natural step, [degrees], for a speed [m/s] and a height of 1.75 m."""
    step = step_of(speed, _HEIGHT)
    return np.degrees(series_at(np.array([1.0, step, step * step]) @ thigh_series(_HEIGHT), phase))


def knee_of(speed: float, phase: F8 = _PHASE) -> F8:
    """Return the knee of the reference [degrees] at a speed [m/s] and a height of 1.75 m."""
    coefficients, least = knee_series(_HEIGHT)
    u = math.hypot(speed, least)
    return np.degrees(series_at(np.array([1.0, u, u * u]) @ coefficients, phase))


def _rms(difference: F8) -> float:
    """Return the root mean square."""
    return float(np.sqrt((difference**2).mean()))


def _most_aligned(speed: float) -> float:
    """Return the smallest difference of the knee from Koopman's [degrees] over shifts of the cycle."""
    other = knee_by_speed(speed)
    shifts = np.arange(0.0, _MOST_SHIFT + 1e-9, 0.005)
    return min(_rms(knee_of(speed, _PHASE - shift) - other) for shift in shifts)


def hip_difference(speed: float) -> F8:
    """Return hip less that of Koopman [degrees] over a cycle, both against the pelvis, at a speed [m/s]."""
    return thigh_of(speed) + _TILT - curve_by_events(HIP_EVENTS, speed)


def speed_of(group: str) -> float:
    """Return the speed of a group of the table for an adult of 1.75 m [m/s]."""
    return SPEED[group] * math.sqrt(_GRAVITY * leg_length(_HEIGHT))


def gait_differences() -> list[Difference]:
    """Return the differences by author, joint and speed, for a person of 1.75 m at natural steps."""
    rows: list[Difference] = []
    for group in SPEED:
        speed = speed_of(group)
        thigh = np.array(HIP[group]) - np.array(TILT[group])
        rows += [
            _row("thigh, Schwartz 2008", speed, _rms(thigh_of(speed) - thigh)),
            _row("knee, Schwartz 2008", speed, _rms(knee_of(speed) - np.array(KNEE[group]))),
        ]
    for speed in (_SLOWEST, *(speed_of(group) for group in SPEED)):
        hip = hip_difference(speed)
        rows.append(_row("hip, Koopman 2014", speed, _rms(hip)))
        rows.append(_row("hip, Koopman 2014, but for its zero", speed, _rms(hip - hip.mean())))
        rows.append(_row("knee, Koopman 2014", speed, _rms(knee_of(speed) - knee_by_speed(speed))))
        rows.append(_row("knee, Koopman 2014, cycles aligned", speed, _most_aligned(speed)))
    natural = speed_of(_FREE)
    rows.append(_row("thigh, Bovi 2011", natural, _rms(thigh_of(natural) - (np.array(NATURAL["hip"]) - BOVI_TILT))))
    rows.append(_row("knee, Bovi 2011", natural, _rms(knee_of(natural) - np.array(NATURAL["knee"]))))
    return rows


def _row(table: str, speed: float, degrees: float) -> Difference:
    return Difference(table, 3.6 * speed, degrees)
