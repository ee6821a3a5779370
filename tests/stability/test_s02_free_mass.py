"""Experiment S2: an undamped sampled wall feeds a free mass at every rate."""

from __future__ import annotations

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mimics_app.lab.stability.s02_free_mass import EXPERIMENT, exact_growth_rate, simulated_growth_rate


def test_small_grid_agrees_with_the_closed_form():
    outcome = EXPERIMENT.run(4)
    assert outcome.passed and outcome.disagreement < 1e-6


@settings(max_examples=30)
@given(stiffness=st.floats(50.0, 1e4), rate=st.floats(60.0, 4000.0), mass=st.floats(0.1, 10.0))
def test_growth_of_any_free_mass(stiffness: float, rate: float, mass: float):
    """sqrt(1 + a / 2), a = K T^2 / m, as long as the motion turns at all (a < 16)."""
    if stiffness / (mass * rate**2) > 10.0:
        rate = math.sqrt(stiffness / mass)
    assert simulated_growth_rate(stiffness, rate, mass=mass) == pytest.approx(
        exact_growth_rate(stiffness, rate, mass), rel=1e-4
    )


def test_no_rate_is_fast_enough_without_damping():
    assert all(simulated_growth_rate(2000.0, rate) > 0.0 for rate in (60.0, 499.0, 501.0, 4000.0))


def test_damping_of_the_wall_of_half_a_tick_of_stiffness_stops_the_growth():
    """b > K T / 2 (here 1 N s/m; the wall's own damper acts a little late): growth on one side, decay on the other."""
    assert simulated_growth_rate(2000.0, 1000.0, damping=0.9) > 0.0 > simulated_growth_rate(2000.0, 1000.0, damping=1.1)
