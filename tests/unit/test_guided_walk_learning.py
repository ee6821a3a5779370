"""The guide of the walk: what it learns, from which rewards, and against guides that learn nothing."""

from __future__ import annotations

import math

import numpy as np
import pytest

from mimics_app.contracts.errors import UsageError
from mimics_app.contracts.messages.action_space import ActionSpace, Parameter
from mimics_app.contracts.messages.stage_messages import Estimate, TaskAction, TrialResult, UserState
from mimics_app.lab.physio.walk_study import CONTROLS, walk_study
from mimics_app.learning.builder import build_learning, check_learning
from mimics_app.learning.goals import STATES, build_goal
from mimics_app.learning.registry import POLICIES
from mimics_app.learning.stepwise import STEP_POLICIES, StepAgent, StepValues, place_of
from mimics_app.tasks.kinds.guided_walk.walk_people import Alley, Deed, Guide, Walker

DEED = Parameter("deed", 3.0, 0.0, 5.0, step=1.0, kind="avatar")
SPACE = ActionSpace([DEED])
NOBODY = UserState(0)
SECOND = 10**9


def step(reward: float = 0.0, gap: float = 1.0, bearing: float = 0.0) -> TrialResult:
    return TrialResult(0, 0, "step", 0.0, reward, observed={"gap": gap, "bearing": bearing, "left": 2.0})


def ended() -> TrialResult:
    return TrialResult(0, 0, "finished", 1.0, 1.0)


@pytest.mark.seconds
def test_the_published_order_of_the_guided_walk() -> None:
    """Kastanis & Slater 2012: nine, six and one of ten; the walkers' distances are published ones."""
    intimate, social, chance = (walk_study(c, people=150, seed=9) for c in ("intimate", "social", "random"))
    assert intimate.low > social.high
    assert social.low > chance.share
    assert intimate.share >= 2.0 * chance.share


@pytest.mark.parametrize("guide", CONTROLS)
def test_who_learns_nothing_does_not_bring_people_there_and_the_order_of_the_actions_does_not_matter(
    guide: str | Deed,
) -> None:
    taught, other = (walk_study("intimate", people=40, seed=3, guide=g) for g in ("taught", guide))
    if guide == "permuted":
        assert other.low < taught.high and taught.low < other.high
    else:
        assert other.high < taught.low


@pytest.mark.parametrize("condition", ["intimate", "social"])
def test_a_guide_that_was_taught_brings_more_people_than_one_that_was_not(condition: str) -> None:
    taught, never = (walk_study(condition, people=60, seed=4, guide=g) for g in ("taught", "never taught"))
    assert taught.low > never.high


def test_equal_values_are_drawn_among() -> None:
    table = StepValues(6, np.random.default_rng(1))
    counts = np.bincount([table.choose(0)[0] for _ in range(600)], minlength=6)
    assert counts.min() > 60
    table.values[0, [1, 4]] = 1.0
    draws = [table.choose(0) for _ in range(600)]
    counts = np.bincount([deed for deed, _ in draws], minlength=6)
    assert min(counts[1], counts[4]) > 200
    for deed in range(6):
        stated = {chance for drawn, chance in draws if drawn == deed}
        assert all(counts[deed] / 600 == pytest.approx(chance, abs=0.06) for chance in stated)


@pytest.mark.parametrize("policy", ["q", "sarsa"])
def test_the_guide_learns_what_pays(policy: str) -> None:
    agent = build_learning(policy, "task", SPACE, 1)
    deeds: list[float] = []
    for _ in range(300):
        worth = 0.3 if deeds and deeds[-1] == 4.0 else 0.0
        action = agent.choose(NOBODY, step(worth), worth, 0)
        assert isinstance(action, TaskAction)
        deeds.append(action.values["deed"])
    assert deeds[-100:].count(4.0) > 80
    assert agent.choose(NOBODY, ended(), 1.0, 0) is None


def test_sarsa_learns_the_value_of_what_it_does_and_q_that_of_the_best() -> None:
    """Both from the same steps: what follows has one good action, which an exploring guide does not always choose."""
    aims = []
    for method in ("q", "sarsa"):
        table = StepValues(6, np.random.default_rng(1), method)
        table.values[1, 2] = 10.0
        table.learn(0, 0, 0.0, 1)
        aims.append(table.values[0, 0])
    assert 0.2 < aims[1] < aims[0]


@pytest.mark.parametrize("goal", ["arousal:-1:-0.5", "arousal:0.5:1"])
@pytest.mark.parametrize("policy", ["q", "sarsa"])
def test_the_guide_learns_under_a_goal_of_a_state(policy: str, goal: str) -> None:
    """A body that is roused by approaches and calmed by waiting, read at 1 Hz; steps come every two seconds."""
    agent, wanted, arousal = build_learning(policy, goal, SPACE, 5), build_goal(goal), 0.0
    deeds: list[float] = []
    rng = np.random.default_rng(2)
    for second in range(1, 1400):
        roused = {0.0: 1.0, 3.0: -1.0}.get(deeds[-1] if deeds else 2.0, 0.0)
        arousal += 0.3 * (roused - arousal)
        state = UserState(second * SECOND, arousal=Estimate(arousal + 0.05 * rng.standard_normal(), 0.01))
        result = step() if second % 2 == 0 else None
        action = agent.choose(state, result, wanted.reward(state, result), state.t_ns)
        if action is not None:
            deeds.append(action.values["deed"])
    late = deeds[-200:]
    sought, avoided = (0.0, 3.0) if goal.endswith(":1") else (3.0, 0.0)
    assert late.count(sought) > 100
    assert late.count(avoided) < 20


def test_a_reward_between_two_steps_is_kept_until_the_next_one() -> None:
    agent = StepAgent("q", DEED, 1)
    before = agent.table.values.copy()
    agent.choose(NOBODY, step(), None, 0)
    for worth in (2.0, None, 4.0):
        assert agent.choose(NOBODY, None, worth, 0) is None
    np.testing.assert_array_equal(agent.table.values, before)
    agent.choose(NOBODY, step(), None, 0)
    changed = agent.table.values - before
    assert np.count_nonzero(changed) == 1
    other = StepAgent("q", DEED, 1)
    other.choose(NOBODY, step(), None, 0)
    other.choose(NOBODY, step(), 3.0, 0)
    np.testing.assert_array_equal(agent.table.values, other.table.values)


def test_a_reward_is_not_kept_beyond_the_end_of_a_trial() -> None:
    agent = StepAgent("q", DEED, 1)
    before = agent.table.values.copy()
    for result, worth in ((step(), None), (None, 5.0), (ended(), None), (step(), None), (step(), None)):
        agent.choose(NOBODY, result, worth, 0)
    np.testing.assert_array_equal(agent.table.values, before)


def test_a_step_is_credited_to_the_ones_before_it_in_the_same_trial() -> None:
    def valued(*, ended: bool) -> float:
        table = StepValues(2, np.random.default_rng(1))
        table.learn(0, 1, 0.0, 1)
        before = table.values[0, 1]
        if ended:
            table.end()
        table.learn(1, 0, 1.0, 2)
        assert table.values[1, 0] > 0.2
        return float(table.values[0, 1] - before)

    assert valued(ended=False) > 0.05
    assert valued(ended=True) == 0.0


def test_an_agent_of_steps_begins_each_trial_anew() -> None:
    agent = StepAgent("q", DEED, 1)
    steps = [step(gap=gap) for gap in (0.2, 0.7, 1.0, 1.6)]
    for each in (*steps[:2], ended(), *steps[2:]):
        agent.choose(NOBODY, each, 5.0 if each is steps[3] else 0.0, 0)
    first, third = place_of(steps[0].observed), place_of(steps[2].observed)
    assert agent.table.values[third].max() > 0.5
    assert agent.table.values[first].max() <= 0.2


def test_policies_of_steps_are_what_they_say_or_refused() -> None:
    """Fixed: the scene's own action; random: each as often; who chooses demands between trials is refused."""
    fixed, chance = (build_learning(name, "task", SPACE, 1) for name in ("fixed", "random"))
    done: dict[str, list[float]] = {"fixed": [], "random": []}
    for _ in range(600):
        for name, agent in (("fixed", fixed), ("random", chance)):
            action = agent.choose(NOBODY, step(0.3), 0.3, 0)
            assert action is not None
            assert action.propensity == pytest.approx(1.0 if name == "fixed" else 1.0 / 6.0)
            done[name].append(action.values["deed"])
    assert set(done["fixed"]) == {3.0}
    assert min(done["random"].count(float(deed)) for deed in Deed) > 60
    for policy in POLICIES:
        if policy not in STEP_POLICIES:
            with pytest.raises(UsageError, match="chosen at every step") as refusal:
                check_learning(policy, "task", SPACE)
            assert "q, sarsa" in refusal.value.fix


@pytest.mark.parametrize("policy", STEP_POLICIES)
def test_a_goal_that_steps_cannot_follow_is_refused(policy: str) -> None:
    check_learning(policy, "task", SPACE)
    with pytest.raises(UsageError, match="success"):
        check_learning(policy, "success:0.7", SPACE)
    for state in STATES:
        if policy in ("q", "sarsa"):
            check_learning(policy, f"{state}:0:1", SPACE)
        else:
            with pytest.raises(UsageError, match="these can: q, sarsa"):
                check_learning(policy, f"{state}:0:1", SPACE)


def test_people_stay_in_the_alley_and_the_guide_at_a_distance() -> None:
    rng, alley = np.random.default_rng(6), Alley()
    for nearest in (0.38, 1.2):
        walker, guide = Walker(rng, alley), Guide(rng, alley, nearest)
        for _ in range(500):
            deed = Deed(int(rng.integers(6)))
            guide.do(deed, walker.at)
            assert abs(guide.at - walker.at) >= nearest - 1e-9
            walker.answer(guide.at, deed)
            assert alley.low <= walker.at.real <= alley.high
            assert abs(walker.at.imag) <= alley.half


@pytest.mark.parametrize("angle", np.linspace(-3.0, 3.0, 13).tolist())
def test_what_a_guide_sees_is_the_angle_between_two_directions(angle: float) -> None:
    """By the law of cosines in the triangle of walker, guide and place, and by the side on which the guide is."""
    rng, alley = np.random.default_rng(8), Alley()
    walker = complex(*rng.uniform(-0.8, 0.8, 2))
    to_place = alley.place - walker
    guide = walker + 0.7 * to_place / abs(to_place) * np.exp(1j * angle)
    seen = alley.observe(walker, guide)
    between = 0.7**2 + abs(to_place) ** 2 - 1.4 * abs(to_place) * math.cos(seen["bearing"])
    assert seen["gap"] == pytest.approx(0.7)
    assert between == pytest.approx(abs(guide - alley.place) ** 2)
    on_the_right = to_place.real * (guide - walker).imag > to_place.imag * (guide - walker).real
    assert on_the_right == (seen["bearing"] > 0.0) or angle == 0.0


def test_who_is_too_near_pushes_people_straight_away_in_any_direction() -> None:
    alley = Alley()
    for side in np.linspace(0.0, 6.0, 7):
        moved = 0.0j
        for seed in range(40):
            walker = Walker(np.random.default_rng(seed), alley)
            walker.answer(0.4 * np.exp(1j * side), Deed.WAIT)
            moved += walker.at / 40
        away = -moved * np.exp(-1j * side)
        assert away.real > 0.1
        assert abs(away.imag) < 0.1 * away.real
