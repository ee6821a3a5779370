"""Simulated HapticMaster: three driven masses and their sensors.

Each axis is a mass with a velocity servo of finite bandwidth and drive force. A hand does not move the robot directly:
it loads the force sensor, and the admittance controller commands the motion, as on the real machine. Its inertia is
therefore felt as the virtual mass.
"""

from __future__ import annotations

import math

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.loop.loop_ports import DATA_AGE, DATA_DQ, DATA_FORCE, DATA_Q
from mimics_app.rendering.haptic.kernels.kinematics import apply_jacobian, forward, robot_to_tool
from mimics_app.rendering.haptic.kernels.limiter import decay
from mimics_app.rendering.haptic.kernels.noise import gauss, quantised

__all__ = [
    "AXIS_OFFSET",
    "DELAY",
    "DQ",
    "DRIVE_FORCE",
    "ENCODER",
    "HANDLE",
    "JOINT_MAX",
    "JOINT_MIN",
    "MASSES",
    "MAX_DELAY",
    "MEASURED",
    "NOISE",
    "ROBOT_LENGTH",
    "SENSOR_GAIN",
    "SENSOR_NOISE",
    "SENSOR_QUANTUM",
    "SERVO",
    "SPEED_FILTER_HZ",
    "TICK",
    "VELOCITY_LIMIT",
    "Q",
    "coast_robot",
    "command_robot",
    "place_handle",
    "sense",
    "step_robot",
]


MAX_DELAY = 50

Q = 0  # true joints [m, rad, m]
DQ = 3  # true joint velocities
MEASURED = 6  # joints as last read by the encoders [m, rad, m]
SPEED = 9  # joint velocities from the encoders, filtered [m/s, rad/s, m/s]
HANDLE = 12  # position 12:15 [m] and velocity 15:18 [m/s] of the handle, robot frame
AXIS_OFFSET = 18  # d1 [m]
JOINT_MIN = 19
JOINT_MAX = 22
SERVO = 25  # bandwidth of the velocity servo [rad/s]
MASSES = 26  # radial [kg], about the axis at r = axis offset [kg m^2], vertical [kg]
DRIVE_FORCE = 29  # of each drive at the handle, and range of the force sensor [N]
VELOCITY_LIMIT = 30  # [m/s, rad/s, m/s]
ENCODER = 33  # quantum per joint [m, rad, m]
SENSOR_NOISE = 36  # standard deviation [N]
SENSOR_QUANTUM = 37  # [N]
SENSOR_GAIN = 38  # 1; 0 disconnects the sensor
NOISE = 39  # state of the random generator
TICK = 40  # [s]
DELAY = 41  # delay of the command [ticks]
WRITTEN = 42  # commands written so far
LINE = 43  # ring of the last MAX_DELAY + 1 commands
ROBOT_LENGTH = LINE + 3 * (MAX_DELAY + 1)

_STOP_GAP = 0.005
"""Distance of the mechanical end stops beyond the joint limits [m, rad]."""

SPEED_FILTER_HZ = 150.0
"""Corner frequency of the encoder velocity filter [Hz]."""


@kernel
def command_robot(robot: Vec, dq: Vec) -> None:
    """Put joint velocities into the delay line."""
    slot = LINE + 3 * (int(robot[WRITTEN]) % (MAX_DELAY + 1))
    for i in range(3):
        robot[slot + i] = dq[i]
    robot[WRITTEN] += 1.0


@kernel
def coast_robot(robot: Vec) -> None:
    """Put a decayed copy of the last command into the delay line, for a tick in which the drives are disabled."""
    written = int(robot[WRITTEN])
    last = LINE + 3 * ((written + MAX_DELAY) % (MAX_DELAY + 1))
    slot = LINE + 3 * (written % (MAX_DELAY + 1))
    for i in range(3):
        robot[slot + i] = robot[last + i] if written > 0 else 0.0
    decay(robot[slot : slot + 3], robot[TICK])
    robot[WRITTEN] += 1.0


@kernel
def _drive(robot: Vec, axis: int, wish: float) -> None:
    """Advance one axis by a tick: exact step of the servo's first-order lag within the drive's force and speed."""
    dt = robot[TICK]
    limit = robot[VELOCITY_LIMIT + axis]
    wish = min(limit, max(-limit, wish))
    inertia = robot[MASSES + axis]
    strength = robot[DRIVE_FORCE]
    if axis == 1:
        strength *= robot[Q] + robot[AXIS_OFFSET]
    change = (wish - robot[DQ + axis]) * (1.0 - math.exp(-robot[SERVO] * dt))
    largest = strength / inertia * dt
    change = min(largest, max(-largest, change))
    last = robot[DQ + axis]
    robot[DQ + axis] = last + change
    robot[Q + axis] += dt * (last + 0.5 * change)
    low = robot[JOINT_MIN + axis] - _STOP_GAP
    high = robot[JOINT_MAX + axis] + _STOP_GAP
    if robot[Q + axis] < low:
        robot[Q + axis] = low
        robot[DQ + axis] = max(0.0, robot[DQ + axis])
    elif robot[Q + axis] > high:
        robot[Q + axis] = high
        robot[DQ + axis] = min(0.0, robot[DQ + axis])


@kernel
def step_robot(robot: Vec) -> None:
    """Advance the robot by one tick with the command that leaves the delay line, and place the handle."""
    due = int(robot[WRITTEN]) - 1 - int(robot[DELAY])
    slot = LINE + 3 * (due % (MAX_DELAY + 1))
    for axis in range(3):
        _drive(robot, axis, robot[slot + axis] if due >= 0 else 0.0)
    place_handle(robot)


@kernel
def place_handle(robot: Vec) -> None:
    """Set position and velocity of the handle from the true joints."""
    q = robot[Q : Q + 3]
    forward(q, robot[AXIS_OFFSET], robot[HANDLE : HANDLE + 3])
    apply_jacobian(q, robot[AXIS_OFFSET], robot[DQ : DQ + 3], robot[HANDLE + 3 : HANDLE + 6])


@kernel
def sense(robot: Vec, f: Vec, data: Vec) -> None:
    """Fill the data vector: encoders, their filtered difference, and the force sensor.

    Args:
        robot: Robot memory.
        f: Force of the hand on the handle, robot frame [N].
        data: Shape [DATA_LENGTH]; grasp and buttons are set by the caller.
    """
    blend = 1.0 - math.exp(-2.0 * math.pi * SPEED_FILTER_HZ * robot[TICK])
    for i in range(3):
        shown = quantised(robot[Q + i], robot[ENCODER + i])
        difference = (shown - robot[MEASURED + i]) / robot[TICK]
        robot[SPEED + i] += blend * (difference - robot[SPEED + i])
        robot[MEASURED + i] = shown
        data[DATA_Q + i] = shown
        data[DATA_DQ + i] = robot[SPEED + i]
    robot_to_tool(robot[Q : Q + 3], f, data[DATA_FORCE : DATA_FORCE + 3])
    for i in range(3):
        pull = data[DATA_FORCE + i] * robot[SENSOR_GAIN] + robot[SENSOR_NOISE] * gauss(robot, NOISE)
        pull = min(robot[DRIVE_FORCE], max(-robot[DRIVE_FORCE], pull))
        data[DATA_FORCE + i] = quantised(pull, robot[SENSOR_QUANTUM])
    data[DATA_AGE] = 0.0
