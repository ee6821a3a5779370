"""Footfalls found from angles alone, against the phase of the curves that the angles were made of."""

from __future__ import annotations

import random

import pytest

from mimics_app.contracts.messages.leg_motion import LegMotion
from mimics_app.contracts.ports.scenario_port import TaskContext
from mimics_app.tasks.walking.footfalls import Footfalls
from mimics_app.tasks.walking.legs import GAITS, Legs, natural_step
from mimics_app.tasks.walking.walker import Walker
from mimics_app.tasks.walking.worn_orthosis import OrthosisLegs, legs_in

FRAME = 1.0 / 60.0


def _walked(gait: str, speed: float, seconds: float = 20.0) -> Walker:
    walker = Walker(GAITS[gait], 1)
    for _ in range(round(seconds / FRAME)):
        walker.step(speed, 0.0, FRAME)
    return walker


@pytest.mark.parametrize("speed", [0.5, 0.9, 1.3])
def test_a_heel_strike_is_found_when_the_curves_have_it(speed: float) -> None:
    legs, falls, late = Legs(GAITS["healthy"]), Footfalls(), []
    for number in range(60 * 12):
        for fall in falls.watch(legs.step(speed, FRAME), FRAME):
            if number > 240:
                off = (legs.phase - (0.0 if fall.side == "left" else 0.5) + 0.5) % 1.0 - 0.5
                late.append(off * 2.0 * natural_step(speed) / speed)
    assert len(late) > 8
    assert max(abs(each) for each in late) <= 0.020 + FRAME, "20 ms, and the frame in which it is seen"


def test_noisy_legs_on_a_stopped_belt_take_no_step() -> None:
    falls, rng = Footfalls(), random.Random(2)
    for _ in range(60 * 60):
        assert not falls.watch(LegMotion(*(0.2 + rng.gauss(0.0, 0.01) for _ in range(4)), 0.0), FRAME)


def test_the_phase_follows_the_legs_and_the_steps_add_up_to_the_way() -> None:
    walker = _walked("healthy", 1.3)
    assert walker.footfalls.symmetry == pytest.approx(1.0, abs=0.01)
    steps = walker.footfalls.count
    assert walker.walked / steps == pytest.approx(natural_step(1.3), rel=0.06)
    assert walker.footfalls.step_at(1.3) == pytest.approx(natural_step(1.3), rel=0.05)
    assert walker.z == pytest.approx(walker.walked) and walker.x == 0.0


def test_impaired_legs_step_unevenly_lift_less_and_step_shorter() -> None:
    found = [_walked(gait, 1.3).footfalls for gait in ("healthy", "hemiparetic", "severe")]
    for measure in ("symmetry", "clearance", "step_length"):
        values = [getattr(each, measure) for each in found]
        assert values == sorted(values, reverse=True), measure
        assert values[0] > 1.1 * values[1] > 1.1 * values[2], measure


def test_who_stands_takes_no_step() -> None:
    assert _walked("healthy", 0.0).footfalls.count == 0


def test_a_walker_goes_where_it_heads() -> None:
    walker = Walker(GAITS["healthy"], 1)
    walker.put(2.0, 3.0, 1.5707963)
    for _ in range(300):
        walker.step(1.0, 0.0, FRAME)
    assert walker.x == pytest.approx(2.0 + walker.walked) and walker.z == pytest.approx(3.0, abs=1e-5)


@pytest.mark.parametrize("speed", [0.5, 0.9, 1.3])
def test_the_joints_of_an_orthosis_say_how_fast_its_belt_is(speed: float) -> None:
    """The curves at a speed, given as joints only: the way is the belt's within 12 %, all steps are counted."""
    legs, orthosis = Legs(GAITS["healthy"]), OrthosisLegs()
    walker, way, steps = Walker(GAITS["healthy"], 1), 0.0, 0
    for number in range(60 * 14):
        given = legs.step(speed, FRAME)
        if number == 240:
            walker.begin()
        walker.step_by_legs(orthosis.read(given[:4], (-1, -1), FRAME), 0.0, FRAME)
        way += speed * FRAME if number >= 240 else 0.0
        steps = walker.footfalls.count
    assert walker.walked == pytest.approx(way, rel=0.12)
    assert steps == pytest.approx(way / natural_step(speed), abs=2)


def test_only_a_gait_orthosis_walks_by_its_joints() -> None:
    assert legs_in(TaskContext((0.0,) * 4, limb="left foot")) is not None
    assert legs_in(TaskContext((0.0,) * 3)) is None
