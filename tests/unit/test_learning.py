"""Policies, goals and the agent: what they choose, within which limits, and how well on simulated people."""

from __future__ import annotations

import numpy as np
import pytest

from mimics_app.contracts.errors import UsageError
from mimics_app.contracts.messages.action_space import ActionSpace, Parameter
from mimics_app.contracts.messages.stage_messages import Estimate, TrialResult, UserState
from mimics_app.estimation.fusion import EffortModel
from mimics_app.lab.physio.cohort import play_cohort
from mimics_app.learning.agent import Agent
from mimics_app.learning.goals import StateBand, SuccessShare, build_goal
from mimics_app.learning.policies.bandits import LinUcb
from mimics_app.learning.policy import LEVELS, TARGET, Outcome
from mimics_app.learning.registry import POLICIES, build_policy
from mimics_app.tasks.adaptation import Adaptation

RADIUS = Parameter("radius", 1.0, 0.6, 1.2, harder=-1)
LOOK = Parameter("look", 0.0, 0.0, 2.0, step=1.0, kind="appearance", dwell_s=30.0)
SPACE = ActionSpace([RADIUS, LOOK])
NOBODY = UserState(0)


def result(trial: int, performance: float, radius: float, **more: object) -> TrialResult:
    return TrialResult(trial, 0, "finished", performance, performance, values={"radius": radius, "look": 0.0}, **more)


def test_the_tracker_beats_the_staircase_and_chance() -> None:
    regret = {name: play_cohort(POLICIES[name], n=400).mean for name in ("kalman", "staircase", "random")}
    assert regret["kalman"] <= 0.75 * regret["staircase"]
    assert regret["kalman"] <= 0.25 * regret["random"]


@pytest.mark.parametrize(
    ("success", "step"), [(1.0, 0.05), (0.8, 0.05), (0.79, 0.0), (0.6, 0.0), (0.59, -0.05), (0.0, -0.05), (np.nan, 0.0)]
)
def test_the_staircase_steps_up_after_four_fifths_and_down_below_three(success: float, step: float) -> None:
    policy, nobody = build_policy("staircase"), np.full(1, np.nan)
    policy.begin(np.full(1, 0.5), np.random.default_rng(2))
    policy.learn(Outcome(policy.act().demand, np.full(1, success), nobody, nobody, nobody))
    assert policy.act().demand == pytest.approx(0.5 + step)


def test_who_does_not_respond_loses_nothing_by_being_measured() -> None:
    measured, alone = (play_cohort(POLICIES[name], n=1500) for name in ("kalman", "kalman_performance"))
    silent = ~measured.responds
    assert silent.mean() == pytest.approx(0.12, abs=0.04)
    assert measured.regret[:, silent].mean() <= 1.02 * alone.regret[:, silent].mean()


def test_a_load_that_contradicts_success_is_not_used() -> None:
    """Load that rises with success says nothing of the demand: the same choices as without any."""
    policies = [build_policy(name) for name in ("kalman", "kalman_performance")]
    for policy in policies:
        policy.begin(np.full(1, 0.5), np.random.default_rng(1))
        for success, load in [(0.9, 0.8), (0.5, -0.8)] * 10:
            policy.learn(Outcome(policy.act().demand, *(np.full(1, value) for value in (success, load, 0.05, 0.0))))
    measured, alone = (float(policy.act().demand[0]) for policy in policies)
    assert measured == alone


def test_a_body_that_ignores_the_task_gives_no_benefit() -> None:
    """Were there a leak from the hidden person to the policy, it would."""
    measured, alone = (play_cohort(POLICIES[n], n=1500, blind=True).mean for n in ("kalman", "kalman_performance"))
    assert measured >= 0.99 * alone


@pytest.mark.parametrize("name", ["linucb", "thompson", "q", "sarsa", "actor_critic"])
def test_learners_learn(name: str) -> None:
    """Better than a fixed demand, which itself has less than half the regret of chance."""
    assert play_cohort(POLICIES[name], n=200).mean < 0.9 * play_cohort(POLICIES["fixed"], n=200).mean


def test_the_agent_waits_for_the_next_trial_and_keeps_limits_and_steps() -> None:
    agent = Agent("kalman", SPACE, 1)
    assert agent.choose(NOBODY, None, None, 0) is None
    action = agent.choose(NOBODY, result(0, 0.2, 1.0), 0.1, 10**9)
    assert action is not None
    assert action.at_trial == 1
    assert set(action.values) == {"radius"}
    assert 1.0 < action.values["radius"] <= 1.2, "who fails gets it easier"
    harder = agent.choose(NOBODY, result(1, 1.0, 1.1), 0.1, 2 * 10**9)
    assert harder is not None
    assert harder.values["radius"] < action.values["radius"]


def test_an_explorer_tries_the_looks_but_not_before_their_time() -> None:
    agent = Agent("random", SPACE, 3)
    changed, held = [], 0.0
    for trial in range(60):
        action = agent.choose(NOBODY, result(trial, 0.5, 1.0), 0.5, trial * 10 * 10**9)
        if action is not None and action.values.get("look", held) != held:
            held = action.values["look"]
            assert held in (0.0, 1.0, 2.0)
            assert 0.0 < action.propensity < 1.0
            changed.append(trial)
    assert len(changed) > 3
    assert (np.diff(changed) >= 3).all()


def test_a_choice_that_stays_holds_against_the_trial_list() -> None:
    """Levels are often chosen twice in a row; the condition of the next trial would replace what is not sent again."""
    agent, adaptation = Agent("thompson", ActionSpace([RADIUS]), 1), Adaptation(ActionSpace([RADIUS]))
    stayed = 0
    for trial in range(40):
        adaptation.begin_trial(trial, {"radius": 1.1})
        wanted = agent._values["radius"]
        assert trial == 0 or adaptation.values["radius"] == wanted
        action = agent.choose(NOBODY, result(trial, 0.7, adaptation.values["radius"]), 1.0, trial * 10**9)
        if action is not None:
            adaptation.take(action)
        stayed += agent._values["radius"] == wanted
    assert stayed > 10


def test_a_reward_is_of_the_value_that_held_not_of_one_that_was_chosen_too_early() -> None:
    """The dwell time keeps the look at 2; only trials with it are rewarded, so it is the one to be preferred."""
    look = Parameter("look", 2.0, 0.0, 2.0, step=1.0, kind="appearance", dwell_s=1000.0)
    agent = Agent("random", ActionSpace([RADIUS, look]), 3)
    agent._changed_ns["look"] = 0
    seen = TrialResult(0, 0, "finished", 0.5, 0.5, values={"radius": 1.0, "look": 2.0})
    for trial in range(40):
        action = agent.choose(NOBODY, seen, 1.0, trial * 10**9)
        assert action is None or action.values["look"] == 2.0
    chosen = [agent._arms[0].act()[0] for _ in range(200)]
    assert np.mean(np.array(chosen) == 2.0) > 0.9


LEARNT = ("_table", "_sums", "_precision", "_values")
"""Attributes of the policies that hold what they have learnt."""


@pytest.mark.parametrize("name", ["linucb", "thompson", "q", "sarsa", "actor_critic"])
def test_a_trial_without_a_reward_teaches_nothing(name: str) -> None:
    policies = [build_policy(name) for _ in range(2)]
    rewarded, unknown = np.full(1, 0.9), np.full(1, np.nan)
    for policy in policies:
        policy.begin(np.full(1, 0.5), np.random.default_rng(2))
        policy.learn(Outcome(policy.act().demand, rewarded, unknown, unknown, rewarded))
    before = {key: np.array(value) for key, value in vars(policies[0]).items() if key in LEARNT}
    policies[0].learn(Outcome(policies[0].act().demand, rewarded, unknown, unknown, unknown))
    for key, value in before.items():
        np.testing.assert_array_equal(vars(policies[0])[key], value)


def test_a_look_that_costs_is_chosen_less_than_one_that_is_free() -> None:
    """All looks earn the same reward; the farther one is from the default, the more of it a cost takes."""

    def looks(cost: float) -> list[float]:
        look = Parameter("look", 0.0, 0.0, 2.0, step=1.0, kind="appearance", cost=cost)
        agent, held = Agent("random", ActionSpace([look]), 3), 0.0
        chosen = []
        for trial in range(300):
            seen = TrialResult(trial, 0, "finished", 0.5, 0.5, values={"look": held})
            action = agent.choose(NOBODY, seen, 0.5, trial)
            held = held if action is None else action.values["look"]
            chosen.append(held)
        return chosen[100:]

    free, dear = looks(0.0), looks(1.0)
    assert 0.2 < free.count(2.0) / 200 < 0.5, "without a cost all three alike"
    assert dear.count(2.0) < 10
    assert dear.count(0.0) > 150


@pytest.mark.parametrize("trials", [True, False], ids=["reward of a trial", "reward of a state"])
def test_a_demand_that_costs_is_left_for_the_default(trials: bool) -> None:
    """The reward is the same everywhere: only the cost of the way from the default tells the levels apart."""

    def away(cost: float) -> float:
        radius = Parameter("radius", 0.9, 0.6, 1.2, harder=-1, cost=cost, rate=0.0 if trials else 1.0)
        agent, held, total = Agent("thompson", ActionSpace([radius]), 3), 0.9, 0.0
        for trial in range(60):
            seen = result(trial, 0.7, held) if trials else None
            action = agent.choose(NOBODY, seen, 0.5, trial * 10**9)
            held = held if action is None else action.values["radius"]
            total += abs(held - 0.9) / 0.6 if trial >= 20 else 0.0
        return total / 40

    assert away(3.0) < 0.5 * away(0.0)


def test_a_veto_leaves_it_alone() -> None:
    agent = Agent("random", ActionSpace([LOOK]), 1)
    for trial in range(20):
        action = agent.choose(NOBODY, result(trial, 0.5, 1.0), 0.5, trial * 60 * 10**9)
        assert action is None or "radius" not in action.values


def test_a_bandit_takes_load_for_the_opposite_of_success() -> None:
    """What it has learnt from too much and too little success alone it does under too little and too much load."""

    def outcome(demand: float, performance: float, load: float, reward: float) -> Outcome:
        return Outcome(*(np.array([value]) for value in (demand, performance, load, 0.1, reward)))

    chosen = {}
    for load in (-1.0, 1.0):
        policy = LinUcb(width=0.0)
        policy.begin(np.array([0.5]), np.random.default_rng(1))
        for sign, step in [(1.0, -0.2), (1.0, 0.2), (-1.0, -0.2), (-1.0, 0.2)] * 10:
            policy.learn(outcome(0.5, TARGET + 0.3 * sign, 0.0, 0.3))
            policy.learn(outcome(0.5 + step, TARGET, 0.0, np.sign(sign * step)))  # harder after success pays
        policy.learn(outcome(0.5, TARGET, load, 0.3))
        chosen[load] = float(policy.act().demand[0])
    assert chosen[1.0] < 0.5 < chosen[-1.0]


def test_load_moves_the_tracker_where_success_says_nothing() -> None:
    over = UserState(1, arousal=Estimate(0.8, 0.05), load=(0.0, 0.05, 0.95), quality=1.0)
    with_load, without = (play(Agent(name, SPACE, 1), over) for name in ("kalman", "kalman_performance"))
    assert with_load > without, "over-challenged: easier, that is wider"


def play(agent: Agent, state: UserState) -> float:
    """Radius after trials that went a little too badly for a person who is over-challenged."""
    radius = 1.0
    for trial in range(12):
        action = agent.choose(state, result(trial, 0.6, radius), 0.5, trial * 10**9)
        radius = radius if action is None else action.values.get("radius", radius)
    return radius


def test_demand_of_values_and_back() -> None:
    assert SPACE.demand({"radius": 1.2, "look": 2.0}) == pytest.approx(0.0)
    assert SPACE.demand({"radius": 0.6}) == pytest.approx(1.0)
    assert SPACE.demand({"look": 1.0}) is None
    for demand in LEVELS:
        assert RADIUS.demand(RADIUS.at_demand(float(demand))) == pytest.approx(demand)


@pytest.mark.parametrize(("performance", "worth"), [(0.7, 1.0), (1.0, 0.0), (0.4, 0.0), (0.0, -1.0)])
def test_success_as_a_goal(performance: float, worth: float) -> None:
    assert SuccessShare(0.7).reward(NOBODY, result(0, performance, 1.0)) == pytest.approx(worth)
    assert SuccessShare().reward(NOBODY, result(0, performance, 1.0, practice=True)) is None
    assert SuccessShare().reward(NOBODY, None) is None


def test_a_state_as_a_goal() -> None:
    goal = StateBand("arousal", -0.2, 0.3)
    calm = UserState(0, arousal=Estimate(0.0, 0.1))
    assert goal.reward(calm, None) is None, "bodies are slow: nothing to judge at once"
    assert goal.reward(UserState(31 * 10**9, arousal=Estimate(0.0, 0.1)), None) == 1.0
    assert goal.reward(UserState(40 * 10**9, arousal=Estimate(0.8, 0.1)), None) is None
    assert goal.reward(UserState(62 * 10**9, arousal=Estimate(0.8, 0.1)), None) == pytest.approx(0.5)
    assert goal.reward(UserState(99 * 10**9), None) is None, "not known"


@pytest.mark.parametrize("words", ["", "success:2", "success:", "success:0.7x", "arousal", "arousal:1:0", "joy:0:1"])
def test_a_goal_that_cannot_be_is_refused(words: str) -> None:
    with pytest.raises(ValueError, match="unknown goal"):
        build_goal(words)


def test_a_policy_that_is_not_there_is_reported_with_the_nearest() -> None:
    with pytest.raises(UsageError, match="kalman"):
        build_policy("kalmann")


def test_policies_that_learn_from_rewards_and_the_random_one_explore() -> None:
    assert {name for name in POLICIES if getattr(build_policy(name), "explores", False)} == {
        "random", "linucb", "thompson", "q", "sarsa", "actor_critic"
    }  # fmt: skip


def test_pure_effort_is_explained_by_its_power() -> None:
    """Heart rate that follows power with the kinetics of another leaves little to be read as arousal."""
    model, heart, worst = EffortModel(), 0.0, 0.0
    for second in range(900):
        power = 1.0 if 60 <= second % 300 < 200 else 0.0
        heart += (1.0 / (30.0 if power else 45.0)) * (14.0 * power / 1.5 - heart)
        model.step(power, 1.0)
        left = model.residual(heart, learn=True)
        worst = max(worst, abs(left)) if second > 300 else worst
    assert worst < 2.5


def test_the_environment_is_one_of_gymnasium() -> None:
    from gymnasium.utils.env_checker import check_env

    from mimics_app.lab.physio.gym_env import TrainingEnv

    check_env(TrainingEnv(SPACE, trials=5), skip_render_check=True)


def test_the_environment_punishes_what_is_too_hard() -> None:
    from mimics_app.lab.physio.gym_env import TrainingEnv

    env, totals = TrainingEnv(trials=20), []
    for demand in (0.5, 1.0):
        env.reset(seed=3)
        steps = [env.step({"difficulty": np.array([demand], np.float32)}) for _ in range(20)]
        assert steps[-1][3]
        totals.append(sum(step[1] for step in steps))
    assert totals[0] > totals[1]
