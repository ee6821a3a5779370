"""Bodies on bodies: the smallest mass that keeps still, by the pair law (17) against eigenvalues."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mimics_app.lab.haptic.printed_equations import pair_force_printed
from mimics_app.lab.stability import s13_mass_ratio as s13
from mimics_app.lab.stability import s13b_stack as s13b
from mimics_app.lab.stability.stack import UNIT_MASS, keeps_still, smallest_mass, stack_eigenvalue
from mimics_app.rendering.haptic.kernels.contact_law import pair_force

EITHER_SIDE = st.one_of(st.floats(0.7, 0.98), st.floats(1.02, 1.4))


def test_heavy_on_light_keeps_still_down_to_its_eigenvalue():
    outcome = s13.EXPERIMENT.run(4)
    assert outcome.passed and outcome.disagreement < 0.02


def test_stack_keeps_still_down_to_its_closed_form():
    outcome = s13b.EXPERIMENT.run(3)
    assert outcome.passed and outcome.disagreement < 0.02


@settings(max_examples=60)
@given(ratio=st.floats(math.log(0.02), math.log(500.0)).map(math.exp), margin=EITHER_SIDE)
def test_light_body_shakes_exactly_below_its_mass(ratio: float, margin: float):
    relative = np.array([1.0, ratio])
    assert keeps_still(pair_force, margin * UNIT_MASS * stack_eigenvalue(relative) * relative) == (margin > 1.0)


@settings(max_examples=30)
@given(bodies=st.integers(1, 12), margin=EITHER_SIDE)
def test_stack_shakes_exactly_below_its_mass(bodies: int, margin: float):
    masses = margin * UNIT_MASS * s13b.tallest_mode(bodies) * np.ones(bodies)
    assert keeps_still(pair_force, masses) == (margin > 1.0)


@pytest.mark.parametrize("bodies", [1, 2, 5, 9])
def test_closed_form_of_a_stack_is_its_eigenvalue(bodies: int):
    assert s13b.tallest_mode(bodies) == pytest.approx(stack_eigenvalue(np.ones(bodies)), rel=1e-12)


def test_rule_for_two_contacts_is_exact_under_a_heavy_body_and_too_low_under_an_equal_one():
    assert stack_eigenvalue(np.array([1.0, 1e6])) == pytest.approx(2.0, rel=1e-5)
    assert stack_eigenvalue(np.array([1.0, 1.0])) == pytest.approx((3.0 + math.sqrt(5.0)) / 2.0)


def test_fault_sign_of_17(monkeypatch: pytest.MonkeyPatch):
    assert smallest_mass(pair_force_printed, np.ones(2)) == float("inf")
    monkeypatch.setattr(s13, "pair_force", pair_force_printed)
    monkeypatch.setattr(s13b, "pair_force", pair_force_printed)
    assert not s13.EXPERIMENT.run(2).passed
    assert not s13b.EXPERIMENT.run(2).passed
