"""What a policy says that it can follow, and what it does: people whose arousal follows the demand, opposite goals."""

from __future__ import annotations

import numpy as np
import pytest

from mimics_app.contracts.errors import UsageError
from mimics_app.contracts.messages.action_space import ActionSpace, Parameter
from mimics_app.contracts.messages.stage_messages import Estimate, TrialResult, UserState
from mimics_app.learning.agent import Agent
from mimics_app.learning.goals import STATES, build_goal, is_among
from mimics_app.learning.policy import Outcome
from mimics_app.learning.registry import POLICIES, check_goal
from mimics_app.tasks.adaptation import Adaptation

SECOND = 10**9
FOLLOWERS = [name for name, build in POLICIES.items() if is_among("arousal:-1:-0.6", build().follows)]
OTHERS = [name for name in POLICIES if name not in FOLLOWERS]


def demands(policy: str, goal: str, *, rate: float = 0.0, trials: int = 45) -> float:
    """Mean demand of four sessions after a third of them; arousal is the demand, 15 s late, with noise."""
    late = []
    for seed in range(4):
        rng, space = (
            np.random.default_rng([seed, 7]),
            ActionSpace([Parameter("demand", 0.5, 0.0, 1.0, 0.0, rate, harder=1)]),
        )
        agent, wanted, adaptation = Agent(policy, space, seed), build_goal(goal), Adaptation(space)
        arousal = 0.0
        for second in range(1, 20 * trials + 1):
            demand = adaptation.values["demand"]
            arousal += (2.0 * demand - 1.0 - arousal) / 15.0
            state = UserState(second * SECOND, arousal=Estimate(arousal + 0.15 * rng.standard_normal(), 0.09))
            trial, result = second // 20, None
            if second % 20 == 0:
                share = rng.binomial(10, 1.0 / (1.0 + np.exp(10.0 * (demand - 0.6)))) / 10
                result = TrialResult(trial - 1, state.t_ns, "finished", share, share, values=dict(adaptation.values))
            action = agent.choose(state, result, wanted.reward(state, result), state.t_ns)
            if action is not None:
                adaptation.take(action)
            adaptation.step(1.0)
            if result is not None:
                adaptation.begin_trial(trial, {})
            if trial > trials // 3:
                late.append(demand)
    return float(np.mean(late))


@pytest.mark.parametrize("rate", [0.0, 1.0], ids=["between trials", "at once"])
@pytest.mark.parametrize("policy", FOLLOWERS)
def test_who_says_so_goes_where_the_state_is_wanted(policy: str, rate: float) -> None:
    calm, roused = (demands(policy, goal, rate=rate) for goal in ("arousal:-1:-0.6", "arousal:0.6:1"))
    assert roused - calm > 0.15


def test_there_are_both() -> None:
    assert {"linucb", "thompson"} <= set(FOLLOWERS)
    assert {"kalman", "staircase", "fixed", "random"} <= set(OTHERS)


@pytest.mark.parametrize("state", STATES)
@pytest.mark.parametrize("policy", OTHERS)
def test_who_cannot_is_refused_with_the_names_of_those_that_can(policy: str, state: str) -> None:
    with pytest.raises(UsageError, match=f'"{policy}" cannot follow the goal "{state}:0.1:0.3"') as refusal:
        check_goal(policy, f"{state}:0.1:0.3")
    assert all(name in refusal.value.fix for name in FOLLOWERS)
    assert not any(name in refusal.value.fix.replace(":", ",").split(", ") for name in OTHERS)


@pytest.mark.parametrize("policy", ["kalman", "kalman_performance", "staircase", "proportional"])
def test_a_rule_made_for_one_share_of_success_takes_no_other(policy: str) -> None:
    check_goal(policy, "success")
    check_goal(policy, "success:0.70")
    for goal in ("success:0.5", "task"):
        with pytest.raises(UsageError, match="cannot follow"):
            check_goal(policy, goal)


@pytest.mark.parametrize("policy", POLICIES)
def test_the_goal_of_a_scene_that_names_none_is_for_everybody(policy: str) -> None:
    check_goal(policy, "success:0.7")


@pytest.mark.parametrize("policy", sorted(POLICIES))
def test_a_propensity_is_how_often_a_choice_is_made(policy: str) -> None:
    """Thousands of equal people, each with a draw of their own: the shares of the choices are what is stated."""
    people, rng = 6000, np.random.default_rng(3)
    learner = POLICIES[policy]()
    learner.begin(np.full(people, 0.5), rng)
    for value in (0.9, 0.3):
        learner.act()
        columns = (np.full(people, x) for x in (0.4 + 0.1 * value, value, 0.1, 0.2, value))
        learner.learn(Outcome(*columns))
        if hasattr(learner, "_move"):
            learner._move[:] = 1
    choice = learner.act()
    checked = 0.0
    for demand in np.unique(choice.demand):
        of_it = choice.demand == demand
        if of_it.sum() >= 150:
            weight = (1.0 / choice.propensity[of_it]).mean()
            assert weight == pytest.approx(1.0 / of_it.mean(), rel=0.3), "the weight of off-policy evaluation"
            checked += of_it.mean()
    assert checked > 0.6


def test_the_propensity_of_an_action_has_that_of_every_part_of_it() -> None:
    """A level and a look, drawn apart: 1 / propensity is on average the number of pairs, whatever their shares are."""
    look = Parameter("look", 0.0, 0.0, 2.0, step=1.0, kind="appearance")
    space = ActionSpace([Parameter("demand", 0.5, 0.0, 1.0, harder=1), look])
    shares = []
    for seed in range(300):
        agent = Agent("random", space, seed)
        result = TrialResult(0, 0, "finished", 0.5, 0.5, values=space.defaults())
        action = agent.choose(UserState(0), result, 0.5, 0)
        shares.append(1.0 if action is None else action.propensity)
    assert np.mean(1.0 / np.array(shares)) == pytest.approx(33.0, rel=0.3)
