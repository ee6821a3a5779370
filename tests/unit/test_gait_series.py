"""Reference gait: hip and knee from height, speed and cadence, against the tables of three authors."""

from __future__ import annotations

import math

import numpy as np
import pytest

from mimics_app.lab.haptic.gait_differences import gait_differences, hip_difference
from mimics_app.lab.published_gait import CADENCE, HIP, KNEE, SPEED, STEP
from mimics_app.lab.published_gait import TILT as PELVIS
from mimics_app.maths.gait_series import (
    LEAST_SPEED,
    MOST_SPEED,
    knee_series,
    leg_length,
    natural_cadence,
    series_at,
    step_of,
    thigh_series,
)
from mimics_app.world.content.motion.reference_gait import NATURAL, SAMPLES, TILT, knee_by_speed

HEIGHT, GRAVITY = 1.75, 9.81
PHASE = np.arange(SAMPLES) / SAMPLES
UNIT = math.sqrt(GRAVITY * 0.53 * HEIGHT)
"""Speed that is 1 without dimension [m/s]."""


def _thigh(step: float, height: float = HEIGHT, phase: np.ndarray = PHASE) -> np.ndarray:
    return np.degrees(series_at(np.array([1.0, step, step * step]) @ thigh_series(height), phase))


def _knee(speed: float, height: float = HEIGHT, phase: np.ndarray = PHASE) -> np.ndarray:
    coefficients, least = knee_series(height)
    u = math.hypot(speed, least)
    return np.degrees(series_at(np.array([1.0, u, u * u]) @ coefficients, phase))


def _rms(difference: np.ndarray) -> float:
    return float(np.sqrt((difference**2).mean()))


@pytest.mark.parametrize("group", SPEED)
def test_joints_are_those_of_the_table_they_were_fitted_to(group: str) -> None:
    """The goal is 3 degrees, at three speeds; an adult's speeds and steps follow from the table without dimension."""
    speed = SPEED[group] * UNIT
    hip = np.array(HIP[group]) - np.array(PELVIS[group])
    assert _rms(_thigh(step_of(speed, HEIGHT)) - hip) < 1.0
    assert _rms(_knee(speed) - np.array(KNEE[group])) < 0.3


@pytest.mark.parametrize("group", SPEED)
@pytest.mark.parametrize("height", [1.5, 1.95])
def test_step_and_cadence_are_those_of_the_table_at_any_height(group: str, height: float) -> None:
    length = leg_length(height)
    speed = SPEED[group] * math.sqrt(GRAVITY * length)
    assert step_of(speed, height) == pytest.approx(STEP[group] * length, rel=0.01)
    steps = CADENCE[group] * math.sqrt(GRAVITY / length)
    assert natural_cadence(speed, height) == pytest.approx(0.5 * steps, rel=0.015)


@pytest.mark.parametrize(("kmh", "raw", "aligned"), [(0.5, 2.5, 2.5), (1.9, 6.0, 4.0), (3.2, 6.0, 3.0)])
def test_the_knee_as_another_author_has_it(kmh: float, raw: float, aligned: float) -> None:
    """Koopman 2014, adults of 47 to 68 years on a treadmill. The goal, 6 degrees at three speeds, is met as it stands.

    What is left is mostly timing: the two tables themselves differ by 5.3 and 5.9 degrees at 1.9 and 3.2 km/h, and by
    less than 4 with the second moved by 3 % of the cycle.
    """
    other = knee_by_speed(kmh / 3.6)
    assert _rms(_knee(kmh / 3.6) - other) < raw
    shifts = np.arange(0.0, 0.0451, 0.005)
    best = min(_rms(_knee(kmh / 3.6, phase=PHASE - shift) - other) for shift in shifts)
    assert best < aligned


@pytest.mark.parametrize(("kmh", "raw", "shape"), [(0.5, 7.0, 4.0), (1.9, 6.0, 2.5), (3.2, 6.0, 2.0), (4.7, 6.0, 3.5)])
def test_the_hip_as_another_author_has_it(kmh: float, raw: float, shape: float) -> None:
    """Koopman 2014, against the pelvis: 6 degrees at three speeds, most of which is the zero of the angle.

    At 0.5 km/h the reference is extrapolated.
    """
    difference = hip_difference(kmh / 3.6)
    assert _rms(difference) < raw and _rms(difference - difference.mean()) < shape


def test_hip_and_knee_at_natural_speed_as_a_third_author_has_them() -> None:
    """Bovi 2011, adults."""
    speed = SPEED["free"] * UNIT
    assert _rms(_thigh(step_of(speed, HEIGHT)) - (np.array(NATURAL["hip"]) - TILT)) < 3.0
    assert _rms(_knee(speed) - np.array(NATURAL["knee"])) < 3.0


@pytest.mark.parametrize("height", [1.2, 1.75, 2.1])
def test_the_whole_range_of_speeds_stays_within_a_leg(height: float) -> None:
    """The knee is never overextended, hip and knee stay within what a gait orthosis moves."""
    phase, last = np.linspace(0.0, 1.0, 200, endpoint=False), 0.0
    for speed in np.linspace(LEAST_SPEED, MOST_SPEED, 12):
        thigh, knee = _thigh(step_of(speed, height), height, phase), _knee(speed, height, phase)
        assert 1.0 < knee.min() and 35.0 < knee.max() < 65.0
        assert -20.0 < thigh.min() and thigh.max() < 40.0
        swing = thigh.max() - thigh.min()
        assert swing > last
        last = swing


def test_shorter_steps_at_a_higher_cadence_swing_the_thigh_less() -> None:
    usual = _thigh(step_of(0.8, HEIGHT))
    shorter = _thigh(0.8 * step_of(0.8, HEIGHT))
    share = (shorter.max() - shorter.min()) / (usual.max() - usual.min())
    assert 0.75 < share < 0.95
    assert float(np.ptp(_thigh(0.0))) == 0.0


def test_the_bench_and_the_figure_tell_both_what_agrees_and_what_does_not() -> None:
    """The goals are 3 degrees of the table that was fitted, 6 of another one: what misses them is in the list, too."""
    found = {(each.table, round(each.kmh, 1)): each.degrees for each in gait_differences()}
    fitted = [degrees for (table, _), degrees in found.items() if "Schwartz" in table]
    assert len(fitted) == 6 and max(fitted) < 1.0
    slow = _rms(_knee(1.9 / 3.6) - knee_by_speed(1.9 / 3.6))
    assert found["knee, Koopman 2014", 1.9] == pytest.approx(slow, abs=0.1) and 3.0 < slow < 6.0
    assert found["thigh, Bovi 2011", 4.7] < 3.0
