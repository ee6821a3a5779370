"""The simulated HapticMaster: servo, delay, sensors, stops; and that nothing but its force sensor can move it."""

from __future__ import annotations

import math

import numpy as np
import pytest

from mimics_app.contracts.loop.controller_slots import Slot
from mimics_app.contracts.loop.haptic import SafetyState
from mimics_app.contracts.loop.loop_ports import (
    COMMAND_DQ,
    COMMAND_ENABLED,
    COMMAND_LENGTH,
    DATA_DQ,
    DATA_FORCE,
    DATA_LENGTH,
    DATA_Q,
    INBOX_LENGTH,
)
from mimics_app.rendering.haptic.devices.registry import build_device
from mimics_app.rendering.haptic.kernels import robot as place
from mimics_app.world.components.robot import Patient, Robot
from tests.support.haptic_bench import bench_of, patient_bench, pointer_bench


def _drive(robot: Robot, command, ticks: int, poke=lambda memory, k: None) -> np.ndarray:
    """True joints and data vectors of a robot under a joint velocity command(k)."""
    plugin = build_device(robot, seed=4)
    inbox, data, vector = np.zeros(INBOX_LENGTH), np.zeros(DATA_LENGTH), np.zeros(COMMAND_LENGTH)
    vector[COMMAND_ENABLED] = 1.0
    rows = []
    for k in range(ticks):
        poke(plugin.memory, k)
        plugin.read(plugin.memory, inbox, data, k)
        rows.append(np.concatenate([plugin.memory[place.Q : place.Q + 6], data]))
        vector[COMMAND_DQ : COMMAND_DQ + 3] = command(k)
        plugin.write(plugin.memory, vector, k)
    return np.array(rows)


FORCE = slice(6 + DATA_FORCE, 9 + DATA_FORCE)


@pytest.mark.parametrize("delay", [0, 1, 7])
def test_velocity_servo_is_a_first_order_lag_behind_the_delay(delay: int):
    """v(t) = v0 (1 - exp(-wp t)) from the tick at which the command leaves the delay line; too small to saturate."""
    rows = _drive(Robot(delay_ticks=delay, servo_bandwidth_hz=20.0), lambda k: (0.1, 0.05, -0.1), 60)
    t = np.maximum(0.0, np.arange(60) - delay) * 1e-3
    share = 1.0 - np.exp(-2.0 * math.pi * 20.0 * t)
    assert np.allclose(rows[:, 3:6], share[:, None] * [0.1, 0.05, -0.1], atol=1e-12)


def test_drive_force_limits_the_acceleration():
    robot = Robot(force_limit=20.0, masses=(4.0, 1.2, 5.0))
    rows = _drive(robot, lambda k: (1.0, 0.0, 1.0), 100)
    acceleration = np.diff(rows[:, 3:6], axis=0).max(axis=0) / 1e-3
    assert acceleration[0] == pytest.approx(20.0 / 4.0, rel=1e-9)
    assert acceleration[2] == pytest.approx(20.0 / 5.0, rel=1e-9)
    turning = _drive(robot, lambda k: (0.0, 1.0, 0.0), 50)
    assert np.diff(turning[:, 4]).max() / 1e-3 == pytest.approx(20.0 * 0.46 / 1.2, rel=1e-9)  # torque = force r


def test_joint_speed_is_limited():
    rows = _drive(Robot(velocity_limit=(0.3, 2.0, 1.0)), lambda k: (5.0, 0.0, 0.0), 300)
    assert rows[:, 3].max() == pytest.approx(0.3, rel=1e-3)
    assert rows[:, 3].max() <= 0.3


def test_mechanical_stops_hold_the_annular_workspace():
    rows = _drive(Robot(), lambda k: (-1.0, 2.0, 1.0), 2000)
    assert rows[-1, :3] == pytest.approx([-0.185, 0.505, 0.205], abs=1e-15) and np.all(rows[-1, 3:6] == 0.0)


def test_encoders_show_their_quantum():
    rows = _drive(Robot(), lambda k: (0.02, 0.0, 0.0), 400)
    steps = rows[:, 6 + DATA_Q] / 4e-6
    assert np.allclose(steps, np.round(steps), atol=1e-6)
    assert np.abs(rows[:, 6 + DATA_Q] - rows[:, 0]).max() <= 2e-6 + 1e-15
    settled = rows[200:, 6 + DATA_DQ]
    assert settled.mean() == pytest.approx(0.02, rel=0.01)


def test_force_sensor_noise_and_quantum():
    rows = _drive(Robot(sensor_noise=0.05, sensor_quantum=0.0), lambda k: (0.0, 0.0, 0.0), 5000)
    noise = rows[:, FORCE]
    assert noise.std() == pytest.approx(0.05, rel=0.05)  # 15 000 draws: 0.6 % standard error
    assert abs(noise.mean()) < 5 * 0.05 / math.sqrt(15000)
    coarse = _drive(Robot(sensor_noise=0.05, sensor_quantum=0.02), lambda k: (0.0, 0.0, 0.0), 500)[:, FORCE] / 0.02
    assert np.allclose(coarse, np.round(coarse), atol=1e-9)


def test_same_seed_same_noise():
    first = _drive(Robot(), lambda k: (0.1, 0.0, 0.0), 200)
    assert np.array_equal(first, _drive(Robot(), lambda k: (0.1, 0.0, 0.0), 200))


def test_patient_reaches_the_robot_only_through_the_force_sensor():
    """With the sensor cut off the same person, acting as before, does not move the robot by one encoder step.

    A high virtual damping lets the last of the drive to the start die away first (3 kg / 100 N s/m = 30 ms).
    """
    moved = []
    for gain in (1.0, 0.0):
        bench = patient_bench("severe")
        bench.advance(2200)
        plugin = bench.engine.plugin
        plugin.memory[place.SENSOR_GAIN] = gain
        plugin.memory[place.SENSOR_NOISE] = 0.0
        bench.publish(controller=Slot.PERSON, trial=1, tunnel__pieces=0, virtual_damping=100.0)
        bench.send(active=1, trial=1)
        bench.advance(600)
        start = plugin.memory[place.Q : place.Q + 3].copy()
        samples = bench.advance(4000)
        assert samples["state"][-1] == SafetyState.ACTIVE
        moved.append(float(np.abs(plugin.memory[place.Q : place.Q + 3] - start).max()))
    assert moved[0] > 0.01
    assert moved[1] < 1e-6


def test_robot_given_way_feels_like_the_virtual_mass():
    """A constant pull of a free hand: the handle accelerates like 3 kg behind the servo and the delay."""
    bench = pointer_bench(straight=None)
    bench.publish(virtual_damping=0.0)
    bench.advance(200)
    bench.engine.plugin.memory[place.ROBOT_LENGTH + 13] = 6.0  # hand limit [N]
    bench.send(target_world=(0.0, 10.0, 0.0), active=1)
    samples = bench.advance(200)
    v = samples["v_world"][:, 1]
    assert (v[190] - v[90]) / 0.1 == pytest.approx(6.0 / 3.0, rel=0.01)


def test_no_person_no_motion():
    bench = bench_of(build_device(Robot(sensor_noise=0.0)), straight=None)
    samples = bench.advance(2000)
    assert np.all(samples["hip_world"] == 0.0) and samples["state"][-1] == SafetyState.ACTIVE


def test_drive_to_the_start_is_slow_and_does_not_overshoot():
    bench = patient_bench()
    samples = bench.advance(2500)
    goal = samples["hip_world"][-1]
    gap = np.linalg.norm(samples["hip_world"] - goal, axis=1)
    assert np.linalg.norm(samples["v_world"], axis=1).max() < 0.31
    assert gap[0] > 0.15 and np.all(np.diff(gap) < 1e-4)
    assert samples["state"][-1] == SafetyState.READY and np.all(samples["f_user_world"] == 0.0)


def test_intent_off_never_completes():
    bench = patient_bench(intent=False)
    bench.advance(2200)
    bench.publish(controller=Slot.PERSON, trial=1)
    bench.send(active=1, trial=1)
    bench.engine.advance(20_000)
    assert bench.engine.snapshot().progress < 0.05
    assert Patient(preset="healthy").intent
