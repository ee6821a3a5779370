"""Device that replays the sensor data of a recording; commands are ignored."""

from __future__ import annotations

import numpy as np

from mimics_app.compiled.kernel import typed_kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.loop.loop_fields import contacts_in, point_rows
from mimics_app.contracts.loop.loop_ports import (
    DATA_AGE,
    DATA_BUTTONS,
    DATA_DELAY,
    DATA_DQ,
    DATA_FORCE,
    DATA_GRASP,
    DATA_LENGTH,
    DATA_Q,
    DATA_TORQUE,
    READ,
    WRITE,
    DevicePlugin,
)
from mimics_app.rendering.haptic.devices.request import DeviceRequest

__all__ = ["build_replay", "ignore_command", "read_recorded"]


_ROW = DATA_LENGTH + 1
"""Length of one tick in the memory: data vector and status."""

_COLUMNS = {
    DATA_Q: "q",
    DATA_DQ: "dq",
    DATA_FORCE: "f_meas",
    DATA_TORQUE: "torque_meas",
    DATA_GRASP: "grasp",
    DATA_BUTTONS: "buttons",
    DATA_AGE: "age",
    DATA_DELAY: "delay",
    DATA_LENGTH: "status",
}
"""Recorded field at each place of a row; of further points of contact behind that of the first."""


@typed_kernel(READ)
def read_recorded(memory: Vec, inbox: Vec, data: Vec, tick: int) -> int:
    """Read row `tick` of the recording; NO_DATA beyond its end. Memory: data vector and status of each tick."""
    row = tick * _ROW
    if row + _ROW > memory.shape[0]:
        return 1
    for i in range(DATA_LENGTH):
        data[i] = memory[row + i]
    return int(memory[row + DATA_LENGTH])


@typed_kernel(WRITE)
def ignore_command(memory: Vec, command: Vec, tick: int) -> int:
    """Ignore the command."""
    return 0


def build_replay(request: DeviceRequest) -> DevicePlugin:
    """Build the device of a recording.

    Raises:
        DeviceError: The request holds no recording.
    """
    samples = request.samples
    if samples is None or samples.shape[0] == 0:
        raise DeviceError("the replay device needs a recording", "name a run folder with --recording")
    memory = np.zeros((samples.shape[0], _ROW))
    for first, name in _COLUMNS.items():
        values = samples[name].reshape(samples.shape[0], -1)
        memory[:, first : first + values.shape[1]] = values
    for c in range(1, contacts_in(samples)):
        point = point_rows(samples, c)
        memory[:, DATA_FORCE + 3 * c : DATA_FORCE + 3 * c + 3] = point["f_meas"]
        memory[:, DATA_GRASP + c] = point["grasp"]
    return DevicePlugin("replay", read_recorded, ignore_command, memory.ravel(), follows="nothing", simulated=True)
