"""Experiments S3 and S3R: the stiffest wall, by delay, damping, mass and rate."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mimics_app.lab.stability import s03r_wall_rate
from mimics_app.lab.stability.s03_stiffest_wall import EXPERIMENT, compare
from mimics_app.lab.stability.wall_loop import Wall, exact_limit, is_stable, rule_limit, simulated_limit


def test_small_grid_agrees_with_the_eigenvalues():
    outcome = EXPERIMENT.run(2)
    assert outcome.passed and outcome.disagreement < 0.005


def test_rule_is_27_percent_too_high_for_a_light_device():
    row = compare("the rule's worst", Wall(mass=0.1, wall_damping=20.0, delay=2))
    assert row["exact_below_rule"] == pytest.approx(0.268, abs=0.002)
    assert row["difference"] < 0.005


def test_too_damped_a_wall_has_no_stable_stiffness():
    """60 N s/m two ticks late on 0.1 kg: the damper shakes on its own, where the rule promises 26 kN/m."""
    wall = Wall(mass=0.1, wall_damping=60.0, delay=2)
    assert rule_limit(wall) > 2e4
    assert not any(is_stable(wall, stiffness) for stiffness in (10.0, 1e3, 1e4))


@settings(max_examples=25)
@given(
    b=st.floats(2.0, 20.0),
    B=st.floats(0.0, 20.0),
    mass=st.floats(0.5, 5.0),
    delay=st.integers(0, 4),
    margin=st.floats(0.9, 1.1),
)
def test_wall_is_stable_exactly_below_its_eigenvalue_limit(b: float, B: float, mass: float, delay: int, margin: float):
    """Any wall near its limit, dead band 2 %."""
    wall = Wall(mass=mass, device_damping=b, wall_damping=B, delay=delay)
    if abs(margin - 1.0) < 0.02:
        margin = 0.98
    assert is_stable(wall, margin * exact_limit(wall)) == (margin < 1.0)


@pytest.mark.parametrize(("rate", "limit"), [(60.0, 603.0), (1000.0, 10003.0), (4000.0, 40003.0)])
def test_stiffest_wall_grows_with_the_rate(rate: float, limit: float):
    """A device of 3 kg and 5 N s/m; 603 N/m is all that a wall in a 60 Hz picture loop can have."""
    assert exact_limit(Wall(rate=rate)) == pytest.approx(limit, rel=2e-3)
    assert simulated_limit(Wall(rate=rate)) == pytest.approx(limit, rel=0.01)


def test_nothing_happens_at_500_hz():
    """Limits per hertz at 400, 500 and 625 Hz are one number: D2.1 4.3.1 states no limit of its own."""
    outcome = s03r_wall_rate.EXPERIMENT.run(2)
    assert outcome.passed
    per_hertz = [exact_limit(Wall(rate=rate)) / rate for rate in (400.0, 500.0, 625.0)]
    assert max(per_hertz) == pytest.approx(min(per_hertz), rel=3e-3)


@pytest.mark.parametrize("delay", [0, 2])
def test_one_tick_of_delay_more_than_thought_is_seen(delay: int):
    """Planted fault: a loop one tick later than its matrix loses 28 % of the wall and more."""
    wall = Wall(delay=delay)
    assert simulated_limit(wall, extra_delay=1) < 0.75 * exact_limit(wall)
