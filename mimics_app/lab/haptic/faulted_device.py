"""The simulated robot and person with one fault from a chosen tick on, for `mimics bench faults`."""

from __future__ import annotations

from dataclasses import replace
from enum import IntEnum

import numpy as np

from mimics_app.compiled.kernel import kernel, typed_kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.loop.haptic import Button, DeviceStatus
from mimics_app.contracts.loop.loop_ports import (
    DATA_AGE,
    DATA_BUTTONS,
    DATA_DQ,
    DATA_FORCE,
    DATA_Q,
    READ,
    WRITE,
    DevicePlugin,
)
from mimics_app.rendering.haptic.devices.simulated_hapticmaster import read_patient, write_robot

__all__ = ["DeviceFault", "FaultedDevice"]


class DeviceFault(IntEnum):
    """What the device does from the fault's tick on."""

    NONE = 0
    NOT_FINITE_POSITION = 1  # one joint is NaN
    NOT_FINITE_FORCE = 2  # one axis of the force sensor is infinite
    SILENT = 3  # no new data: the cable is out
    DRIVE_FAULT = 4  # the device itself reports a fault
    BUTTON = 5  # the person presses its stop button
    JUMP = 6  # the position leaps by a centimetre, as after a lost encoder pulse
    TOO_FAST = 7  # the vertical axis reports 3 m/s
    SENSOR_SPIKE = 8  # one tick of 400 N at the force sensor
    SENSOR_STUCK = 9  # 300 N at the force sensor in every tick
    DEAF = 10  # it sends data and takes no command
    SENSOR_PULLS = 11  # 249 N at the force sensor in every tick: as a strong hand


_KIND, _AT, _HEAD = 0, 1, 2
"""Places of the fault and of its first tick in the memory, and their number; the robot's memory follows."""

_VERTICAL = 2
"""Joint of the HapticMaster along the vertical."""

_LEAP = 0.01
"""[m]"""
_FAST = 3.0
"""[m/s]"""
_SPIKE, _STUCK, _PULL = 400.0, 300.0, 249.0
"""[N]"""
_TICK_S = 1e-3

_STOP = float(Button.STOP)
_NO_DATA, _FAULT = int(DeviceStatus.NO_DATA), int(DeviceStatus.FAULT)


@kernel
def _spoil_sensor(kind: int, since: int, data: Vec) -> None:
    """Spoil the force sensor, `since` ticks after the fault began."""
    if kind == DeviceFault.NOT_FINITE_FORCE:
        data[DATA_FORCE] = np.inf
    elif kind == DeviceFault.SENSOR_SPIKE and since == 0:
        data[DATA_FORCE + _VERTICAL] += _SPIKE
    elif kind == DeviceFault.SENSOR_STUCK:
        data[DATA_FORCE + _VERTICAL] = _STUCK
    elif kind == DeviceFault.SENSOR_PULLS:
        data[DATA_FORCE + _VERTICAL] = _PULL


@typed_kernel(READ)
def read_faulted(memory: Vec, inbox: Vec, data: Vec, tick: int) -> int:
    """Read the simulated robot, then spoil its data from the fault's tick on."""
    kind, since = int(memory[_KIND]), tick - int(memory[_AT])
    if since >= 0 and kind == DeviceFault.SILENT:
        data[DATA_AGE] = (since + 1) * _TICK_S
        return _NO_DATA
    status = read_patient(memory[_HEAD:], inbox, data, tick)
    if since < 0 or kind == 0:
        return status
    if kind == DeviceFault.NOT_FINITE_POSITION:
        data[DATA_Q] = np.nan
    elif kind == DeviceFault.BUTTON:
        data[DATA_BUTTONS] = _STOP
    elif kind == DeviceFault.JUMP:
        data[DATA_Q + _VERTICAL] += _LEAP
    elif kind == DeviceFault.TOO_FAST:
        data[DATA_DQ + _VERTICAL] = _FAST
    else:
        _spoil_sensor(kind, since, data)
    return _FAULT if kind == DeviceFault.DRIVE_FAULT else status


@typed_kernel(WRITE)
def write_faulted(memory: Vec, command: Vec, tick: int) -> int:
    """Send the command to the simulated robot, which keeps the last one when it takes none."""
    if int(memory[_KIND]) == DeviceFault.DEAF and tick >= int(memory[_AT]):
        return 1
    return write_robot(memory[_HEAD:], command, tick)


class FaultedDevice:
    """A device plug-in whose fault is chosen while it runs on the virtual clock.

    Args:
        sound: The simulated HapticMaster, without faults.

    Attributes:
        plugin: The plug-in to play with; it counts as a real device, so that stops latch.
    """

    def __init__(self, sound: DevicePlugin) -> None:
        self._memory = np.concatenate([np.zeros(_HEAD), sound.memory])
        self.plugin = replace(sound, read=read_faulted, write=write_faulted, memory=self._memory, simulated=False)

    def begin(self, fault: DeviceFault, tick: int) -> None:
        """Let a fault begin at a tick."""
        self._memory[_AT], self._memory[_KIND] = tick, fault
