"""The plan of a person who picks and places: steps follow what is seen, and a loss begins it again."""

from __future__ import annotations

import pytest

from mimics_app.scenarios.parts.pick_plan import Percept, Picker

MARK, HALF = (0.14, 0.16, -0.04), 0.03
APPLE = (-0.08, 0.03, 0.05)


class Person:
    """Does at once what the plan says; the thing goes with the hand while it is held."""

    def __init__(self, within: float = 0.03) -> None:
        self.picker = Picker(MARK, HALF, within)
        self.time, self.hand, self.thing, self.held = 0.0, (0.0, 0.25, 0.0), APPLE, False
        self.heights: list[float] = []

    def step(self) -> None:
        aim = self.picker.aim(Percept(self.time, self.hand, self.thing, self.held))
        self.time += 0.1
        step = [t - h for t, h in zip(aim.target_world, self.hand, strict=True)]
        size = max(1e-9, sum(s * s for s in step) ** 0.5)
        share = min(1.0, 0.03 / size)
        self.hand = tuple(h + share * s for h, s in zip(self.hand, step, strict=True))  # type: ignore[assignment]
        near = sum((a - b) ** 2 for a, b in zip(self.hand, self.thing, strict=True)) ** 0.5 < 0.015
        self.held = aim.close and (self.held or near)
        if self.held:
            self.thing = (self.hand[0], max(self.hand[1], HALF), self.hand[2])
        self.heights.append(self.hand[1])

    def placed(self) -> bool:
        level = ((self.thing[0] - MARK[0]) ** 2 + (self.thing[2] - MARK[2]) ** 2) ** 0.5
        return not self.held and level < 0.03 and abs(self.thing[1] - MARK[1] - HALF) < 0.006


def run(person: Person, steps: int = 200) -> int:
    for count in range(steps):
        person.step()
        if person.placed():
            return count
    raise AssertionError("never placed")


def test_it_is_taken_from_above_lifted_over_and_set_down():
    person = Person()
    run(person)
    assert min(person.heights) == pytest.approx(APPLE[1], abs=0.012)
    assert max(person.heights) > MARK[1] + HALF + 0.03, "carried above the table's edge"
    aim = person.picker.aim(Percept(person.time, person.hand, person.thing, False))
    assert not aim.close and aim.target_world[1] > MARK[1] + HALF


def test_what_is_lost_on_the_way_is_taken_again():
    person = Person()
    while not (person.held and person.hand[1] > 0.15):
        person.step()
    person.held, person.thing = False, (0.0, 0.03, 0.02)
    person.step()
    assert not person.picker.aim(Percept(person.time, person.hand, person.thing, False)).close, (
        "opens before it goes back"
    )
    run(person)


def test_a_hand_that_holds_nothing_gives_up_and_opens():
    person = Person()
    closes = []
    for _ in range(120):
        person.step()
        person.held = False
        aim = person.picker.aim(Percept(person.time, person.hand, person.thing, False))
        closes.append(aim.close)
    assert True in closes
    first = closes.index(True)
    assert False in closes[first:], "it must not squeeze the air for ever"


def test_it_rises_before_it_crosses_over():
    picker = Picker(MARK, HALF, 0.03)
    aim = picker.aim(Percept(0.0, (0.15, 0.03, 0.1), APPLE, False))
    assert aim.target_world[0] == 0.15 and aim.target_world[2] == 0.1 and aim.target_world[1] > 0.12


def test_after_the_set_down_it_waits_above_until_the_thing_falls_anew():
    person = Person()
    run(person)
    for _ in range(30):
        person.step()
    assert person.hand[1] > MARK[1] + HALF + 0.03 and not person.held
    person.thing = APPLE
    person.step()
    run(person)
