"""Who walks in the orthosis goes on, or to the side to which the hips turn them; nothing else moves them aside."""

from __future__ import annotations

import math
from collections.abc import Iterator
from types import SimpleNamespace

import pytest

from mimics_app.contracts.messages.leg_motion import LegMotion
from mimics_app.tasks.kinds.canyon_walk.kind import CanyonWalkPlay, CanyonWalkSpec, SectionSpec
from mimics_app.tasks.kinds.soccer.kind import SoccerPlay, SoccerSpec
from mimics_app.tasks.walking.hip_steering import HipSteering
from mimics_app.tasks.walking.legs import GAITS, Legs
from mimics_app.tasks.walking.walker import PERSON

FRAME = 1.0 / 60.0


def walk(further: float, seconds: float) -> Iterator[LegMotion]:
    """Legs at 0.4 m/s whose left hip is ahead of the usual by half an angle [rad], the right one behind by as much."""
    legs, strikes, before = Legs(GAITS["healthy"]), 0, 0.0
    for _ in range(round(seconds / FRAME)):
        now = legs.step(0.4, FRAME)
        strikes, before = strikes + (legs.phase < before), legs.phase
        hips = now.hip_left + 0.5 * further, now.hip_right - 0.5 * further
        yield now._replace(hip_left=hips[0], hip_right=hips[1], strikes=(strikes, strikes))


class Worn:
    """Reads legs that somebody else moves."""

    def __init__(self, further: float) -> None:
        self._legs = walk(further, 60.0)

    def read(self, joints: object, strikes: object, seconds: float) -> LegMotion:
        return next(self._legs)


def played(play: CanyonWalkPlay | SoccerPlay, seconds: float) -> CanyonWalkPlay | SoccerPlay:
    snapshot = SimpleNamespace(left_strikes=0, right_strikes=0)
    seen = SimpleNamespace(hip_world=(0.0, 0.0, 0.0), grasp=0.0, pressed=(), now_ns=0, q=(), snapshot=snapshot)
    play.start_attempt(seen)  # type: ignore[arg-type]
    for _ in range(round(seconds / FRAME)):
        play.travel(seen, FRAME)  # type: ignore[arg-type]
    return play


@pytest.mark.parametrize(("degrees", "aside"), [(0.0, 0.0), (1.5, 0.0), (5.0, 0.5), (-5.0, -0.5), (12.0, 1.0)])
def test_the_leg_that_swings_further_turns_to_the_other_side(degrees: float, aside: float) -> None:
    steering = HipSteering()
    turned = [steering.read(legs, FRAME) for legs in walk(math.radians(degrees), 12.0)]
    assert turned[0] == 0.0, "before a stride nobody turns"
    assert turned[-1] == pytest.approx(aside, abs=0.1)
    assert len(set(turned)) <= 7, "it changes once a stride"


def test_strikes_of_an_attempt_before_turn_nobody_and_only_whole_strides_count() -> None:
    steering, standing = HipSteering(), LegMotion(0.4, 0.0, -0.2, 0.0, 0.4, (7, 7))
    turned = [steering.read(standing._replace(strikes=(7 + n // 60, 7)), FRAME) for n in range(180)]
    assert turned[:120] == [0.0] * 120 and turned[120:] == [1.0] * 60


def test_without_steering_no_gust_moves_who_cannot_lean_and_with_it_the_hips_do() -> None:
    way = {"": SectionSpec(60.0, 200.0)}
    asides = {}
    for heading, further in (("path", 0.2), ("hips", 0.2), ("hips", -0.2)):
        spec = CanyonWalkSpec("person", "beam", width=3.0, calm=True, sections=way, heading=heading)  # type: ignore[arg-type]
        play = CanyonWalkPlay(spec, 1, Worn(further))  # type: ignore[arg-type]
        play.begin_trial("", 0)
        asides[heading, further] = played(play, 12.0).visual[PERSON].x  # type: ignore[attr-defined]
    assert asides["path", 0.2] == 0.0
    assert asides["hips", 0.2] > 0.2 and asides["hips", -0.2] < -0.2


def test_a_player_turns_by_the_hips_where_the_scene_says_so() -> None:
    yaws = []
    for further in (0.0, 0.1):
        worn = Worn(further)
        play = SoccerPlay(SoccerSpec("p", "b", heading="hips"), 1, advises=False, orthosis=worn)  # type: ignore[arg-type]
        yaws.append(played(play, 9.0).visual[PERSON].yaw)  # type: ignore[attr-defined]
    assert math.remainder(yaws[1] - yaws[0], 2.0 * math.pi) < -0.3, "to the right"
