"""Experiment S6B: a stiff arm needs damping, the more the heavier the virtual mass."""

from __future__ import annotations

import pytest

from mimics_app.lab.experiment import Outcome
from mimics_app.lab.stability.s06b_virtual_damping import EXPERIMENT


@pytest.fixture(scope="module")
def outcome() -> Outcome:
    return EXPERIMENT.run(2)


def test_small_grid_agrees_with_the_eigenvalues(outcome: Outcome):
    assert outcome.passed and outcome.disagreement < 0.005


def test_heavier_mass_needs_more_damping_and_the_closed_limit_is_enough_for_all(outcome: Outcome):
    rows = [row for row in outcome.rows if row["delay_ticks"] == 20]
    needed = [row["exact_ns_m"] for row in sorted(rows, key=lambda row: row["virtual_mass_kg"])]
    assert needed == sorted(needed)
    assert 0.95 * rows[0]["rule_ns_m"] < needed[-1] < rows[0]["rule_ns_m"]
