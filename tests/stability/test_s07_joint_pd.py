"""Experiment S7: gains of equation (5) beyond the stable region, its printed sign, and a servo that lags."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mimics_app.lab.stability.s07_joint_pd import EXPERIMENT, closed_limit, exact_limit, is_stable, simulated_limit


def test_small_grid_agrees_with_the_eigenvalues():
    outcome = EXPERIMENT.run(5)
    assert outcome.passed and outcome.disagreement < 0.005


@settings(max_examples=60)
@given(kp_t=st.floats(0.01, 4.0), kd=st.floats(-1.4, 1.4))
def test_gains_are_stable_exactly_inside_the_region(kp_t: float, kd: float):
    """Kd > -1 and Kp T + 2 Kd < 2, dead band 0.02 in both."""
    if abs(kp_t + 2.0 * kd - 2.0) < 0.02 or abs(kd + 1.0) < 0.02:
        return
    assert is_stable(1000.0 * kp_t, kd) == (kd > -1.0 and kp_t + 2.0 * kd < 2.0)


@settings(max_examples=20)
@given(kp=st.floats(0.1, 1500.0), kd=st.floats(-0.9, 0.9))
def test_printed_sign_of_equation_5_is_stable_nowhere(kp: float, kd: float):
    """Planted fault: positive feedback."""
    assert not is_stable(kp, kd, printed=True)


@pytest.mark.parametrize("kd", [-0.4, 0.0, 0.4])
def test_one_tick_of_servo_delay_more_is_seen(kd: float):
    """Planted fault: the loop one tick later has another region than the inequality says."""
    late = simulated_limit(kd, delay=1)
    assert late < 0.95 * closed_limit(kd)
    assert late == pytest.approx(exact_limit(kd, delay=1), rel=0.01)
