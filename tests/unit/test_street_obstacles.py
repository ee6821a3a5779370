"""Obstacles of the city walk: called in time, at the foot where they are felt, told once a touch, open afterwards."""

from __future__ import annotations

import pytest
from msgspec import structs

from mimics_app.contracts.loop.gait_state import GaitState
from mimics_app.rendering.haptic.controllers.orthosis_legs import StreetObject
from mimics_app.rendering.haptic.controllers.parameter_vector import parameter_vector
from mimics_app.rendering.haptic.controllers.registry import find_controller
from mimics_app.tasks.kinds.city_walk.kind import OPENED, CityWalkPlay, CityWalkSpec
from mimics_app.tasks.kinds.city_walk.street_obstacles import MATERIALS, StreetObstacle, StreetObstacles
from mimics_app.tasks.observation import Observation, observe
from tests.support.task_play import make_events, make_snapshot

FRAME = 1.0 / 60.0
BOX, DOOR = StreetObstacle("b", "box", 5.0), StreetObstacle("d", "door", 12.0, "right")


def _seen(state: GaitState, left: float = 0.14, right: float = 0.14) -> Observation:
    seen = observe(make_snapshot(gait_state=int(state)), make_events(), 0)
    feet = tuple(structs.replace(seen.points[0], hip_world=(x, 0.1, 0.0), speed=0.2) for x in (left, right))
    return structs.replace(seen, points=feet)


def test_an_obstacle_is_called_once_the_person_is_near_and_walks() -> None:
    obstacles = StreetObstacles((DOOR, BOX))
    assert obstacles.call(2.0, _seen(GaitState.WALKING)) == ""
    assert obstacles.call(4.5, _seen(GaitState.TO_START)) == ""
    assert obstacles.call(4.5, _seen(GaitState.WALKING)) == "box left"


def test_the_person_is_led_to_where_the_felt_face_is_and_touches_are_told_once() -> None:
    obstacles, taps = StreetObstacles((BOX,)), 0
    walked = 4.3
    obstacles.call(walked, _seen(GaitState.WALKING))
    for state in (GaitState.STOPPING, GaitState.COLLISION_ENABLED):
        for _ in range(120):
            obstacles.step(walked + obstacles.led, _seen(state), FRAME)
    assert walked + obstacles.led == pytest.approx(5.0 - 0.34, abs=2e-3)
    for x in (0.2, 0.257, 0.262, 0.255, 0.25, 0.2, 0.26):
        taps += obstacles.step(walked + obstacles.led, _seen(GaitState.EXPLORING, left=x), FRAME) is not None
    assert taps == 2, "a foot that stays near the face touches it once"
    assert obstacles.explored == 1
    assert obstacles.step(5.0, _seen(GaitState.RESUMING), FRAME) is None and obstacles.ahead is None
    for _ in range(60):
        obstacles.step(5.0, _seen(GaitState.WALKING), FRAME)
    assert obstacles.opened == (1.0,)


def test_nobody_is_led_before_an_obstacle_is_called() -> None:
    obstacles = StreetObstacles((BOX,))
    for state in GaitState:
        obstacles.step(0.0, _seen(state), FRAME)
    assert obstacles.led == 0.0


def test_every_kind_is_an_obstacle_of_the_controller_and_has_a_sound() -> None:
    controller = find_controller("lokomat_impedance")
    names = controller.obstacles(parameter_vector(controller, {"object_kind": 5, "sequence": 1}))
    kinds = [each.name.lower() for each in StreetObject]
    assert sorted(MATERIALS) == sorted(kinds)
    assert set(names) == {kind + leg for kind in kinds for leg in ("", " left", " right")}


def test_by_hand_the_way_opens_after_three_touches_or_the_time_of_an_exploration() -> None:
    for kicks, most in ((True, 3.0), (False, 9.5)):
        obstacles, taps, seconds = StreetObstacles((BOX, DOOR)), 0, 0.0
        assert not obstacles.stops(4.5) and obstacles.meet(4.5, True, FRAME) is None, "too far"
        asked = []
        while obstacles.stops(4.7):
            asked.append(obstacles.touches_left(4.7))
            tap = obstacles.meet(4.7, kicks, FRAME)
            taps += tap is not None and tap.obstacle is BOX
            seconds += FRAME
        assert (taps, obstacles.explored) == ((3, 1) if kicks else (0, 0))
        assert asked[0] == 3 and asked[-50:] == [0] * 50, "the next one is not asked for while the way opens"
        assert sorted(asked, reverse=True) == asked and obstacles.touches_left(4.5) == 0
        assert most - 2.0 < seconds <= most
        assert obstacles.opened == (1.0, 0.0) and obstacles.ahead is DOOR
        assert not obstacles.stops(8.0) and obstacles.stops(11.65)


@pytest.mark.parametrize(
    ("rate", "there"), [(0.0, []), (0.25, [3]), (0.5, [1, 3]), (0.75, [1, 2, 3]), (1.0, [0, 1, 2, 3])]
)
def test_a_lower_rate_leaves_some_out_evenly_and_their_way_is_open(rate: float, there: list[int]) -> None:
    four = [StreetObstacle(str(k), "box", 5.0 + 10.0 * k) for k in range(4)]
    obstacles = StreetObstacles(four, rate)
    assert [k for k, share in enumerate(obstacles.opened) if share == 0.0] == there
    assert (obstacles.ahead is None) == (not there)
    assert (obstacles.within(30.0), obstacles.within(99.0)) == (sum(k <= 2 for k in there), len(there))


def test_the_rate_is_that_of_the_next_walk_and_what_is_left_out_costs_nothing() -> None:
    spec = CityWalkSpec("person", obstacles=(BOX, DOOR))
    play = CityWalkPlay(spec, 100.0)
    play.begin_trial("", 0)
    seen = _seen(GaitState.WALKING)
    for rate, left in ((1.0, (0.0, 0.0)), (0.5, (1.0, 0.0)), (0.0, (1.0, 1.0))):
        play.see(seen, {"obstacle_rate": rate})
        assert play.visual[OPENED] == left
    assert play.measures["obstacles_met"] is None, "it counts in no score"
    play.see(seen, {"obstacle_rate": 1.0})
    assert play.measures["obstacles_met"] == 0.0
    play.start_attempt(seen)
    play.travel(seen, FRAME)
    play.see(seen, {"obstacle_rate": 0.0})
    assert play.visual[OPENED] == (0.0, 0.0), "whoever is on the way meets what was there"
