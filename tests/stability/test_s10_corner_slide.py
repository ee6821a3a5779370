"""Sliding round a cube's corner (Figure 27): the nearest face jumps, the held face does not."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mimics_app.compiled.kernel import kernel
from mimics_app.lab.haptic.printed_equations import cube_printed
from mimics_app.lab.stability import s10_corner_slide as s10


@kernel
def farthest(p, v, dimensions, contact):
    """(14) with min where max belongs: the farthest face."""
    cube_printed(p, dimensions, contact)


def test_nearest_face_jumps_by_root_two_k_d_and_the_held_face_by_nothing():
    outcome = s10.EXPERIMENT.run(3)
    assert outcome.passed and outcome.disagreement < 0.01
    at_three = next(row for row in outcome.rows if row["depth_mm"] == 3.0)
    assert at_three["nearest_jump_N"] == pytest.approx(8.485, abs=0.01)
    assert at_three["held_jump_N"] == 0.0


@settings(max_examples=40)
@given(depth=st.floats(0.5e-3, 20e-3))
def test_held_face_never_turns_its_force_at_any_depth(depth: float):
    jump, drop, wrong = s10.slide(s10.cube, depth)
    assert jump < 1e-9 and wrong == 0
    assert drop == pytest.approx(2000.0 * depth, rel=1e-9)


@settings(max_examples=20)
@given(depth=st.floats(1e-3, 10e-3))
def test_nearest_face_pushes_out_of_the_side_for_the_last_d(depth: float):
    jump, _, wrong = s10.slide(s10.nearest, depth)
    # A tick slides 10 um: the change is seen that much late, and the count is off by one at most.
    assert jump == pytest.approx(np.sqrt(2.0) * 2000.0 * depth, rel=0.011)
    assert abs(wrong - depth / 10e-6) <= 1.0


@pytest.mark.parametrize("fault", [s10.nearest, farthest])
def test_fault_another_face_in_the_place_of_the_held_one(fault, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(s10, "cube", fault)
    assert not s10.EXPERIMENT.run(2).passed


def test_fault_min_and_max_of_equation_14_exchanged(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(s10, "nearest", farthest)
    assert not s10.EXPERIMENT.run(2).passed
