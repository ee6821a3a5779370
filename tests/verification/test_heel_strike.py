"""Heel strikes found in noisy legs at 1 kHz, against the true state of the simulated orthosis and its people.

The truth is what the plant knows and no sensor shows: the tick in which the true velocity of the ankle ahead of the hip
turns from forwards to backwards. The detector sees the measured angles with white noise of a milliradian on each joint.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.loop.loop_ports import (
    COMMAND_ENABLED,
    COMMAND_LENGTH,
    COMMAND_TORQUE,
    DATA_DQ,
    DATA_LENGTH,
    DATA_Q,
    INBOX_ACTIVE,
    INBOX_LENGTH,
)
from mimics_app.maths.gait_series import knee_series, natural_cadence, series_at, step_of, thigh_series
from mimics_app.rendering.haptic.control.lokomat.heel_strike import HEEL_STRIKE, watch_heel
from mimics_app.rendering.haptic.descriptors.lokomat import LOKOMAT
from mimics_app.rendering.haptic.devices.gait_people import PERSONS
from mimics_app.rendering.haptic.devices.registry import build_device
from mimics_app.rendering.haptic.devices.simulated_lokomat import PLANT, read_lokomat, write_lokomat
from mimics_app.rendering.haptic.kernels.leg_kinematics import SHANK, THIGH
from mimics_app.rendering.haptic.kernels.lokomat import orthosis
from mimics_app.world.components.robot import Patient, Robot

HEIGHT, DT = 1.75, 1e-3
SPEEDS = (0.5 / 3.6, 1.8 / 3.6, 3.0 / 3.6)
NOISE = 1e-3  # [rad]
WITHIN = 0.020  # [s]
SWINGS = 0.15  # [m/s]
STIFFNESS, DAMPING = 150.0, 30.0  # of the guidance
SETTLED = 6000  # ticks


@kernel
def _walk(memory, first, inbox, data, command, wish, wish_rate, true, shown):
    plant = memory[first:]
    for k in range(wish.shape[0]):
        read_lokomat(memory, inbox, data, k)
        for joint in range(4):
            q, dq = data[DATA_Q + joint], data[DATA_DQ + joint]
            shown[k, joint] = q
            command[COMMAND_TORQUE + joint] = STIFFNESS * (wish[k, joint] - q) + DAMPING * (wish_rate[k, joint] - dq)
        for number in range(2):
            true[k, 4 * number : 4 * number + 4] = orthosis.state_of(plant, number)[0:4]
        command[COMMAND_ENABLED] = 1.0
        write_lokomat(memory, command, k)


def _reference(speed: float, ticks: int) -> np.ndarray:
    """Hip and knee of both legs [rad], shape [ticks, 4]; the left leg half a cycle later."""
    step, (knee, least) = step_of(speed, HEIGHT), knee_series(HEIGHT)
    u, phase = math.hypot(speed, least), natural_cadence(speed, HEIGHT) * DT * np.arange(ticks)
    hip, bend = np.array([1.0, step, step * step]) @ thigh_series(HEIGHT), np.array([1.0, u, u * u]) @ knee
    columns = [series_at(curve, phase - shift) for shift in (0.5, 0.0) for curve in (hip, bend)]
    return np.stack(columns, 1) * np.minimum(1.0, DT * np.arange(ticks) / 2.0)[:, None]


def _walked(person: str, speed: float, seed: int, seconds: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """True states [ticks, 8] and measured angles [ticks, 4] of a walk, and the geometry of the legs."""
    stride = 1.0 / natural_cadence(speed, HEIGHT)
    robot = Robot(
        device="lokomat", settings={"person": person, "height": HEIGHT, "belt_speed": speed, "stride": stride}
    )
    memory = build_device(robot, Patient(), seed=seed).memory
    ticks = round(seconds / DT)
    wish, inbox = _reference(speed, ticks), np.zeros(INBOX_LENGTH)
    inbox[INBOX_ACTIVE] = 1.0
    true, shown = np.zeros((ticks, 8)), np.zeros((ticks, 4))
    scratch = np.zeros(DATA_LENGTH), np.zeros(COMMAND_LENGTH)
    _walk(memory, PLANT.start, inbox, *scratch, wish, np.gradient(wish, DT, axis=0), true, shown)
    return true, shown, LOKOMAT.geometry_of(robot)


def _true_strikes(state: np.ndarray, geometry: np.ndarray, swings: float = SWINGS) -> np.ndarray:
    """Ticks in which an ankle that swung turns back, from the true angles and velocities of a leg, [ticks, 4]."""
    hip, knee, hip_rate, knee_rate = state.T
    v = geometry[THIGH] * np.cos(hip) * hip_rate + geometry[SHANK] * np.cos(hip - knee) * (hip_rate - knee_rate)
    turns = np.flatnonzero((v[:-1] > 0.0) & (v[1:] <= 0.0)) + 1
    begins = np.concatenate([[0], turns[:-1]])
    return np.array([turn for begin, turn in zip(begins, turns, strict=True) if v[begin:turn].max() > swings])


@kernel
def _watch(heel, geometry, angles, runs, found):
    for k in range(angles.shape[0]):
        before = heel.count
        watch_heel(heel, geometry, angles[k], runs, 1e-3)
        found[k] = heel.count - before


def _found(geometry: np.ndarray, angles: np.ndarray, runs: bool = True) -> np.ndarray:
    """Ticks in which the detector tells a strike of one leg."""
    found = np.zeros(len(angles))
    _watch(np.zeros(1, HEEL_STRIKE)[0], geometry, np.ascontiguousarray(angles), runs, found)
    return np.flatnonzero(found)


def _delays(seed: int, seconds: float) -> tuple[np.ndarray, int]:
    """Delays of the nearest telling of every true strike [s], and the number of tellings that belong to none."""
    rng, delays, false = np.random.default_rng(seed), [], 0
    for person in PERSONS:
        for speed in SPEEDS:
            true, shown, geometry = _walked(person, speed, seed, seconds)
            for leg in range(2):
                state = true[:, 4 * leg : 4 * leg + 4]
                strikes, turns = _true_strikes(state, geometry), _true_strikes(state, geometry, 0.5 * SWINGS)
                angles = shown[:, 2 * leg : 2 * leg + 2]
                found = _found(geometry, angles + rng.normal(0.0, NOISE, angles.shape))
                counted = strikes[(strikes > SETTLED) & (strikes < len(true) - 100)]
                delays += [DT * (found - strike)[np.abs(found - strike).argmin()] for strike in counted]
                told = found[(found > SETTLED + 100) & (found < len(true) - 200)]
                false += sum(np.abs(turns - each).min() > 100 for each in told)
    return np.array(delays), false


@pytest.mark.parametrize("seeds", [1, pytest.param(10, marks=pytest.mark.slow)])
def test_heel_strikes_of_all_presets_at_three_speeds_are_found_within_20_ms(seeds: int) -> None:
    parts = [_delays(seed, 30.0) for seed in range(seeds)]
    delays, false = np.concatenate([part[0] for part in parts]), sum(part[1] for part in parts)
    assert len(delays) > 300 * seeds
    assert (np.abs(delays) <= WITHIN).mean() >= 0.99
    assert false <= 0.01 * len(delays)


def test_a_stopped_belt_has_no_strikes() -> None:
    """Noisy legs that stand for ten minutes, whatever the belt does, and a foot that explores while it stands."""
    rng, geometry = np.random.default_rng(4), LOKOMAT.geometry_of(Robot(device="lokomat"))
    standing = np.array([0.05, 0.15]) + rng.normal(0.0, NOISE, (600_000, 2))
    assert not len(_found(geometry, standing[:60_000], runs=True)) and not len(_found(geometry, standing, runs=False))
    t = DT * np.arange(60_000)
    moving = np.stack([0.2 + 0.25 * np.sin(2.0 * np.pi * 0.5 * t), 0.4 - 0.2 * np.cos(2.0 * np.pi * 0.5 * t)], 1)
    assert len(_found(geometry, moving, runs=True)) > 25, "the same motion on a belt that runs"
    assert not len(_found(geometry, moving, runs=False))


@pytest.mark.parametrize("rate", [0.0, -0.2, -0.5])
def test_a_foot_that_stands_where_the_watch_begins_has_not_struck(rate: float) -> None:
    """Ahead or behind, at rest or moving back with the belt; a place found from 0 m looks like a swing."""
    geometry = LOKOMAT.geometry_of(Robot(device="lokomat"))
    for hip in (0.35, -0.2):
        angles = np.stack([hip + rate * DT * np.arange(600), np.full(600, 0.1)], 1)
        assert _found(geometry, angles).size == 0
