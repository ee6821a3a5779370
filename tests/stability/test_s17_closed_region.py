"""Experiment S17: the closed region of stable contacts, simulated, exact and as the loop knows it."""

from __future__ import annotations

from dataclasses import replace

import pytest

from mimics_app.lab.stability.region_loop import Loop, exact_limit, simulated_limit
from mimics_app.lab.stability.s17_closed_region import EXPERIMENT, compare, damping_at_end

LIGHT = Loop(0.2, 1.5, filtering=1e-3)


def test_small_grid_agrees_with_the_eigenvalues():
    outcome = EXPERIMENT.run(1)
    assert outcome.passed and outcome.disagreement < 0.005


@pytest.mark.parametrize(("delay", "most"), [(0, 2.0), (1, 0.828), (2, 0.536), (3, 0.398)])
def test_region_without_filter_and_friction_ends_where_it_is_known_to(delay: int, most: float):
    """B T / m at K = 0 in closed form: 2 sin(theta/2) sin((n + 1/2) theta) / cos^2(theta/2), (n + 1) theta = pi/2."""
    plain = Loop(1.0, 1e-6, delay=delay)
    assert damping_at_end(plain) / 1000.0 == pytest.approx(most, abs=5e-4)


def test_more_damping_than_at_the_peak_lowers_the_stiffness():
    rows = [compare(LIGHT, share) for share in (0.1, 0.45, 0.8, 0.95)]
    limits = [row["exact_n_m"] for row in rows]
    assert limits[0] < limits[1] > limits[2] > limits[3]
    assert all(0.7 * row["exact_n_m"] < row["live_n_m"] < 1.002 * row["exact_n_m"] for row in rows)


def test_one_tick_of_delay_more_than_thought_is_seen():
    """Planted fault: a loop one tick later than its matrix loses a third of the wall and more."""
    damping = 0.3 * damping_at_end(LIGHT)
    late = simulated_limit(replace(LIGHT, delay=2), damping, 10.0, 1e6)
    assert late < 0.67 * exact_limit(LIGHT, damping, 10.0, 1e6)
