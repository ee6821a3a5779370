"""Equations (5), (9), (12), (13), (17) as printed run away at closed-form rates; their corrected forms die away."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from mimics_app.lab.haptic.printed_equations import joint_pd_printed, pair_force_printed, rotate_printed
from mimics_app.lab.stability import s08_printed_equations as s08
from mimics_app.lab.stability.laws import identified_rate
from mimics_app.rendering.haptic.kernels.contact_law import pair_force, spring_damper


def test_printed_equations_run_away_at_their_closed_form_rates():
    outcome = s08.EXPERIMENT.run(2)
    assert outcome.passed and outcome.disagreement < 1e-4
    assert {row["equation"] for row in outcome.rows} == {5, 9, 12, 13, 17}
    assert all(row["printed_1_s"] > 0.1 for row in outcome.rows)


def test_rate_of_equation_5_is_the_stated_one():
    assert s08.pd_rate(joint_pd_printed, 20.0) == pytest.approx(20.0 / 1.3, rel=0.01)


@settings(max_examples=30)
@example(b=4.0, m1=0.109375, m2=0.1015625)
@given(b=st.floats(0.5, 60.0), m1=st.floats(0.1, 5.0), m2=st.floats(0.1, 5.0))
def test_damper_of_17_feeds_what_its_corrected_form_takes(b: float, m1: float, m2: float):
    reduced = m1 * m2 / (m1 + m2)
    # Where the pair oscillates the multipliers' product is 1 +- h b/m exactly; beyond only the sign is known, as where
    # the pair grows a million times in the 0.4 s of the motion: it lifts off, which no linear rate tells.
    grown, stays = np.log1p(1e-3 * b / reduced) / 2e-3, np.log(1e6) / 0.4
    if 1e-3 * b / reduced < 0.5 * np.sqrt(1e-6 * 2000.0 / reduced) and grown < stays:
        died = np.log1p(-1e-3 * b / reduced) / 2e-3
        assert s08.pressed_rate(pair_force_printed, b, m1, m2) == pytest.approx(grown, rel=1e-4, abs=1e-4)
        assert s08.pressed_rate(pair_force, b, m1, m2) == pytest.approx(died, rel=1e-4, abs=1e-4)
    else:
        assert s08.pressed_rate(pair_force_printed, b, m1, m2) > 0.0


@settings(max_examples=30)
@given(rate=st.floats(-50.0, 50.0), turn=st.floats(1.0, 500.0))
def test_identified_rate_is_that_of_a_made_motion(rate: float, turn: float):
    t = 1e-3 * np.arange(200)
    assert identified_rate(np.exp(rate * t) * np.cos(turn * t), 1e-3) == pytest.approx(rate, abs=1e-3)


def test_fault_sign_of_5(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(s08, "joint_pd", joint_pd_printed)
    assert not s08.EXPERIMENT.run(2).passed


def test_fault_sign_of_9(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(s08, "spring_damper", s08.object_law_printed)
    assert not s08.EXPERIMENT.run(2).passed


def test_fault_last_factor_of_12(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(s08, "rotate_exponential", rotate_printed)
    assert not s08.EXPERIMENT.run(2).passed


def test_fault_sign_of_17(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(s08, "pair_force", pair_force_printed)
    assert not s08.EXPERIMENT.run(2).passed


def test_fault_corrected_laws_in_the_place_of_the_printed_ones(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(s08, "object_law_printed", spring_damper)
    monkeypatch.setattr(s08, "pair_force_printed", pair_force)
    assert not s08.EXPERIMENT.run(2).passed
