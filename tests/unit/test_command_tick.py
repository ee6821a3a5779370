"""What a tick commands acts in that tick: nothing between the device's read and its write waits for the next one."""

from __future__ import annotations

import numpy as np
import pytest

from mimics_app.compiled.kernel import typed_kernel
from mimics_app.contracts.loop.controller_slots import Slot
from mimics_app.contracts.loop.loop_ports import (
    COMMAND_DQ,
    COMMAND_ENABLED,
    COMMAND_LENGTH,
    DATA_FORCE,
    DATA_LENGTH,
    READ,
    WRITE,
    DevicePlugin,
)
from mimics_app.rendering.haptic.devices.registry import build_device
from mimics_app.rendering.haptic.kernels import robot as place
from mimics_app.world.components.robot import Robot
from tests.support.haptic_bench import bench_of

PUSH_AT = 300
"""Tick whose data shows the hand's force for the first time."""

PUSH = 6.0
"""[N]"""

TICKS = 400


@typed_kernel(READ)
def _read(memory, inbox, data, tick):
    data[:] = 0.0
    data[DATA_FORCE] = PUSH if tick >= PUSH_AT else 0.0
    memory[0] = tick
    return 0


@typed_kernel(WRITE)
def _write(memory, command, tick):
    row = 1 + tick * (COMMAND_LENGTH + 1)
    memory[row] = memory[0]
    for i in range(COMMAND_LENGTH):
        memory[row + 1 + i] = command[i]
    return 0


def test_the_command_of_tick_k_reaches_the_device_in_tick_k():
    """An admittance at rest: the first tick that reads a force commands F dt / m, no tick before and none after it."""
    memory = np.zeros(1 + TICKS * (COMMAND_LENGTH + 1))
    bench = bench_of(DevicePlugin("logged", _read, _write, memory), straight=None)
    bench.publish(controller=Slot.PERSON, virtual_mass=3.0, virtual_damping=0.0)
    samples = bench.advance(TICKS)
    written = memory[1:].reshape(TICKS, COMMAND_LENGTH + 1)
    sent = written[:, 1 + COMMAND_DQ : 4 + COMMAND_DQ]
    assert np.array_equal(written[:, 0], np.arange(TICKS)), "each write follows the read of its own tick"
    assert np.array_equal(sent, samples["command"][:, :3]), "what is recorded for a tick is what the device got in it"
    assert not sent[:PUSH_AT].any()
    assert sent[PUSH_AT, 0] == pytest.approx(PUSH * 1e-3 / 3.0, rel=1e-9)
    assert sent[PUSH_AT + 9, 0] == pytest.approx(10 * PUSH * 1e-3 / 3.0, rel=1e-6)


def test_the_simulated_robot_moves_from_the_tick_of_its_command_on():
    """Its joint speed a tick later is 1 - exp(-w_p dt) of what was commanded; with a delay line of d ticks, d later."""
    for delay in (0, 3):
        plugin = build_device(Robot(delay_ticks=delay, servo_bandwidth_hz=20.0), seed=4)
        command, data = np.zeros(COMMAND_LENGTH), np.zeros(DATA_LENGTH)
        command[COMMAND_DQ], command[COMMAND_ENABLED] = 0.1, 1.0
        speeds = []
        for tick in range(8):
            plugin.read(plugin.memory, np.zeros(7), data, tick)
            speeds.append(plugin.memory[place.Q + 3])
            plugin.write(plugin.memory, command, tick)
        assert not any(speeds[: delay + 1])
        assert speeds[delay + 1] == pytest.approx(0.1 * (1.0 - np.exp(-2.0 * np.pi * 20.0 * 1e-3)), rel=1e-9)
