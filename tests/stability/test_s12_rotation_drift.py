"""Orientation from angular velocity: products of axis rotations drift, a free top must turn over in time."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mimics_app.lab.haptic.printed_equations import rotate_printed
from mimics_app.lab.haptic.rotation_updates import rotate_axes, rotate_exponential, rotate_start
from mimics_app.lab.stability import s12_rotation_drift as s12
from mimics_app.lab.stability import s12b_free_top as s12b

COMPONENT = st.floats(-8.0, 8.0)


def test_axis_product_drifts_as_the_power_of_its_step():
    outcome = s12.EXPERIMENT.run(2)
    assert outcome.passed and outcome.disagreement < 1e-6
    at_seed = next(row for row in outcome.rows if row["speed_rad_s"] == float(np.sqrt(50.0)))
    assert at_seed["axis_product_deg"] == pytest.approx(2.43, abs=0.01)


@settings(max_examples=30)
@given(x=COMPONENT, y=COMPONENT, z=COMPONENT)
def test_drift_is_exact_about_any_axis(x: float, y: float, z: float):
    omega = np.array([x, y, z])
    assert s12.drift(rotate_axes, omega, seconds=1.0) == pytest.approx(
        s12.exact_drift(omega, "xyz", seconds=1.0), abs=1e-7
    )
    assert s12.drift(rotate_printed, omega, seconds=1.0) == pytest.approx(
        s12.exact_drift(omega, "xyy", seconds=1.0), abs=1e-7
    )
    assert s12.drift(rotate_exponential, omega, seconds=1.0) < 1e-8


def test_drift_halves_with_the_tick():
    omega = 7.0 * s12.DIRECTION
    assert s12.drift(rotate_axes, omega, 0.5e-3) == pytest.approx(0.5 * s12.drift(rotate_axes, omega, 1e-3), rel=1e-3)


def test_fault_last_factor_of_12_about_y(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(s12, "rotate_axes", rotate_printed)
    assert not s12.EXPERIMENT.run(2).passed


def test_fault_axis_product_in_the_place_of_the_exponential_map(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(s12, "rotate_exponential", rotate_axes)
    assert not s12.EXPERIMENT.run(2).passed


def test_free_top_turns_over_when_jacobi_says():
    outcome = s12b.EXPERIMENT.run(2)
    assert outcome.passed and outcome.disagreement < 0.01
    flips = {row["method"]: row["flips"] for row in outcome.rows if row["tick_ms"] == 1.0}
    assert flips["half step"] == 3 and flips["(12) as printed"] == 0


def test_flip_interval_agrees_with_a_fine_simulation():
    # 20 us and second order: 2500 times nearer than the 1.7e-4 seen at 1 ms.
    assert s12b.tumble(rotate_exponential, 2e-5)[1] == pytest.approx(s12b.exact_interval(), rel=1e-6)


def test_energy_error_of_the_half_step_is_of_second_order():
    coarse, fine = s12b.tumble(rotate_exponential, 1e-3)[2], s12b.tumble(rotate_exponential, 0.5e-3)[2]
    assert coarse < 1e-5 and fine == pytest.approx(0.25 * coarse, rel=0.05)


@pytest.mark.parametrize("fault", [rotate_start, rotate_axes, rotate_printed])
def test_fault_another_rotation_in_the_place_of_the_half_step(fault, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(s12b, "rotate_exponential", fault)
    assert not s12b.EXPERIMENT.run(2).passed
