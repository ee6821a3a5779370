"""The drive to a trial's start: slow at every point of every kind of device, and stopped by the stop key and a pause.

REAplan (Dehem et al. 2017, doi 10.2340/16501977-2252) moved spastic arms passively at 0.1 to 0.5 m/s: their resistance
grows with the speed, and is a measure of the spasticity from 0.3 m/s on. A drive is as slow as its slowest.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from mimics_app.contracts.loop.controller_slots import Slot
from mimics_app.contracts.loop.haptic import SafetyState
from mimics_app.contracts.shared_memory.command_ring import request_stop
from mimics_app.rendering.haptic.descriptors.leg import LEG
from mimics_app.rendering.haptic.devices.registry import build_device
from mimics_app.rendering.haptic.scene_block import impedance_values, kinematic_values
from mimics_app.world.components.robot import Impedance, Patient, Robot
from tests.support.haptic_bench import Bench, bench_of

SLOW = 0.1
"""Speed of the slowest of those movements [m/s]."""
ACCELERATION_S = 0.125
"""Time in which a drive reaches its speed, and brakes from it: 1 / (2 kp), kp 4/s [s]."""
EXCESS = {"velocity_driven": 0.02, "leg": 0.02, "force_driven": 0.5}
"""Excess over the commanded speed [-]: of an encoder; of an arm drawn by a damped spring, an undamped one has 1."""
WINDOW = 50
"""Ticks over which a speed is taken: an encoder's step of 20 um is 0.4 mm/s in them."""


def speeds(rows: np.ndarray) -> np.ndarray:
    """Speed of the hand or foot over `WINDOW` ticks [m/s]."""
    return np.linalg.norm(rows["hip_world"][WINDOW:] - rows["hip_world"][:-WINDOW], axis=1) / (WINDOW * 1e-3)


def velocity_driven() -> Bench:
    bench = bench_of(build_device(Robot(), Patient(intent=False), seed=3), straight=None)
    bench.publish(controller=Slot.START, target=(0.1, 0.25, -0.1))
    return bench


def force_driven() -> Bench:
    bench = bench_of(build_device(Robot(device="simulated_impedance"), Patient(intent=False), seed=3), straight=None)
    drive = {"controller": Slot.START, "target": (0.1, 0.25, -0.1)}
    bench.publish(**impedance_values(bench.scene, Impedance()) | drive)
    return bench


def leg() -> Bench:
    robot = Robot(device="simulated_leg")
    bench = bench_of(build_device(robot, Patient(intent=False), seed=3), straight=None)
    bench.publish(**kinematic_values(robot, LEG) | {"controller": Slot.HOLD, "target": (0.45, 0.9)})
    return bench


DRIVES = [velocity_driven, force_driven, leg]


@pytest.mark.parametrize("begin", DRIVES)
def test_a_drive_is_slow_and_arrives(begin: Callable[[], Bench]):
    rows = begin().advance(8000)
    assert 0.8 * SLOW < speeds(rows).max() <= SLOW * (1.0 + EXCESS[begin.__name__])
    assert speeds(rows)[-1] < 2e-3


@pytest.mark.parametrize("begin", DRIVES)
@pytest.mark.requirement("R15")
def test_the_stop_key_stops_a_drive_within_a_centimetre(begin: Callable[[], Bench]):
    bench = begin()
    drive = bench.advance(700)
    request_stop(bench.memory)
    rows = bench.advance(500)
    assert speeds(drive)[-1] > 0.8 * SLOW
    assert rows["state"][-1] == SafetyState.E_STOP and speeds(rows)[-1] < 1e-3
    assert np.linalg.norm(rows["hip_world"][-1] - drive["hip_world"][-1]) < 0.01


@pytest.mark.parametrize("begin", DRIVES)
def test_a_pause_brakes_a_drive_gently_and_holds(begin: Callable[[], Bench]):
    """As the task orders it: joint PD to the joints at which the pause began."""
    bench = begin()
    before = bench.advance(700)[-1]
    bench.publish(controller=Slot.HOLD, target=tuple(before["q"][:3]))
    rows = bench.advance(2000)
    way = np.linalg.norm(rows["hip_world"] - before["hip_world"], axis=1)
    assert way.max() < SLOW * ACCELERATION_S and speeds(rows)[-1] < 2e-3
