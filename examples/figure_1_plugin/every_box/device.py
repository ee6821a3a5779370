"""Device: a handle that follows its velocities at once, moved by the product's simulated person."""

from __future__ import annotations

import math

import numpy as np

from mimics_app.compiled.kernel import typed_kernel
from mimics_app.contracts.loop.loop_ports import (
    COMMAND_DQ,
    COMMAND_ENABLED,
    DATA_DQ,
    DATA_FORCE,
    DATA_Q,
    READ,
    WRITE,
    DevicePlugin,
)
from mimics_app.rendering.haptic.devices.simulated_person import move_person, write_person
from mimics_app.rendering.haptic.kernels.arm import ARM_LENGTH, GRIP_FORCE
from mimics_app.rendering.haptic.kernels.kinematics import apply_jacobian, forward, robot_to_tool

# What the device remembers: joints and velocities, their limits, the handle's position and velocity, then the person.
Q, DQ, LOW, HIGH, HANDLE, DT, PERSON = 0, 3, 6, 9, 12, 18, 19
D1 = 0.5 * 0.36 + 0.28  # from the axis to the centre of the workspace [m]


@typed_kernel(READ)
def read(memory, inbox, data, tick):
    """Move for a tick, then write what the sensors show: it never waits and never raises."""
    q, dq, handle, person = memory[Q : Q + 3], memory[DQ : DQ + 3], memory[HANDLE : HANDLE + 6], memory[PERSON:]
    for i in range(3):
        q[i] = min(memory[HIGH + i], max(memory[LOW + i], q[i] + memory[DT] * dq[i]))
        data[DATA_Q + i], data[DATA_DQ + i] = q[i], dq[i]
    forward(q, D1, handle[0:3])
    apply_jacobian(q, D1, dq, handle[3:6])
    move_person(person, handle, 0, inbox, data, memory[DT])
    robot_to_tool(q, person[GRIP_FORCE : GRIP_FORCE + 3], data[DATA_FORCE : DATA_FORCE + 3])
    return 0  # DeviceStatus.FRESH


@typed_kernel(WRITE)
def write(memory, command, tick):
    """Take the velocities, or rest where they are not enabled or no numbers."""
    taken = 0
    for i in range(3):
        usable = math.isfinite(command[COMMAND_DQ + i])
        taken = taken if usable else 1
        memory[DQ + i] = command[COMMAND_DQ + i] if usable and command[COMMAND_ENABLED] != 0.0 else 0.0
    return taken


def build(request):
    """Build the handle within the joint limits of the scene, with its person."""
    memory = np.zeros(PERSON + ARM_LENGTH)
    memory[Q : Q + 3] = request.start_joints
    memory[LOW : LOW + 3], memory[HIGH : HIGH + 3] = request.limits.lowest, request.limits.highest
    memory[DT] = 1.0 / request.rate
    write_person(memory[PERSON:], request)
    return DevicePlugin("led_handle", read, write, memory, delay=1.0 / request.rate, simulated=True)
