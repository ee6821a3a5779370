"""What a calibration finds of simulated people, beside what their models are made of."""

from __future__ import annotations

import math

import numpy as np
import pytest

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.messages.calibration_record import DIRECTIONS
from mimics_app.rendering.haptic.devices.patients import PRESETS, Impairment, impairment_of, write_arm
from mimics_app.rendering.haptic.kernels import arm
from mimics_app.rendering.haptic.kernels.arm import step_arm
from mimics_app.rendering.haptic.kernels.noise import seed_noise
from mimics_app.tasks.kinds.calibration.grip_step import OPEN, GripStep
from mimics_app.tasks.kinds.calibration.kind import WalkingStep, Wish, wish_of
from mimics_app.tasks.kinds.calibration.question_step import HearingStep, ReadingStep
from mimics_app.tasks.kinds.calibration.range_step import RangeStep
from mimics_app.tasks.kinds.calibration.spec import CalibrationSpec
from mimics_app.tasks.kinds.calibration.step import Seen, Step
from mimics_app.world.components.robot import Patient

PEOPLE = 6
FRAME_S, TICKS = 1.0 / 50.0, 20
SPEC = CalibrationSpec("rest", "light", "letter", "eye", (0.30,) * 6)
SHOWN_S = FRAME_S
"""From the order of a picture to its display [s]."""
WITHIN = 0.05


@kernel
def _ticks(memory: Vec, handle: Vec, target: Vec, close: float) -> float:
    """A frame of a person on a handle of 3 kg; the grasp force at its end [N]."""
    grasp = 0.0
    for _ in range(TICKS):
        grasp = step_arm(memory, handle, True, 1.0, target, close, 1e-3)
        for i in range(3):
            handle[3 + i] += 1e-3 * (memory[arm.GRIP_FORCE + i] - 8.0 * handle[3 + i]) / 3.0
            handle[i] += 1e-3 * handle[3 + i]
    return grasp


def drawn(seed: int) -> Impairment:
    """A person between the presets, with a range of motion, a strength and senses of their own."""
    rng = np.random.default_rng([seed, 38])
    strength = float(rng.uniform(15.0, 80.0))
    return impairment_of(
        Patient(
            preset=rng.choice(list(PRESETS)),
            range_of_motion=tuple(float(each) for each in rng.uniform(0.08, 0.26, 6)),
            ease=float(rng.uniform(0.6, 0.9)),
            strength=strength,
            grasp=0.3 * strength,
            grasp_variation=float(rng.uniform(0.01, 0.05)) * strength,
            release=float(rng.uniform(0.4, 2.5)),
            hearing_left=float(rng.uniform(-70.0, -10.0)),
            hearing_right=float(rng.uniform(-70.0, -10.0)),
            letter=float(rng.uniform(7.0, 60.0)),
        )
    )


def pace_of(seed: int) -> float:
    """Comfortable speed of a person on the belt [m/s]."""
    return float(np.random.default_rng([seed, 39]).uniform(0.25, 1.6))


def walked(seed: int) -> float:
    """Speed that is found of a person who sets out at 0.4 m/s^2 and whose speed sways with each stride."""
    rng, step, now, belt, speed = np.random.default_rng([seed, 40]), WalkingStep(SPEC, ""), 0.0, 0.0, 0.0
    pace, sway, stride = pace_of(seed), float(rng.uniform(0.02, 0.12)), float(rng.uniform(0.5, 1.1))
    while not step.done:
        step.take(Seen(now, now + SHOWN_S, (0.0, 0.0, 0.0), 0.0, belt), FRAME_S)
        wanted = pace * (1.0 + sway * math.sin(2.0 * math.pi * stride * now) + 0.02 * float(rng.standard_normal()))
        speed += max(-0.4 * FRAME_S, min(0.4 * FRAME_S, wanted - speed))
        belt, now = belt + speed * FRAME_S, now + FRAME_S
    return step.measures[0].value


def measured(person: Impairment, seed: int) -> dict[str, float]:
    """Every measure of a person, from steps that are played one after the other."""
    steps: list[Step] = [
        RangeStep(SPEC),
        GripStep(SPEC, ""),
        HearingStep(SPEC, seed, 2, ""),
        ReadingStep(SPEC, seed, 3),
    ]
    memory, handle = np.zeros(arm.ARM_LENGTH), np.zeros(6)
    seed_noise(memory, arm.GENERATOR, seed)
    write_arm(memory, person, np.zeros((0, 3)), intent=True)
    now, grasp, found, wish = 0.0, 0.0, dict[str, float](), Wish()
    for step in steps:
        while not step.done:
            back, right, up = handle[:3].tolist()
            step.take(Seen(now, now + SHOWN_S, (right, up, back), grasp), FRAME_S)
            grasp = _ticks(memory, handle, np.array([wish.z, wish.x, wish.y]), 2.0 * wish.squeezes)
            wish = wish_of(step.cue, person.abilities, SPEC.answer)  # they see it a frame later
            now += FRAME_S
        assert not step.skipped
        found |= {each.name: each.value for each in step.measures}
    return found


def check(seed: int) -> None:
    person = drawn(seed)
    found = measured(person, seed)
    for direction, limit in zip(DIRECTIONS, person.range_of_motion, strict=True):
        assert found[f"reach_{direction}"] == pytest.approx(limit, rel=WITHIN), (seed, direction)
    comfortable = np.mean([found[f"ease_{direction}"] / person.ease for direction in DIRECTIONS])
    assert comfortable == pytest.approx(np.mean(person.range_of_motion), rel=WITHIN), seed
    assert found["grip"] == pytest.approx(person.strength, rel=WITHIN), seed
    assert found["release"] == pytest.approx(release_of(person), rel=WITHIN), seed
    # thresholds lie between two neighbours of the finest staircase: 1 dB, and 4 % of a height
    assert found["hearing_left"] == pytest.approx(person.hearing_left, abs=1.0), seed
    assert found["hearing_right"] == pytest.approx(person.hearing_right, abs=1.0), seed
    assert found["letter"] == pytest.approx(person.letter, rel=WITHIN), seed


@pytest.mark.parametrize("people", [PEOPLE, pytest.param(100, marks=pytest.mark.slow)])
def test_the_walking_speed_is_found_from_the_way_of_the_belt(people: int) -> None:
    worst = max(abs(walked(seed) / pace_of(seed) - 1.0) for seed in range(people))
    assert worst <= WITHIN


def release_of(person: Impairment) -> float:
    """Time until the minimum-jerk profile 10 u^3 - 15 u^4 + 6 u^5 of the opening hand is down to the share [s]."""
    roots = np.roots([6.0, -15.0, 10.0, 0.0, 0.0, -OPEN])
    (u,) = (root.real for root in roots if abs(root.imag) < 1e-9 and 0.0 < root.real < 1.0)
    return float((1.0 - u) * person.release)


@pytest.mark.parametrize("seed", range(PEOPLE))
def test_a_calibration_finds_what_a_person_is_made_of(seed: int) -> None:
    check(seed)


@pytest.mark.slow
def test_a_calibration_finds_what_a_hundred_people_are_made_of() -> None:
    for seed in range(PEOPLE, 100):
        check(seed)


def test_a_weaker_arm_is_not_taken_for_a_stronger_one() -> None:
    """The measures follow the model, one at a time."""
    one = drawn(3)
    other = impairment_of(
        Patient(preset="healthy", range_of_motion=tuple(0.5 * each for each in one.range_of_motion), strength=7.0)
    )
    found, again = measured(one, 3), measured(other, 3)
    assert again["reach_up"] == pytest.approx(0.5 * found["reach_up"], rel=0.1)
    assert again["grip"] < 0.6 * found["grip"] and math.isfinite(again["release"])
