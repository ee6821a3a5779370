"""A match: what feet do to the ball, and what the opponent's skill is worth."""

from __future__ import annotations

import math

import numpy as np
import pytest

from mimics_app.tasks.kinds.soccer.kind import SoccerPlay, SoccerSpec
from mimics_app.tasks.kinds.soccer.match import Match, Pitch
from mimics_app.tasks.kinds.soccer.mind import Act, Mind
from mimics_app.tasks.walking.legs import GAITS
from tests.support.ball_impact import impact_speed

FRAME = 1.0 / 60.0
MODERATE = 0.5


def _play(skill: float, seed: int, seconds: float) -> Match:
    """A match against a simulated person with the gait of hemiparesis."""
    match = Match(Pitch(), GAITS["hemiparetic"], skill, seed, 7.0)
    person = Mind(0.3, np.random.default_rng([seed, 9]))
    for _ in range(round(seconds / FRAME)):
        deed = person.decide(match.view_of_person())
        match.step(1.4 * deed.speed, deed.turn, deed.kicks, FRAME)
    return match


def _alone(seed: int = 1) -> Match:
    return Match(Pitch(), GAITS["healthy"], None, seed, 7.0)


def test_an_opponent_without_skill_keeps_its_goal_and_scores_none() -> None:
    matches = [_play(0.0, seed, 30.0) for seed in range(2)]
    assert all(match.act is Act.KEEP and match.opponent_goals == 0 for match in matches)
    assert sum(match.goals for match in matches) > 0


def _wins(skill: float, seeds: int, seconds: float, legs: str) -> tuple[float, float, float]:
    """Share of the matches that the opponent wins against a moderate player, and mean goals of both."""
    goals = []
    for seed in range(seeds):
        match = Match(Pitch(), GAITS[legs], skill, seed, 7.0)
        person = Mind(MODERATE, np.random.default_rng([seed, 9]))
        for _ in range(round(seconds / FRAME)):
            deed = person.decide(match.view_of_person())
            match.step(1.4 * deed.speed, deed.turn, deed.kicks, FRAME)
            if match.pause_s > 0.0 and max(match.goals, match.opponent_goals) >= 3:
                break
        goals.append((match.goals, match.opponent_goals))
    own, other = np.array(goals, np.float64).T
    return float((other > own).mean()), float(own.mean()), float(other.mean())


def test_the_most_skill_wins_and_no_skill_never_scores() -> None:
    """Three short matches; `make test-long` counts fifty."""
    won, _, scored = _wins(1.0, 3, 30.0, "hemiparetic")
    assert won >= 0.6 and scored > 0.5, "one without skill scores none, see above"


@pytest.mark.slow
@pytest.mark.parametrize("legs", ["healthy", "hemiparetic"])
def test_the_most_skill_wins_four_of_five_matches_of_fifty(legs: str) -> None:
    """90 s each, ended by three goals; a person with the same legs, and another one's."""
    won, own, other = _wins(1.0, 50, 90.0, legs)
    assert won >= 0.8, (won, own, other)
    assert _wins(0.0, 50, 90.0, legs)[2] == 0.0


def test_a_goal_is_seen_again_from_before_it_until_play_goes_on() -> None:
    """What is shown was 2 s before the goal when it begins, then goes on at three quarters of the speed."""
    match = _alone()
    match.ball.put(0.0, -7.9)
    match.ball.velocity = np.array([0.0, 0.0, -9.0])
    while match.pause_s == 0.0:
        match.step(0.0, 0.0, False, FRAME)
    ago: list[float] = []
    while match.pause_s > 0.0:
        match.step(0.0, 0.0, False, FRAME)
        ago.append(match.replay_s)
    shown = np.array([(k + 1) * FRAME - each for k, each in enumerate(ago) if each > 0.0])
    assert ago[0] == 0.0 and 3.0 < len(shown) * FRAME < 3.4
    assert shown[0] == pytest.approx(-2.0, abs=0.1)
    np.testing.assert_allclose(np.diff(shown), 0.75 * FRAME, atol=1e-9)
    assert shown[-1] > 0.2, "the ball is in the net at the end"


def test_a_kick_meets_the_ball_only_where_the_foot_swings() -> None:
    """A ball half a metre ahead is kicked, with at most the speed of the impact; one behind or far aside is not."""
    for place, met in (((0.0, -0.6), True), ((0.0, 0.6), False), ((0.9, -0.5), False)):
        match = _alone()
        match.person.put(0.0, 0.0, math.pi)
        match.ball.put(*place)
        happened = [each.kind for k in range(40) for each in match.step(0.0, 0.0, k == 0, FRAME)]
        assert ("kick" in happened) is met, place
        if met:
            assert match.ball.place[2] < place[1] - 1.0 and match.kicks == 1
            fastest = impact_speed(1.2, 1.1 * match.person.kick_speed)
            assert float(np.linalg.norm(match.ball.velocity)) < fastest


def test_a_ball_over_the_line_between_the_posts_is_a_goal_and_beside_them_bounces_back() -> None:
    for x, goal in ((0.4, True), (2.4, False)):
        match = _alone()
        match.ball.put(x, -6.5)
        match.ball.velocity = np.array([0.0, 0.0, -9.0])
        happened = [each.kind for _ in range(60) for each in match.step(0.0, 0.0, False, FRAME)]
        assert ("goal" in happened) is goal and ("board" in happened) is not goal
        assert match.goals == int(goal)


def test_after_a_goal_play_begins_in_the_middle_again() -> None:
    match = _alone()
    match.ball.put(0.0, -7.9)
    match.ball.velocity = np.array([0.0, 0.0, -9.0])
    kinds = [each.kind for _ in range(300) for each in match.step(0.0, 0.0, False, FRAME)]
    assert kinds[0] == "goal" and "whistle" in kinds
    assert abs(match.ball.place[2]) < 0.1 and match.pause_s <= 0.0


def test_the_opponent_is_not_much_faster_than_a_slow_person() -> None:
    """`pace` times the fastest that they have been, whatever the skill; the parameter sets it."""
    for pace in (1.0, 1.5):
        match = Match(Pitch(), GAITS["severe"], 1.0, 3, 7.0)
        match.pace, fastest = pace, 0.0
        for _ in range(60 * 10):
            match.step(0.45, 0.0, False, FRAME)
            fastest = max(fastest, match.opponent.walker.speed)
        assert 0.9 * pace * 0.45 < fastest <= pace * 0.45 + 1e-9


def test_who_walks_against_a_board_stands_and_along_it_goes_on() -> None:
    """The way walked is that over the ground, whatever the hand asks for."""
    for yaw, share in ((0.5 * math.pi, 0.0), (0.25 * math.pi, math.sqrt(0.5)), (math.pi, 1.0)):
        match = _alone()
        match.person.put(match.pitch.bounds.real, 0.0, yaw)
        for _ in range(120):
            match.step(1.0, 0.0, False, FRAME)
        before = match.person.walker.walked
        for _ in range(60):
            match.step(1.0, 0.0, False, FRAME)
        assert match.person.walker.walked - before == pytest.approx(share, abs=0.02)


@pytest.mark.parametrize(
    ("ball", "where", "far"),
    [
        ((0.0, -1.0), "ahead", "1 m"),
        ((0.0, 3.0), "behind", "3 m"),
        ((2.0, 0.2), "right", "2 m"),
        ((-2.0, 0.2), "left", "2 m"),
    ],
)
def test_the_cards_say_where_the_ball_is(ball: tuple[float, float], where: str, far: str) -> None:
    play = SoccerPlay(SoccerSpec("person", "ball"), 1, advises=False)
    play._match.person.put(0.0, 0.0, math.pi)  # the person looks along -z, where their goal is
    play._match.ball.put(*ball)
    cards = play.cards(None, 0)  # type: ignore[arg-type]
    assert (cards["ball"].label, cards["ball"].text) == (f"Ball: {where}", far)
    assert (cards["goal"].label, cards["goal"].text) == ("Goal: ahead", "8 m")
