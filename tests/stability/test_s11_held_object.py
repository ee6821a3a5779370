"""Friction that has to hold, and friction that slides faster than its tick allows."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mimics_app.lab.stability import s11_held_object as s11
from mimics_app.lab.stability import s11b_lugre_step as s11b


def test_regularised_friction_creeps_at_its_closed_form_and_the_others_hold():
    outcome = s11.EXPERIMENT.run(2)
    assert outcome.passed and outcome.disagreement < 5e-3


@settings(max_examples=20)
@given(share=st.floats(0.02, 0.85))
def test_anchor_holds_any_load_inside_the_cone(share: float):
    way, excess = s11.hold("Hayward-Armstrong", share, 10.0)
    assert abs(way) < 1e-6 and excess <= 1e-12


def test_lugre_holds_still_less_than_the_anchor_and_better_than_regularised():
    assert 1e-4 < s11.hold("LuGre implicit", 0.5)[0] < 0.1 * s11.hold("regularised", 0.5)[0]


@pytest.mark.parametrize("model", ["regularised", "Karnopp", "Hayward-Armstrong"])
def test_friction_never_leaves_its_cone_while_sliding(model: str):
    assert s11.cone_excess(model) <= 1e-12


def test_bristle_damper_leaves_the_cone():
    assert s11.cone_excess("LuGre explicit") > 0.1


def test_fault_friction_that_creeps_in_the_place_of_the_anchor(monkeypatch: pytest.MonkeyPatch):
    hold = s11.hold
    monkeypatch.setattr(
        s11, "hold", lambda model, share: hold("LuGre implicit" if model == "Hayward-Armstrong" else model, share)
    )
    assert not s11.EXPERIMENT.run(2).passed


def test_explicit_lugre_settles_exactly_below_two_g_over_sigma_v():
    outcome = s11b.EXPERIMENT.run(3)
    assert outcome.passed and outcome.disagreement < 0.02


@settings(max_examples=40)
@given(speed=st.floats(0.005, 2.0), margin=st.one_of(st.floats(0.8, 0.98), st.floats(1.02, 1.2)))
def test_explicit_lugre_blows_up_exactly_beyond_its_tick(speed: float, margin: float):
    dt = margin * s11b.exact_limit(speed)
    assert (s11b.deflection(False, speed, dt) < 3.0) == (margin < 1.0)
    assert s11b.deflection(True, speed, dt) == pytest.approx(1.0, abs=1e-9)


def test_fault_explicit_bristles_in_the_place_of_the_implicit_ones(monkeypatch: pytest.MonkeyPatch):
    deflection = s11b.deflection
    monkeypatch.setattr(s11b, "deflection", lambda implicit, speed, dt: deflection(False, speed, dt))
    assert not s11b.EXPERIMENT.run(2).passed
