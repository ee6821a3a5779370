"""One mass on three rails: follows the commanded velocity, held back by a spring that its force sensor shows."""

from __future__ import annotations

import math

import numpy as np

from mimics_app.compiled.kernel import typed_kernel
from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.loop.loop_ports import (
    COMMAND_DQ,
    COMMAND_ENABLED,
    DATA_AGE,
    DATA_BUTTONS,
    DATA_DQ,
    DATA_FORCE,
    DATA_GRASP,
    DATA_Q,
    INBOX_BUTTONS,
    INBOX_GRASP,
    READ,
    WRITE,
    DevicePlugin,
)

# What the device remembers: joints 0:3, velocities 3:6, velocities wanted 6:9, limits 9:15, tick, spring.
Q, DQ, WANTED, LOW, HIGH, TICK, SPRING, LENGTH = 0, 3, 6, 9, 12, 15, 16, 17
LAG = 0.02  # [s] in which the mass follows
LARGEST = 1.0  # [m/s, rad/s]


@typed_kernel(READ)
def read(memory, inbox, data, tick):
    """One tick of motion, then what the sensors show; never waits, never raises, takes no memory."""
    for i in range(3):
        memory[DQ + i] += (memory[WANTED + i] - memory[DQ + i]) * (1.0 - math.exp(-memory[TICK] / LAG))
        memory[Q + i] = min(memory[HIGH + i], max(memory[LOW + i], memory[Q + i] + memory[TICK] * memory[DQ + i]))
        data[DATA_Q + i] = memory[Q + i]
        data[DATA_DQ + i] = memory[DQ + i]
        data[DATA_FORCE + i] = -memory[SPRING] * memory[Q + i]
    data[DATA_GRASP] = inbox[INBOX_GRASP] if inbox[INBOX_GRASP] > 0.0 else 0.0
    data[DATA_BUTTONS] = inbox[INBOX_BUTTONS] if inbox[INBOX_BUTTONS] > 0.0 else 0.0
    data[DATA_AGE] = 0.0
    return 0  # DeviceStatus.FRESH


@typed_kernel(WRITE)
def write(memory, command, tick):
    """Take the velocities, or come to rest where they are not enabled or not finite."""
    taken = 0
    for i in range(3):
        usable = math.isfinite(command[COMMAND_DQ + i])
        taken = taken if usable else 1
        wish = command[COMMAND_DQ + i] if usable and command[COMMAND_ENABLED] != 0.0 else 0.0
        memory[WANTED + i] = min(LARGEST, max(-LARGEST, wish))
    return taken


def build(request):
    """A mass on three rails; `robot.settings` may hold spring [N/m]."""
    memory = np.zeros(LENGTH)
    memory[LOW : LOW + 3], memory[HIGH : HIGH + 3] = request.limits.lowest, request.limits.highest
    memory[TICK] = 1.0 / request.rate
    memory[SPRING] = request.robot.settings.get("spring", 50.0)
    if not 0.0 <= memory[SPRING] < 1e4:
        raise DeviceError("the spring of mass_on_rails is out of range", "give 0 to 10000 N/m")
    return DevicePlugin("mass_on_rails", read, write, memory, delay=LAG, simulated=True)
