"""Controller of the emulated HapticMaster: admittance control at 2500 Hz, with its effects and objects.

A row of the table of effects is one effect or object; columns that its kind does not use are ignored.
"""

from __future__ import annotations

import math

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Mat, Vec
from mimics_app.contracts.loop.loop_ports import COMMAND_DQ, COMMAND_ENABLED, DATA_FORCE
from mimics_app.maths.vec import clamp_norm, fill, norm
from mimics_app.rendering.haptic.devices.simulated_hapticmaster import read_patient, write_robot
from mimics_app.rendering.haptic.kernels.kinematics import apply_inverse_jacobian, apply_jacobian, tool_to_robot
from mimics_app.rendering.haptic.kernels.limiter import brake_at_limits
from mimics_app.rendering.haptic.kernels.robot import AXIS_OFFSET, HANDLE, JOINT_MAX, JOINT_MIN, Q

__all__ = [
    "BIAS",
    "BLOCK",
    "CYLINDER",
    "DAMPER",
    "EFFECT",
    "INERTIA",
    "MACHINE_LENGTH",
    "MEASURED",
    "PLANE",
    "RATE",
    "SPHERE",
    "SPRING",
    "VELOCITY",
    "effects_force",
    "step_machine",
]


RATE = 2500
"""Rate of the controller [Hz]."""

SPRING, DAMPER, BIAS, BLOCK, SPHERE, CYLINDER, PLANE = 1, 2, 3, 4, 5, 6, 7
"""Kinds of rows."""

KIND, ENABLED = 0, 1
POS = 2  # [m]
VEL = 5  # [m/s]
STIFFNESS = 8  # [N/m]
DAMP = 9  # share of the critical damping with the virtual mass
MAX_FORCE = 10  # [N]; 0: none
DEADBAND = 11  # [m]
DIRECTION = 12  # of a spring; zero: all
SIZE = 15  # of a block, edge lengths [m]; radius, length of others
FORCE = 18  # bias [N]; damping of a damper [N s/m]; normal of a plane
FRICTION = 21
EFFECT = 22
"""Columns of the table."""

INERTIA = 0  # virtual mass [kg]
COULOMB = 1  # friction against any motion [N]
VELOCITY = 2  # of the virtual mass, robot frame [m/s]
MEASURED = 5  # force of the user, robot frame [N]
_WORK = 8
MACHINE_LENGTH = _WORK + 9
"""Length of the controller's memory, float64."""

_LARGEST_SPEED = 1.0
"""Limit of the handle's speed [m/s]."""

_LARGEST_FORCE = 250.0
"""Limit of the sum of all effects [N]."""

_STOP_TIME = 0.02
"""Time constant of braking [s]."""

_SLOWEST_SLIDE = 1e-3
"""Speed below which friction is proportional to the speed, which avoids a jump at rest [m/s]."""


@kernel
def _spring(row: Vec, x: Vec, v: Vec, damping: float, f: Vec) -> None:
    """Compute the force of a spring, along its direction where it has one; zero inside the dead band."""
    along = row[DIRECTION] ** 2 + row[DIRECTION + 1] ** 2 + row[DIRECTION + 2] ** 2
    pull, speed = np.empty(3), np.empty(3)
    for i in range(3):
        pull[i] = row[POS + i] - x[i]
        speed[i] = row[VEL + i] - v[i]
    if along > 0.0:
        share, rate = 0.0, 0.0
        for i in range(3):
            share += pull[i] * row[DIRECTION + i] / along
            rate += speed[i] * row[DIRECTION + i] / along
        for i in range(3):
            pull[i], speed[i] = share * row[DIRECTION + i], rate * row[DIRECTION + i]
    length = norm(pull)
    stretched = max(0.0, length - row[DEADBAND])
    for i in range(3):
        f[i] = (row[STIFFNESS] * stretched * pull[i] / length if length > 0.0 else 0.0) + damping * speed[i]
    if row[MAX_FORCE] > 0.0:
        clamp_norm(f, row[MAX_FORCE])


@kernel
def _block_surface(row: Vec, x: Vec, normal: Vec) -> float:
    """Return the penetration depth at the nearest face of a box [m], not positive outside; write its normal."""
    depth, face = math.inf, 0
    for i in range(3):
        below = 0.5 * row[SIZE + i] - abs(x[i] - row[POS + i])
        if below < depth:
            depth, face = below, i
    fill(normal, 0.0)
    normal[face] = 1.0 if x[face] >= row[POS + face] else -1.0
    return depth


@kernel
def _round_surface(row: Vec, x: Vec, axes: int, normal: Vec) -> float:
    """Return the penetration depth in a sphere (axes = 3) or an upright cylinder's mantle (2) [m]; write its normal."""
    fill(normal, 0.0)
    for i in range(axes):
        normal[i] = x[i] - row[POS + i]
    distance = norm(normal)
    for i in range(3):
        normal[i] = normal[i] / distance if distance > 0.0 else 1.0 if i == 0 else 0.0
    return row[SIZE] - distance


@kernel
def _surface(row: Vec, x: Vec, normal: Vec) -> float:
    """Return the penetration depth in an object [m]; write the normal of its surface."""
    kind = int(row[KIND])
    if kind == BLOCK:
        return _block_surface(row, x, normal)
    if kind == SPHERE:
        return _round_surface(row, x, 3, normal)
    if kind == CYLINDER:
        depth = _round_surface(row, x, 2, normal)
        lid = 0.5 * row[SIZE + 1] - abs(x[2] - row[POS + 2])
        if lid < depth:
            fill(normal, 0.0)
            normal[2] = 1.0 if x[2] >= row[POS + 2] else -1.0
        return min(depth, lid)
    length, depth = norm(row[FORCE : FORCE + 3]), 0.0
    for i in range(3):
        normal[i] = row[FORCE + i] / length if length > 0.0 else 1.0 if i == 2 else 0.0
        depth += (row[POS + i] - x[i]) * normal[i]
    return depth


@kernel
def _object(row: Vec, x: Vec, v: Vec, damping: float, f: Vec) -> None:
    """Compute the force of an object: spring and damper along the normal, outward only, and friction."""
    normal = np.empty(3)
    depth = _surface(row, x, normal)
    fill(f, 0.0)
    if depth <= 0.0:
        return
    approach = 0.0
    for i in range(3):
        approach += (row[VEL + i] - v[i]) * normal[i]
    push = max(0.0, row[STIFFNESS] * depth + damping * approach)
    slide = np.empty(3)
    for i in range(3):
        slide[i] = row[VEL + i] - v[i] - approach * normal[i]
    speed = norm(slide)
    for i in range(3):
        f[i] = push * normal[i] + (row[FRICTION] * push * slide[i] / max(speed, _SLOWEST_SLIDE))


@kernel
def effects_force(effects: Mat, inertia: float, x: Vec, v: Vec, total: Vec) -> None:
    """Compute the sum of all enabled effects on the handle at x with velocity v [N], robot frame."""
    fill(total, 0.0)
    f = np.empty(3)
    for k in range(effects.shape[0]):
        row = effects[k]
        kind = int(row[KIND])
        if kind == 0 or row[ENABLED] == 0.0:
            continue
        damping = 2.0 * row[DAMP] * math.sqrt(row[STIFFNESS] * inertia)
        if kind == SPRING:
            _spring(row, x, v, damping, f)
        elif kind == DAMPER:
            for i in range(3):
                f[i] = -row[FORCE + i] * v[i]
        elif kind == BIAS:
            f[:] = row[FORCE : FORCE + 3]
        else:
            _object(row, x, v, damping, f)
        for i in range(3):
            total[i] += f[i]


@kernel
def step_machine(
    machine: Vec, memory: Vec, effects: Mat, inbox: Vec, data: Vec, command: Vec, active: bool, tick: int, steps: int
) -> None:
    """Run some controller steps of 0.4 ms.

    Args:
        machine: Memory of the controller, shape [MACHINE_LENGTH].
        memory: Simulated robot and person, built for RATE ticks per second.
        effects: Table of effects, shape [n, EFFECT].
        inbox: Inbox vector for the simulated person, shape [INBOX_LENGTH].
        data: Out: sensor data, shape [DATA_LENGTH].
        command: Scratch, shape [COMMAND_LENGTH].
        active: True in the state "force"; in any other the machine brakes.
        tick: Number of the first step.
        steps: Number of steps.
    """
    dt = 1.0 / RATE
    v, total = machine[VELOCITY : VELOCITY + 3], np.empty(3)
    command[COMMAND_ENABLED] = 1.0
    for k in range(steps):
        read_patient(memory, inbox, data, tick + k)
        q, d1 = memory[Q : Q + 3], memory[AXIS_OFFSET]
        tool_to_robot(q, data[DATA_FORCE : DATA_FORCE + 3], machine[MEASURED : MEASURED + 3])
        effects_force(effects, machine[INERTIA], memory[HANDLE : HANDLE + 3], v, total)
        clamp_norm(total, _LARGEST_FORCE)
        for i in range(3):
            if active:
                v[i] += dt * (machine[MEASURED + i] + total[i]) / machine[INERTIA]
            else:
                v[i] /= 1.0 + dt / _STOP_TIME
        slowing = machine[COULOMB] / machine[INERTIA] * dt
        speed = norm(v)
        clamp_norm(v, min(_LARGEST_SPEED, max(0.0, speed - slowing)))
        dq = command[COMMAND_DQ : COMMAND_DQ + 3]
        apply_inverse_jacobian(q, d1, v, dq)
        if brake_at_limits(q, memory[JOINT_MIN : JOINT_MIN + 3], memory[JOINT_MAX : JOINT_MAX + 3], dq):
            apply_jacobian(q, d1, dq, v)
        write_robot(memory, command, tick + k)
