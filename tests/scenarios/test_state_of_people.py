"""The state of simulated people from their raw signals: work is not stress, and too hard a task is."""

from __future__ import annotations

import numpy as np
import pytest

from mimics_app.contracts.messages.action_space import ActionSpace, Parameter
from mimics_app.contracts.messages.stage_messages import SignalBlock
from mimics_app.dsp.stage import PhysioDsp
from mimics_app.estimation.fusion import FusionEstimation
from mimics_app.learning.agent import Agent
from mimics_app.learning.goals import build_goal
from tests.support.body_signals import body


def estimate(
    seconds: int, seed: int, power: float, demand: float, signal: str = "power", measured: float | None = None
) -> tuple[list[float], float]:
    """Arousal from the end of the rest (90 s) on, one a second, and the effort at the end.

    The work of the body is that of an arm of so much power; `measured` is what a signal of other limbs shows of it.
    """
    shown = power if measured is None else measured
    signals, _ = body(
        seconds,
        seed,
        power=lambda s: power if s > 120 else 0.0,
        demand=lambda s: demand if s > 120 else float("nan"),
    )
    dsp, estimation, arousal, effort = PhysioDsp(), FusionEstimation(60.0), [], 0.0
    for second in range(seconds):
        t_ns = second * 10**9
        blocks = [SignalBlock(n, 1000.0, t_ns, v[1000 * second : 1000 * second + 1000]) for n, v in signals.items()]
        blocks.append(SignalBlock(signal, 60.0, t_ns, np.full(60, shown if second > 120 else 0.0)))
        state = estimation.update(dsp.process(blocks, t_ns + 10**9))
        if second > 90 and state.arousal is not None:
            arousal.append(state.arousal.mean)
        effort = 0.0 if state.effort is None else state.effort.mean
    return arousal, effort


def test_pure_effort_is_not_reported_as_arousal() -> None:
    """Against the same person at rest with the same chance: arousal drifts by up to 0.1 without work, too.

    Thirty people, from features: `test_arousal_of_people`.
    """
    arousal, effort = estimate(420, 1, power=1.2, demand=float("nan"))
    rest, _ = estimate(420, 1, power=0.0, demand=float("nan"))
    assert abs(np.mean(arousal[-150:]) - np.mean(rest[-150:])) <= 0.1
    assert effort > 0.6


def test_who_walks_faster_makes_more_effort_and_is_not_more_aroused() -> None:
    """The power of both legs at three speeds of the belt, and the work of the heart that goes with it."""
    rest, _ = estimate(420, 1, power=0.0, demand=float("nan"), signal="leg_power")
    efforts = []
    for share in (0.25, 0.5, 0.75):
        arousal, effort = estimate(420, 1, 1.5 * share, float("nan"), "leg_power", 25.0 * share)
        assert abs(np.mean(arousal[-150:]) - np.mean(rest[-150:])) <= 0.1
        efforts.append(effort)
    assert efforts == pytest.approx([0.25, 0.5, 0.75], abs=0.02)


def test_too_hard_a_task_is() -> None:
    arousal, _ = estimate(300, 1, power=0.0, demand=0.95)
    assert np.mean(arousal[-60:]) > np.mean(arousal[:25]) + 0.15


def effort_under(goal: str, *, measured: bool = True) -> float:
    """Mean effort over the second half of an hour in which the agent sets the power through a resistance."""
    # It has a rate: there are no trials here, and without one a choice would not hold before the next trial.
    agent = Agent("thompson", ActionSpace([Parameter("resistance", 0.4, 0.0, 1.0, rate=0.1, harder=1)]), 4)
    dsp, estimation, wanted, resistance, effort = PhysioDsp(), FusionEstimation(60.0), build_goal(goal), 0.4, []
    for second in range(3600):
        t_ns = second * 10**9
        blocks = [SignalBlock("power", 60.0, t_ns, np.full(60, 1.5 * resistance))] if measured else []
        state = estimation.update(dsp.process(blocks, t_ns + 10**9))
        action = agent.choose(state, None, wanted.reward(state, None), t_ns)
        resistance = resistance if action is None else action.values["resistance"]
        effort.append(resistance if state.effort is None else state.effort.mean)
    return float(np.mean(effort[1800:]))


def test_movement_reaches_learning_through_the_state() -> None:
    """Power becomes a feature, the feature effort, effort a reward, and the reward the next power."""
    assert effort_under("effort:0:0.2") < 0.3
    assert effort_under("effort:0.6:0.8") > 0.5
    assert effort_under("effort:0.6:0.8", measured=False) == 0.4, "no signal, no state, no reward, no choice"
