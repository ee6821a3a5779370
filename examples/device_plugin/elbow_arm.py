"""A planar arm with shoulder and elbow: another shape than the HapticMaster, given to the loop by a descriptor.

Only its point and its Jacobian are written down; the loop works out the rest. A spring that its sensor shows pulls the
hand to where it began.
"""

from __future__ import annotations

import math

import numpy as np

from mimics_app.compiled.kernel import typed_kernel
from mimics_app.contracts.loop.device_descriptor import KINEMATICS, DeviceDescriptor, Joint, Kinematics, described
from mimics_app.contracts.loop.loop_ports import (
    COMMAND_DQ,
    COMMAND_ENABLED,
    DATA_AGE,
    DATA_DQ,
    DATA_FORCE,
    DATA_Q,
    READ,
    WRITE,
    DevicePlugin,
)

# What the device remembers: joints 0:2, velocities 2:4, velocities wanted 4:6, limits 6:10, tick, spring, link, start.
Q, DQ, WANTED, LOW, HIGH, TICK, SPRING, LINK, START, LENGTH = 0, 2, 4, 6, 8, 10, 11, 12, 13, 15
LAG = 0.02  # [s] in which the joints follow


@typed_kernel(KINEMATICS)
def point(geometry, q, given, out):
    """Hand in the frame of the arm: x forward, y to the left [m]."""
    out[0] = geometry[0] * (math.cos(q[0]) + math.cos(q[0] + q[1]))
    out[1] = geometry[0] * (math.sin(q[0]) + math.sin(q[0] + q[1]))
    out[2] = 0.0
    return 0


@typed_kernel(KINEMATICS)
def jacobian(geometry, q, given, out):
    """dx/dq row by row: x, y, z of the one point by shoulder and elbow [m/rad]."""
    out[1], out[3] = -geometry[0] * math.sin(q[0] + q[1]), geometry[0] * math.cos(q[0] + q[1])
    out[0], out[2] = out[1] - geometry[0] * math.sin(q[0]), out[3] + geometry[0] * math.cos(q[0])
    out[4], out[5] = 0.0, 0.0
    return 0


@typed_kernel(READ)
def read(memory, inbox, data, tick):
    """One tick of motion, then what the sensors show."""
    for i in range(2):
        memory[DQ + i] += (memory[WANTED + i] - memory[DQ + i]) * (1.0 - math.exp(-memory[TICK] / LAG))
        memory[Q + i] = min(memory[HIGH + i], max(memory[LOW + i], memory[Q + i] + memory[TICK] * memory[DQ + i]))
        data[DATA_Q + i], data[DATA_DQ + i] = memory[Q + i], memory[DQ + i]
    point(memory[LINK : LINK + 1], memory[Q : Q + 2], memory[Q : Q + 2], data[DATA_FORCE : DATA_FORCE + 3])
    for i in range(2):
        data[DATA_FORCE + i] = memory[SPRING] * (memory[START + i] - data[DATA_FORCE + i])
    data[DATA_AGE] = 0.0
    return 0  # DeviceStatus.FRESH


@typed_kernel(WRITE)
def write(memory, command, tick):
    """Take the joint velocities, or come to rest where they are not enabled or not finite."""
    usable = math.isfinite(command[COMMAND_DQ] + command[COMMAND_DQ + 1])
    for i in range(2):
        memory[WANTED + i] = command[COMMAND_DQ + i] if usable and command[COMMAND_ENABLED] != 0.0 else 0.0
    return 0 if usable else 1


ARM = DeviceDescriptor(
    joints=(Joint("shoulder", "rad", -1.0, 1.5, 3.0, 60.0, 0.02), Joint("elbow", "rad", 0.2, 2.2, 3.0, 60.0, 0.02)),
    contacts=("hand",),
    kinematics=Kinematics(point, jacobian),
    geometry=lambda robot: (robot.settings.get("link", 0.3),),
)


@described(ARM)
def build(request):
    """The arm; `robot.settings` may hold spring [N/m] and link, the length of each of its two links [m]."""
    memory = np.zeros(LENGTH)
    memory[LOW : LOW + 2], memory[HIGH : HIGH + 2] = request.limits.lowest, request.limits.highest
    memory[Q : Q + 2], memory[TICK] = (0.2, 1.0), 1.0 / request.rate
    memory[SPRING], memory[LINK] = request.robot.settings.get("spring", 30.0), ARM.geometry_of(request.robot)[0]
    start = np.zeros(3)
    point(memory[LINK : LINK + 1], memory[Q : Q + 2], memory[Q : Q + 2], start)
    memory[START : START + 2] = start[:2]
    return DevicePlugin("elbow_arm", read, write, memory, delay=LAG, simulated=True)
