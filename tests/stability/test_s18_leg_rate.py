"""Experiment S18: a foot on a wall in the gait orthosis against the rate of its control, simulated and exact."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from mimics_app.lab.haptic.leg_runs import foot_on_wall
from mimics_app.lab.haptic.lokomat_rig import COMBINED, CONTROLS, IMPEDANCE
from mimics_app.lab.stability.leg_loop import LegBench
from mimics_app.lab.stability.leg_model import impedance_loop, is_stable_but_for_a_neutral_way, rest_in_combined
from mimics_app.lab.stability.s18_leg_rate import EXPERIMENT, holds_default


@pytest.mark.parametrize("kind", [IMPEDANCE, COMBINED], ids=CONTROLS)
def test_the_boundary_is_that_of_the_eigenvalues(kind: int) -> None:
    """Within 1 % of the exact limit: the search for the simulated one would cost ten runs more."""
    bench = LegBench.at(400)
    limit = bench.exact_limit(kind)
    assert bench.is_stable(kind, 0.99 * limit) and not bench.is_stable(kind, 1.01 * limit)


@pytest.mark.slow
def test_the_whole_figure_agrees_with_the_eigenvalues() -> None:
    outcome = EXPERIMENT.run(8)
    assert outcome.passed and outcome.disagreement <= 0.02


@pytest.mark.parametrize("rate", [500, 1000])
@pytest.mark.parametrize("kind", [IMPEDANCE, COMBINED], ids=CONTROLS)
def test_both_controls_hold_their_wall_at_500_and_1000_hz(kind: int, rate: int) -> None:
    assert holds_default(kind, rate)


def test_the_default_wall_shakes_below_500_hz() -> None:
    """D2.1 4.3.1: "Below 500 Hz, the rendering can become unstable, thus producing vibrations"."""
    assert not holds_default(IMPEDANCE, 250)


def test_the_pose_of_rest_is_that_of_the_figure() -> None:
    """Two models of the same press: the foot is deep by force over stiffness, as the rig finds it."""
    bench = LegBench.at(1000)
    q, _, _ = rest_in_combined(bench.leg, bench.press, 40.0)
    deep = bench.leg.foot(q)[0] - bench.leg.foot(np.array(bench.press.pose))[0]
    assert deep == pytest.approx(bench.press.force / bench.stiffness(COMBINED, 40.0), rel=0.05)
    _, stiffness, _ = foot_on_wall(COMBINED, seconds=0.5)
    assert stiffness == pytest.approx(bench.stiffness(COMBINED, 40.0), rel=0.2)


def test_a_tick_of_delay_more_than_thought_is_seen() -> None:
    """Planted fault: a loop one tick later than its matrix holds a quarter less."""
    bench = LegBench.at(500)
    late = replace(bench.press, delay=2)
    assert not is_stable_but_for_a_neutral_way(impedance_loop(bench.leg, late, 0.75 * bench.exact_limit(IMPEDANCE)))
