"""Simulated light impedance robot: one mass at the handle, friction, encoders and a delay line; no force sensor.

A hand back-drives it against its own small mass and friction. Its motors are weak; forces beyond theirs are clipped.
"""

from __future__ import annotations

import math

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.loop.loop_ports import DATA_AGE, DATA_DELAY, DATA_DQ, DATA_FORCE, DATA_Q
from mimics_app.maths.vec import clamp_joints, clamp_norm, copy, fill
from mimics_app.rendering.haptic.kernels.kinematics import apply_inverse_jacobian, forward, inverse
from mimics_app.rendering.haptic.kernels.noise import quantised

__all__ = [
    "AXIS_OFFSET",
    "DAMPING",
    "DELAY",
    "ENCODER",
    "HANDLE",
    "JOINT_MAX",
    "JOINT_MIN",
    "LENGTH",
    "MASS",
    "MAX_DELAY",
    "MOTOR_FORCE",
    "SEEN",
    "SPEED_FILTER_HZ",
    "TICK",
    "command_force",
    "sense_position",
    "step_light_robot",
]


MAX_DELAY = 50

HANDLE = 0  # position 0:3 [m] and velocity 3:6 [m/s], robot frame
SEEN = 6  # position as last read by the encoders [m]
SPEED = 9  # velocity from the encoders, filtered [m/s]
MASS = 12  # [kg]
DAMPING = 13  # own friction [N s/m]
MOTOR_FORCE = 14  # largest, at the handle [N]
ENCODER = 15  # quantum at the handle [m]
TICK = 16  # [s]
AXIS_OFFSET = 17  # d1 [m]
JOINT_MIN = 18
JOINT_MAX = 21
DELAY = 24  # of the command [ticks]
WRITTEN = 25  # commands written so far
WORK = 26  # joints, and scratch
BRAKING = 32  # 1 while the motors are disabled and brake
LINE = 33  # ring of the last MAX_DELAY + 1 forces
LENGTH = LINE + 3 * (MAX_DELAY + 1)

SPEED_FILTER_HZ = 150.0
"""Corner frequency of the encoder velocity filter [Hz]."""

_BRAKE = 60.0
"""Damping of short-circuited motors [N s/m]."""


@kernel
def command_force(robot: Vec, f: Vec, enabled: bool) -> None:
    """Put a force on the user [N], robot frame, into the delay line; while not `enabled` zero, and the motors brake."""
    slot = LINE + 3 * (int(robot[WRITTEN]) % (MAX_DELAY + 1))
    for i in range(3):
        robot[slot + i] = f[i] if enabled else 0.0
    robot[BRAKING] = 0.0 if enabled else 1.0
    robot[WRITTEN] += 1.0


@kernel
def _stop_at_limits(robot: Vec) -> None:
    """Hold the handle within the end stops, at rest there."""
    q = robot[WORK : WORK + 3]
    inverse(robot[HANDLE : HANDLE + 3], robot[AXIS_OFFSET], q)
    if clamp_joints(q, robot[JOINT_MIN : JOINT_MIN + 3], robot[JOINT_MAX : JOINT_MAX + 3]) != 0:
        forward(q, robot[AXIS_OFFSET], robot[HANDLE : HANDLE + 3])
        fill(robot[HANDLE + 3 : HANDLE + 6], 0.0)


@kernel
def step_light_robot(robot: Vec, hand: Vec) -> None:
    """Advance the robot by one tick, exactly for motor and hand forces held over it.

    Args:
        robot: Robot memory, shape [LENGTH].
        hand: Force of the hand on the handle, robot frame [N].
    """
    dt, m = robot[TICK], robot[MASS]
    c = robot[DAMPING] + _BRAKE * robot[BRAKING]
    push = robot[WORK + 3 : WORK + 6]
    fill(push, 0.0)
    late = robot[WRITTEN] - 1.0 - robot[DELAY]
    if late >= 0.0:
        slot = LINE + 3 * (int(late) % (MAX_DELAY + 1))
        copy(robot[slot : slot + 3], push)
        clamp_norm(push, robot[MOTOR_FORCE])
    keep = math.exp(-c * dt / m)
    reach = (1.0 - keep) * m / c if c > 0.0 else dt
    for i in range(3):
        v = robot[HANDLE + 3 + i]
        steady = (push[i] + hand[i]) / c if c > 0.0 else 0.0
        gain = 0.0 if c > 0.0 else (push[i] + hand[i]) / m * dt
        robot[HANDLE + i] += steady * dt + (v - steady) * reach + 0.5 * gain * dt
        robot[HANDLE + 3 + i] = steady + (v - steady) * keep + gain
    _stop_at_limits(robot)


@kernel
def sense_position(robot: Vec, data: Vec) -> None:
    """Fill the data vector from the encoders; forces are 0, grasp and buttons are set by the caller."""
    blend = 1.0 - math.exp(-2.0 * math.pi * SPEED_FILTER_HZ * robot[TICK])
    for i in range(3):
        shown = quantised(robot[HANDLE + i], robot[ENCODER])
        difference = (shown - robot[SEEN + i]) / robot[TICK]
        robot[SPEED + i] += blend * (difference - robot[SPEED + i])
        robot[SEEN + i] = shown
    copy(robot[WORK : WORK + 3], data[DATA_Q : DATA_Q + 3])
    inverse(robot[SEEN : SEEN + 3], robot[AXIS_OFFSET], data[DATA_Q : DATA_Q + 3])
    apply_inverse_jacobian(
        data[DATA_Q : DATA_Q + 3], robot[AXIS_OFFSET], robot[SPEED : SPEED + 3], data[DATA_DQ : DATA_DQ + 3]
    )
    fill(data[DATA_FORCE : DATA_FORCE + 3], 0.0)
    data[DATA_AGE] = 0.0
    data[DATA_DELAY] = 0.0
