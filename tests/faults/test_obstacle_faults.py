"""Faults of the device in a session that passes the obstacle sequence: whatever fails, both legs end on the brakes."""

from __future__ import annotations

import math

import numpy as np
import pytest

from mimics_app.app.scenes.loading import check_scene, read_scene
from mimics_app.contracts.commands.command_records import CommandSource
from mimics_app.contracts.loop.device_faults import FAULT_NAMES
from mimics_app.contracts.loop.gait_state import GaitState
from mimics_app.contracts.loop.haptic import SafetyState, TripCause
from mimics_app.contracts.shared_memory.shared_words import STOP_STRIDE
from mimics_app.contracts.system.resources import root
from mimics_app.rendering.haptic.devices.simulated_lokomat import PLANT
from mimics_app.rendering.haptic.kernels.lokomat import linear_drive, orthosis
from mimics_app.world.components.robot import Controller
from tests.support.core_play import CorePlay, change_component

SCENE = root() / "scenes" / "examples" / "lokomat_obstacle.json"
STEPS = tuple(GaitState)[:9]
FAULTS = FAULT_NAMES[1:]
SEEDS = 200
FRAMES = 60


STOPPED = (SafetyState.SAFE_STOP, SafetyState.E_STOP)


def _until(play: CorePlay, state: GaitState, seconds: float, safety: tuple[SafetyState, ...]) -> bool:
    """Play until a gait state of a loop in one of these states; whether it came."""
    for _ in range(round(seconds * FRAMES)):
        now = play.frames.snapshot
        if now is not None and now.gait_state == state and now.state in safety:
            return True
        play.step()
    return False


def _ends_standing(seed: int, step: GaitState, fault: str) -> TripCause:
    """Play a session up to a step, let the device fail there, and look at both legs; why the loop stopped itself.

    A fault that nobody can notice, such as a stuck encoder of a leg that is at rest, is followed by the person's STOP.
    """
    scene = check_scene(read_scene(SCENE))
    controller = scene.first(Controller)
    assert controller is not None
    change_component(
        scene, "controller", parameters=dict(controller.parameters) | {"exploration": 1.0, "obstacle_after": 0.3}
    )
    play = CorePlay.of(scene, seed)
    try:
        assert _until(play, step, 40.0, (SafetyState.ACTIVE,)), f"{step.name} did not come"
        for _ in range(1 + seed % 7):
            play.step()
        play.core.haptics.inject(fault)
        noticed = _until(play, GaitState.STANDING, 3.0, STOPPED)
        if not noticed:
            play.core.memory.stop_words[STOP_STRIDE * CommandSource.PYTHON] += 1
            assert _until(play, GaitState.STANDING, 0.5, STOPPED)
        play.step()
        _assert_held(play)
        assert play.frames.snapshot is not None and play.frames.snapshot.gait_state == GaitState.STANDING
        return TripCause(play.frames.snapshot.cause) if noticed else TripCause.NONE
    finally:
        play.core.stop()


def _assert_held(play: CorePlay) -> None:
    """Both legs are on their brakes, without current, and move by less than a degree in half a second."""
    plant = play.core.haptics.plugin.memory[PLANT]
    before = _joints(plant)
    for _ in range(FRAMES // 2):
        play.step()
    assert play.frames.snapshot is not None and play.frames.snapshot.state in STOPPED
    for number in range(2):
        leg = orthosis.leg_of(plant, number)
        for joint in range(2):
            drive = leg[orthosis.DRIVES + joint * linear_drive.DRIVE :]
            assert drive[linear_drive.BRAKED] == 1.0 and drive[linear_drive.CURRENT] == 0.0
    assert np.abs(_joints(plant) - before).max() < math.radians(1.0)


def _joints(plant: np.ndarray) -> np.ndarray:
    """True angles of both legs [rad]."""
    return np.concatenate([orthosis.state_of(plant, number)[:2] for number in range(2)]).copy()


@pytest.mark.parametrize(
    ("step", "fault", "cause"),
    [
        (GaitState.WALKING, "encoder_not_finite:left knee", TripCause.NOT_FINITE),
        (GaitState.EXPLORING, "silent", TripCause.STALE_DEVICE),
        (GaitState.WALKING, "deaf", TripCause.DEVICE_FAULT),
        (GaitState.WALKING, "encoder_stuck:left knee", TripCause.NOT_FOLLOWING),
        (GaitState.EXPLORING, "encoder_stuck:left hip", TripCause.NOT_FOLLOWING),
        (GaitState.COLLISION_ENABLED, "encoder_stuck:right knee", TripCause.NONE),
        (GaitState.EXPLORING, "sensor_dead:right hip", TripCause.SENSOR),
        (GaitState.COLLISION_ENABLED, "sensor_stuck:left knee", TripCause.SENSOR),
    ],
)
def test_a_fault_in_the_sequence_ends_in_standing(step: GaitState, fault: str, cause: TripCause) -> None:
    assert _ends_standing(1, step, fault) is cause


@pytest.mark.parametrize("fault", ["silent", "encoder_stuck"])
def test_a_fault_before_the_walk_has_begun_ends_on_the_brakes(fault: str) -> None:
    """The robot still drives the legs to their start: no gait state, and the stop holds them alike."""
    play = CorePlay.of(check_scene(read_scene(SCENE)), 3)
    try:
        for _ in range(20):
            play.step()
        play.core.haptics.inject(fault)
        for _ in range(FRAMES):
            play.step()
        play.core.memory.stop_words[STOP_STRIDE * CommandSource.PYTHON] += 1
        for _ in range(FRAMES // 2):
            play.step()
        _assert_held(play)
    finally:
        play.core.stop()


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(SEEDS))
def test_every_fault_at_every_step_ends_in_standing(seed: int) -> None:
    """200 sessions: each of the faults at each of the nine steps at least once."""
    number = seed % (len(STEPS) * len(FAULTS))
    _ends_standing(seed, STEPS[number % len(STEPS)], FAULTS[number // len(STEPS)])
