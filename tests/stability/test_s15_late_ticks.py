"""Late and dropped ticks make a wall give energy away: how much damping they cost, and what the policy saves."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from mimics_app.lab.stability import replayed_wall as wall
from mimics_app.lab.stability import s15_late_ticks as s15
from mimics_app.lab.stability import s15b_dropped_ticks as s15b
from mimics_app.lab.stability.s15_late_ticks import measure_lateness
from mimics_app.rendering.haptic.kernels.safety import HOLD, IN_TIME, LATE_DAMP

SHORT = wall.Stroke(count=3)


def test_late_ticks_cost_the_damping_that_the_held_forces_give():
    outcome = s15.EXPERIMENT.run(3)
    assert outcome.passed and outcome.disagreement < 0.02
    assert all(row["source"] == "every 50th tick" for row in outcome.rows)


def test_dropped_ticks_cost_the_damping_that_the_held_forces_give():
    outcome = s15b.EXPERIMENT.run(2)
    assert outcome.passed and outcome.disagreement < 0.02


@settings(max_examples=25)
@given(
    late_ms=st.lists(st.floats(0.0, 9.5), min_size=5, max_size=60),
    damping=st.floats(0.0, 20.0),
    policy=st.booleans(),
)
def test_energy_of_any_lateness_is_the_sum_of_held_forces(late_ms: list[float], damping: float, policy: bool):
    wakes = wall.wakes_with(1e-3 * np.array(late_ms), SHORT.seconds)
    assume(not np.any(wall.classes_of(wakes, policy) >= LATE_DAMP))  # twenty missed in a row: latched
    energy, calm = wall.energy_and_calm(wakes, damping, policy, SHORT)
    assume(calm == 1.0)  # else the detector of oscillation softened the wall
    assert energy == pytest.approx(wall.exact_energy(wakes, damping, policy, SHORT), abs=1e-9)


@settings(max_examples=15)
@given(share=st.floats(0.0, 0.6), margin=st.one_of(st.floats(0.7, 0.98), st.floats(1.02, 1.4)))
def test_wall_gives_energy_away_exactly_below_the_needed_damping(share: float, margin: float):
    wakes = s15b.dropping(share)
    needed = wall.exact_needed(wakes, False)
    assert (wall.energy_of(wakes, margin * needed, False) > 0.0) == (margin > 1.0)


@pytest.mark.parametrize("share", [0.1, 0.3, 0.5])
def test_mean_of_many_dropped_ticks_is_the_expected_one(share: float):
    needed = np.mean([wall.exact_needed(s15b.dropping(share, seed), False) for seed in range(8)])
    # Four standard errors: a run holds some 1500 holds in the wall, whose weighted mean scatters by 5 %.
    assert needed == pytest.approx(s15b.expected_needed(share), rel=4 * 0.05 / np.sqrt(8))


def test_policy_classes_follow_the_lateness():
    pattern = np.zeros(400)
    pattern[100], pattern[200] = 5e-3, 15e-3
    wakes = wall.wakes_with(pattern, SHORT.seconds)
    classes = wall.classes_of(wakes, True)
    assert classes[1300] == HOLD and classes[1400] == LATE_DAMP and classes[1250] == IN_TIME
    # Behind a tick 5 ms late three more come later than 2 ms, back to back: 4.01, 3.02, 2.03 ms.
    assert np.count_nonzero(classes[1300:1310] == HOLD) == 4
    assert np.all(wall.classes_of(wakes, False) == IN_TIME)


def test_policy_leaves_no_wall_to_give_energy_away_beyond_its_second_limit():
    wakes = s15.stalls(12e-3)
    assert wall.energy_of(wakes, 2.0, False) < -0.05
    assert wall.energy_of(wakes, 2.0, True) >= 0.0


def test_mean_period_does_not_see_late_ticks_and_the_weighted_one_does():
    wakes = s15.stalls(9e-3)
    assert np.mean(np.diff(wakes.t)) == pytest.approx(1e-3, rel=1e-2)
    needed = wall.exact_needed(wakes, False)
    assert needed > 2.5 * 0.5 * wall.STIFFNESS * wall.PERIOD
    assert needed == pytest.approx(0.5 * wall.STIFFNESS * wall.weighted_period(wakes), rel=0.05)


def test_live_lateness_can_be_replayed():
    lateness = measure_lateness(0.4)
    assert len(lateness) > 100 and np.all(lateness >= 0.0)
    wakes = wall.wakes_with(lateness, SHORT.seconds)
    exact = wall.exact_energy(wakes, 2.0, False, SHORT)
    assert wall.energy_of(wakes, 2.0, False, SHORT) == pytest.approx(exact, abs=1e-9)


def test_fault_policy_that_does_nothing(monkeypatch: pytest.MonkeyPatch):
    energy = s15.energy_of
    monkeypatch.setattr(s15, "energy_of", lambda wakes, damping, policy: energy(wakes, damping, False))
    assert not s15.EXPERIMENT.run(2).passed
