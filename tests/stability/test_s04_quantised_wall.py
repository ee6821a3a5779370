"""Experiment S4: a coarse encoder limits the wall by 2 f_c / Delta, a fine one by 2 b / T."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mimics_app.lab.stability.s04_quantised_wall import (
    EXPERIMENT,
    Device,
    closed_limit,
    largest_swing,
    simulated_limit,
)


def test_small_grid_agrees_with_the_closed_form():
    outcome = EXPERIMENT.run(3)
    assert outcome.passed and outcome.disagreement < 0.005


@settings(max_examples=15)
@given(quantum=st.floats(2e-6, 5e-4), friction=st.floats(0.01, 0.3), damping=st.floats(0.2, 3.0))
def test_stiffest_passive_wall_of_any_device(quantum: float, friction: float, damping: float):
    device = Device(quantum, friction, damping)
    assert simulated_limit(device) == pytest.approx(closed_limit(device), rel=0.02)


def test_device_without_friction_has_no_passive_wall():
    """f_c = 0: the shorter the way across a step, the less damping takes; at 1e-5 steps 0.02 N/m are left."""
    assert simulated_limit(Device(1e-5, 0.0)) < 0.03


def test_mass_swings_for_ever_on_a_quantised_wall_far_beyond_the_limit():
    device = Device(5e-5, 0.05)
    limit = closed_limit(device)
    assert largest_swing(device, 0.95 * limit) < 1e-6 * device.quantum
    assert largest_swing(device, 20.0 * limit) > device.quantum
