"""Equations (6) and (7) without their coupling terms: a free mass turns a corner and gains energy."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mimics_app.contracts.loop.haptic import AdmittanceForm
from mimics_app.lab.stability import s09_admittance_forms as s09


def test_printed_form_leaves_its_line_as_the_closed_form_says():
    outcome = s09.EXPERIMENT.run(3)
    assert outcome.passed and outcome.disagreement < 1e-9


def test_printed_form_gains_the_stated_energy_and_way():
    """Energy [J] and distance off the line [m] at 1 rad/s after 0.5 s."""
    assert s09.fly(AdmittanceForm.SEED, 1.0)[:2] == pytest.approx((0.153, 0.0786), rel=1e-3)


@settings(max_examples=25)
@given(turn=st.floats(0.05, 3.0))
def test_printed_form_feeds_energy_at_any_speed_and_the_cartesian_form_none(turn: float):
    exact = s09.exact_flight(turn)[0]
    assert s09.fly(AdmittanceForm.SEED, turn)[0] == pytest.approx(exact, rel=1e-9)
    assert abs(s09.fly(AdmittanceForm.CARTESIAN, turn)[0]) < 1e-12


def test_false_force_grows_to_its_closed_form_with_the_tick():
    exact = s09.exact_flight(1.0)[2]
    errors = [abs(s09.fly(AdmittanceForm.SEED, 1.0, dt)[2] - exact) for dt in (1e-3, 0.5e-3)]
    assert errors[0] < 1e-2 * exact
    assert errors[1] == pytest.approx(0.5 * errors[0], rel=0.1)  # first order: the force is that of half a tick before


@pytest.mark.parametrize("form", [AdmittanceForm.CARTESIAN, AdmittanceForm.POLAR])
def test_corrected_forms_land_on_the_line_to_first_order(form: AdmittanceForm):
    coarse, fine = s09.fly(form, 1.0, 1e-3)[1], s09.fly(form, 1.0, 0.5e-3)[1]
    assert coarse < 1e-3 and fine == pytest.approx(0.5 * coarse, rel=0.05)


def test_fault_printed_form_in_the_place_of_the_corrected_one(monkeypatch: pytest.MonkeyPatch):
    fly = s09.fly
    monkeypatch.setattr(s09, "fly", lambda form, turn: fly(AdmittanceForm.SEED, turn))
    assert not s09.EXPERIMENT.run(2).passed


def test_fault_corrected_form_in_the_place_of_the_printed_one(monkeypatch: pytest.MonkeyPatch):
    fly = s09.fly
    monkeypatch.setattr(s09, "fly", lambda form, turn: fly(AdmittanceForm.CARTESIAN, turn))
    outcome = s09.EXPERIMENT.run(2)
    assert not outcome.passed and np.isfinite(outcome.disagreement)
