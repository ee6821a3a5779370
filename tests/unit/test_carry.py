"""What a task counts of something that is carried: taken, lost, set down, gone; and where it falls from."""

from __future__ import annotations

import pytest
from msgspec.structs import replace

from mimics_app.contracts.messages.orders import HapticField
from mimics_app.tasks.kinds.carry.carried import Carried, Stage
from mimics_app.tasks.kinds.carry.spec import BoxSpec, CarrySpec, GripSpec
from mimics_app.tasks.observation import Observation, observe
from tests.support.task_play import make_events, make_snapshot

MARK = (0.1, 0.2, 0.0)
SPEC = CarrySpec(
    body="apple",
    to="mark",
    within=0.03,
    height=0.05,
    falls_from=BoxSpec(low=(-0.1, 0.2, -0.05), high=(0.0, 0.3, 0.05)),
    lost_outside=BoxSpec(low=(-0.2, -0.1, -0.2), high=(0.2, 1.0, 0.2)),
    grip=GripSpec(least=3.0, most=12.0),
)


def frame(place=(-0.05, 0.03, 0.0), held=False, t=0.0, grasp=0.0, hand=(0.0, 0.3, 0.0)) -> Observation:
    seen = observe(make_snapshot(round(t * 1e9), grasp=grasp), make_events(), round(t * 1e9))
    return replace(seen, bodies={"apple": place}, held="apple" if held else "", hip_world=hand)


def started(seed: int = 1) -> Carried:
    carry = Carried(SPEC, MARK, seed)
    carry.begin_attempt()
    return carry


def test_a_drop_on_the_way_counts_and_letting_go_at_the_mark_does_not():
    carry = started()
    assert carry.see(frame(held=True)).gripped
    lost = carry.see(frame((0.0, 0.25, 0.0)))
    assert lost.dropped and lost.drops == 1 and not lost.placed
    assert carry.see(frame(held=True)).drops == 1
    down = carry.see(frame((0.11, 0.232, 0.0)))
    assert down.placed and not down.dropped and down.drops == 1


@pytest.mark.parametrize(
    ("place", "held", "placed"),
    [
        ((0.1, 0.232, 0.0), False, True),
        ((0.1, 0.232, 0.0), True, False),  # still in the hand
        ((0.1299, 0.232, 0.0), False, True),
        ((0.1301, 0.232, 0.0), False, False),
        ((0.1, 0.26, 0.0), False, False),  # above the height
        ((0.1, 0.19, 0.0), False, False),  # below the surface: beside the table
    ],
)
def test_placed_is_within_the_mark_on_its_surface_and_let_go(place, held, placed):
    carry = started()
    assert carry.see(frame(place, held)).placed == placed


def test_pressed_too_hard_it_is_bruised_once_a_grip():
    carry = started()
    marks = [carry.see(replace(frame(held=True), crushed=name)).bruises for name in ("", "apple", "apple", "", "apple")]
    assert marks == [0, 1, 1, 1, 2]


def test_a_smaller_mark_is_stricter():
    carry = started()
    carry.within = 0.01
    assert not carry.see(frame((0.115, 0.232, 0.0))).placed


def test_it_falls_from_random_places_of_the_box_that_repeat_with_the_seed():
    places = []
    for seed in (1, 1, 2):
        carry = Carried(SPEC, MARK, seed)
        drawn = []
        for _ in range(50):
            carry.begin_attempt()
            drawn.append(carry.orders[HapticField("position", "bodies", "apple")])
        places.append(drawn)
    assert places[0] == places[1] != places[2]
    assert len(set(places[0])) == 50
    box = SPEC.falls_from
    assert box is not None
    assert all(low <= x <= high for place in places[0] for low, x, high in zip(box.low, place, box.high, strict=True))


def test_every_fall_is_a_new_spawn_beyond_the_scenes_own():
    carry = Carried(SPEC, MARK, 1)
    assert carry.orders == {}
    spawns = []
    for _ in range(3):
        carry.begin_attempt()
        spawns.append(carry.orders[HapticField("spawn", "bodies", "apple")])
    assert spawns == [2, 3, 4]


def test_out_of_reach_for_two_seconds_it_falls_again():
    carry = started()
    away = (0.5, 0.03, 0.0)
    carry.see(frame(away, t=0.0))
    carry.see(frame(away, t=1.9))
    assert carry.orders[HapticField("spawn", "bodies", "apple")] == 2
    carry.see(frame(away, t=2.1))
    assert carry.orders[HapticField("spawn", "bodies", "apple")] == 3
    carry.see(frame(away, held=True, t=2.2))
    carry.see(frame(away, held=True, t=9.0))
    assert carry.orders[HapticField("spawn", "bodies", "apple")] == 3, "what is in the hand is not lost"


def test_where_no_hand_reaches_it_falls_again():
    gap = BoxSpec(low=(0.02, -0.1, -0.2), high=(0.08, 0.09, 0.2))
    carry = Carried(replace(SPEC, lost_inside=gap), MARK, 1)
    carry.begin_attempt()
    for place, falls in (((0.0, 0.03, 0.0), 2), ((0.05, 0.15, 0.0), 2), ((0.05, 0.03, 0.0), 3)):
        carry.see(frame(place, t=0.0))
        carry.see(frame(place, t=2.1))
        assert carry.orders[HapticField("spawn", "bodies", "apple")] == falls


def test_progress_rises_from_reaching_through_carrying_to_the_mark():
    carry = started()
    far = carry.see(frame(hand=(0.1, 0.3, 0.0))).progress
    near = carry.see(frame(hand=(-0.05, 0.04, 0.0))).progress
    taken = carry.see(frame(held=True)).progress
    half = carry.see(frame((0.025, 0.25, 0.0), held=True)).progress
    there = carry.see(frame((0.1, 0.232, 0.0), held=True)).progress
    assert far == 0.0 < near < taken + 1e-9 <= 0.3 + 1e-9 < half < there == 1.0
    assert half == pytest.approx(0.65)


def test_grasp_error_is_the_distance_from_the_right_band_while_held():
    carry = started()
    for grasp, error in ((2.0, 1.0), (3.0, 0.0), (12.0, 0.0), (15.0, 3.0)):
        assert carry.see(frame(held=True, grasp=grasp)).grasp_error == pytest.approx(error)
    assert carry.see(frame(held=False, grasp=30.0)).grasp_error == 0.0


def test_distance_is_off_the_straight_way_seen_from_above():
    carry = started()
    carry.see(frame((-0.1, 0.03, 0.0), held=True))
    assert carry.see(frame((0.0, 0.3, 0.04), held=True)).distance == pytest.approx(0.04)
    assert carry.see(frame((0.13, 0.3, 0.04), held=True)).distance == pytest.approx(0.05), "beyond the mark: to it"
    assert carry.see(frame((0.0, 0.3, 0.04))).distance is None, "a hand without it is on no way"


def test_stages_say_what_to_do_next():
    carry = started()
    assert carry.see(frame()).stage == Stage.REACH
    assert carry.see(frame(hand=(-0.05, 0.035, 0.0))).stage == Stage.CLOSE
    assert carry.see(frame(held=True)).stage == Stage.CARRY
    assert carry.see(frame((0.1, 0.232, 0.0), held=True)).stage == Stage.OPEN
    assert carry.see(frame((0.1, 0.232, 0.0), hand=(0.1, 0.232, 0.0))).stage == Stage.OPEN  # let go, and to stay so
