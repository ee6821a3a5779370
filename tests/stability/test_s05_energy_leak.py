"""Experiment S5: what a tap draws from a sampled spring, and who sees it."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mimics_app.lab.haptic.taps import observed_leak
from mimics_app.lab.stability.s05_energy_leak import EXPERIMENT, closed_leak


def test_small_grid_agrees_with_the_closed_form():
    outcome = EXPERIMENT.run(4)
    assert outcome.passed and outcome.disagreement < 1e-5


def test_a_tap_leaks_593_microjoules():
    """2 kN/m, 1 ms, 0.1 m/s, 3 mm: K T v d = 600 uJ less 7 uJ of the edges."""
    observed, _ = observed_leak(0.1, 3e-3)
    assert observed == pytest.approx(593.3e-6, abs=0.1e-6)


@settings(max_examples=30)
@given(
    speed=st.floats(0.02, 0.5), depth=st.floats(1e-3, 1e-2), stiffness=st.floats(100, 5000), rate=st.floats(500, 4000)
)
def test_leak_of_any_tap_longer_than_a_tick(speed: float, depth: float, stiffness: float, rate: float):
    observed, _ = observed_leak(speed, depth, stiffness, rate)
    assert observed == pytest.approx(closed_leak(speed, depth, stiffness, rate), rel=1e-4)


def test_summing_t_f_v_is_blind():
    """The rival of the observer sees less than a fiftieth of the leak, and may take it for a loss."""
    for speed in (0.05, 0.1, 0.23):
        observed, naive = observed_leak(speed, 3e-3)
        assert abs(naive) < 0.02 * observed


def test_one_tick_of_delay_triples_the_leak():
    """Planted fault: half a tick of hold becomes one and a half: 3 K T v d, which the closed form does not know."""
    observed, _ = observed_leak(0.1, 10e-3, late=1)
    assert observed > 2.5 * closed_leak(0.1, 10e-3)
