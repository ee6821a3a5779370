"""Experiment S1: integrators break where their amplification matrix says, in the loop's own step functions."""

from __future__ import annotations

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mimics_app.lab.stability.s01_integrators import (
    EXPERIMENT,
    METHODS,
    exact_growth,
    simulated_growth,
    simulated_limit,
)


def test_small_grid_agrees_with_the_eigenvalues():
    outcome = EXPERIMENT.run(6)
    assert outcome.passed and outcome.disagreement < 2e-3
    assert {row["method"] for row in outcome.rows} == set(METHODS)


@settings(max_examples=40)
@given(zeta=st.floats(0.05, 0.9), margin=st.floats(0.9, 1.1))
@pytest.mark.parametrize("method", ["explicit", "semi-implicit"])
def test_euler_breaks_exactly_at_its_largest_step(method: str, zeta: float, margin: float):
    """Explicit: h < c / k, i.e. h w < 2 zeta; semi-implicit: (h w)^2 + 4 zeta h w < 4. Dead band 0.1 %."""
    limit = 2.0 * zeta if method == "explicit" else 2.0 * (math.sqrt(zeta**2 + 1.0) - zeta)
    if abs(margin - 1.0) < 1e-3:
        margin = 1.001
    assert (simulated_growth(method, zeta, margin * limit, 4000) < 0.0) == (margin < 1.0)


def test_closed_forms_without_damping():
    """|lambda| of the six at h w = 0.1: what the module of the integrators promises."""
    assert math.exp(2 * simulated_growth("explicit", 0.0, 0.1)) == pytest.approx(1.01, rel=1e-9)
    assert math.exp(-2 * simulated_growth("implicit", 0.0, 0.1)) == pytest.approx(1.01, rel=1e-9)
    assert simulated_growth("rk4", 0.0, 0.1) == pytest.approx(-(0.1**6) / 144.0, rel=0.01)
    for method in ("semi-implicit", "midpoint", "exact"):
        assert abs(simulated_growth(method, 0.0, 0.1)) < 1e-12


def test_runge_kutta_breaks_at_the_square_root_of_eight():
    assert simulated_limit("rk4", 0.0) == pytest.approx(math.sqrt(8.0), rel=2e-3)


def test_explicit_euler_taken_for_semi_implicit_is_seen():
    """Planted fault: the old velocity moves the position. The growth differs by (h w)^2 / 2 a step."""
    assert simulated_growth("explicit", 0.0, 0.5) > 0.1 > abs(exact_growth("semi-implicit", 0.0, 0.5)) + 0.09
