"""A mouse through the virtual coupling: smooth 1 kHz forces from 60 Hz steps, and the figures a person can check."""

from __future__ import annotations

import numpy as np
import pytest

from mimics_app.contracts.clock import ticks_until_frame
from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.loop.haptic import SafetyState
from mimics_app.rendering.haptic.devices.pointer import (
    COUPLING_FORCE,
    COUPLING_LENGTH,
    COUPLING_LIMIT,
    COUPLING_STIFFNESS,
    FOLLOW_RATE,
    step_coupling,
)
from mimics_app.rendering.haptic.devices.registry import build_device
from mimics_app.world.components.robot import Robot
from tests.support.haptic_bench import Bench, pointer_bench

HAND_FORCE = 15.0
STIFFNESS = 2000.0


def _frames(bench: Bench, target, frames: int) -> np.ndarray:
    """Send a target 60 times a second and return the samples."""
    rows = []
    for f in range(frames):
        bench.send(target_world=target(f), active=1, grasp=20.0)
        rows.append(bench.advance(ticks_until_frame(f + 1) - ticks_until_frame(f)))
    return np.concatenate(rows)


def test_the_filter_of_the_cursor_is_critically_damped():
    """After a step the followed position is that of x'' = w^2 (target - x) - 2 w x': the fastest without overshoot."""
    memory, handle, target = np.zeros(COUPLING_LENGTH), np.zeros(6), np.array([0.01, 0.0, 0.0])
    memory[FOLLOW_RATE], memory[COUPLING_STIFFNESS], memory[COUPLING_LIMIT] = 60.0, 1.0, 1e9
    dt, count = 1e-5, 20_000
    followed = np.empty(count)
    for k in range(count):
        step_coupling(memory, handle, target, True, dt)
        followed[k] = memory[COUPLING_FORCE]  # 1 N/m, and a handle at rest: the position
    w_t = 60.0 * dt * np.arange(1, count + 1)
    np.testing.assert_allclose(followed, target[0] * (1.0 - (1.0 + w_t) * np.exp(-w_t)), atol=1e-5 * target[0] * 60.0)
    assert followed.max() <= target[0]


@pytest.fixture
def held() -> Bench:
    """Pointer held in the middle of a straight tunnel of 40 mm, soft start over, ball at its smallest."""
    bench = pointer_bench()
    _frames(bench, lambda f: (0.0, 0.0, 0.0), 60)
    assert bench.engine.snapshot().ramp == 1.0
    return bench


@pytest.mark.parametrize("side", [(0.0, 1.0, 0.0), (0.0, -0.6, 0.8), (0.0, 0.0, -1.0)])
def test_mouse_30_mm_beyond_the_wall_and_back(held: Bench, side: tuple[float, float, float]):
    limit = 0.04 - held.engine.snapshot().ball_radius
    out = np.array(side)
    _frames(held, lambda f: out * (limit + 0.03), 60)
    pressed = held.engine.snapshot()
    beyond = float(np.linalg.norm(pressed.hip_world)) - limit
    assert 0.0 < beyond <= HAND_FORCE / STIFFNESS + 1e-3
    assert np.linalg.norm(pressed.f_user_world) == pytest.approx(HAND_FORCE, rel=0.05)
    back = out * (limit - 0.01)
    samples = _frames(held, lambda f: back, 30)  # 0.5 s
    released = held.engine.snapshot()
    assert np.linalg.norm(released.hip_world - back) < 2e-3
    assert np.all(samples["f_user_world"][-100:] == 0.0)
    assert released.state == SafetyState.ACTIVE


def test_wall_is_steady_under_a_held_mouse(held: Bench):
    """No limit cycle: after a second of pressing the ball stays within the sensor's and encoder's noise."""
    limit = 0.04 - held.engine.snapshot().ball_radius
    samples = _frames(held, lambda f: (0.0, limit + 0.03, 0.0), 180)
    assert np.ptp(samples["hip_world"][-500:, 1]) < 50e-6


def test_60_hz_steps_become_smooth_forces(held: Bench):
    """A mouse at 0.3 m/s jumps 5 mm a frame; without the hand that is a step of 800 N/m x 5 mm = 4 N."""
    target = [0.05 * np.sin(2 * np.pi * f / 60.0) for f in range(240)]
    jumps = np.abs(np.diff(target)).max()
    assert jumps > 5e-3
    samples = _frames(held, lambda f: (target[f], 0.0, 0.0), 240)
    change = np.linalg.norm(np.diff(samples["f_meas"], axis=0), axis=1)
    assert change.max() < 1.0
    assert np.abs(samples["f_user_world"]).max() < 2.5  # drag of 2 N s/m and the pipe's axis: no wall
    follow = samples["hip_world"][2000:, 0]
    assert np.ptp(follow) > 0.08


def test_pointer_let_go_leaves_no_force(held: Bench):
    held.send(target_world=(0.05, 0.0, 0.0), active=1, grasp=20.0)
    held.advance(100)
    held.send(active=0, grasp=0.0)
    samples = held.advance(3000)
    assert np.abs(samples["f_meas"][5:]).max() < 0.1  # sensor noise only
    assert np.linalg.norm(samples["v_world"][-1]) < 0.01
    assert held.engine.snapshot().ball_radius == pytest.approx(0.03, abs=1e-6)


def test_settings_of_the_hand_are_checked():
    with pytest.raises(DeviceError, match='did you mean "hand_force"'):
        build_device(Robot(device="pointer", settings={"hand_forse": 3.0}))
    with pytest.raises(DeviceError, match="positive"):
        build_device(Robot(device="pointer", settings={"hand_force": -3.0}))
