"""Kinematics of any device: the closed form of its own functions where it has one, else from its Jacobian.

`kin` is the tuple of the device's functions in the order of contracts.loop.device_descriptor, `scene` the SCENE record
with its joints, contacts and geometry. Points are concatenated, three numbers each.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.loop.device_descriptor import (
    FORWARD,
    INVERSE,
    JACOBIAN,
    RATES,
    TO_ROBOT,
    TO_TOOL,
    TORQUE,
    VELOCITY,
    Kin,
    KinematicsStatus,
)
from mimics_app.contracts.loop.loop_fields import MAX_CONTACTS, MAX_JOINTS
from mimics_app.rendering.haptic.kernels.solve import solve_positive

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import JointWorkRecord, SceneRecord

__all__ = [
    "JOINT_WORK",
    "find_jacobian",
    "joints_of",
    "points_of",
    "rates_of",
    "to_robot",
    "to_tool",
    "torques_of",
    "velocities_of",
]


_ROWS = 3 * MAX_CONTACTS

JOINT_WORK = np.dtype(
    [
        ("points", "f8", (_ROWS,)),  # positions or targets of the points, robot frame [m]
        ("velocities", "f8", (_ROWS,)),  # of the points, robot frame [m/s]
        ("jacobian", "f8", (_ROWS * MAX_JOINTS,)),  # row by row
        ("matrix", "f8", (_ROWS * _ROWS,)),  # of the linear equations
        ("side", "f8", (_ROWS,)),  # right-hand side of the equations, then their solution
        ("place", "f8", (_ROWS,)),  # positions of the points, or their errors in an iteration of the inverse [m]
        ("step", "f8", (MAX_JOINTS,)),  # of the joints in an iteration of the inverse [m, rad]
        ("wish", "f8", (MAX_JOINTS,)),  # desired joint velocities [m/s, rad/s]
        ("reached", "f8", (MAX_JOINTS,)),  # joints of a position [m, rad]
        ("forces", "f8", (_ROWS,)),  # on the points, robot frame [N]
    ],
    align=True,
)
"""Working memory of the kinematics of one device."""


_DAMPING = 2e-3
"""Damping of the least squares [m/rad]: directions in which the joints move the points less than this are lost."""

_SINGULAR_RATIO = 1e-4
"""Smallest pivot over largest diagonal entry of J J^T (or J^T J) at a singular pose: 1 % of the largest lever arm."""

_STEPS = 60
"""Largest number of iterations of the inverse."""

_REACHED = 1e-9
"""Tolerance of a reached position [m]."""

_LONGEST_STEP = 0.5
"""Largest change of a joint in one iteration of the inverse [m, rad]."""


@kernel
def points_of(kin: Kin, scene: SceneRecord, q: Vec, x: Vec) -> None:
    """Set x [m], shape [3 contacts or more], to the points at the joints q."""
    kin[FORWARD](scene.geometry[:], q[:], q[:], x[:])


@kernel
def find_jacobian(kin: Kin, scene: SceneRecord, q: Vec, work: JointWorkRecord) -> None:
    """Set work.jacobian at the joints q."""
    kin[JACOBIAN](scene.geometry[:], q[:], q[:], work.jacobian[:])


@kernel
def velocities_of(kin: Kin, scene: SceneRecord, q: Vec, dq: Vec, work: JointWorkRecord, v: Vec) -> None:
    """Set v = J dq [m/s] of all points; v must not be dq."""
    if kin[VELOCITY](scene.geometry[:], q[:], dq[:], v[:]) != KinematicsStatus.NOT_GIVEN:
        return
    find_jacobian(kin, scene, q, work)
    joints = scene.joints
    for row in range(3 * scene.contacts):
        total = 0.0
        for j in range(joints):
            total += work.jacobian[row * joints + j] * dq[j]
        v[row] = total


@kernel
def torques_of(kin: Kin, scene: SceneRecord, q: Vec, f: Vec, work: JointWorkRecord, tau: Vec) -> None:
    """Set tau = J^T f [N, N m] of forces f on all points, robot frame [N]; tau must not be f."""
    if kin[TORQUE](scene.geometry[:], q[:], f[:], tau[:]) != KinematicsStatus.NOT_GIVEN:
        return
    find_jacobian(kin, scene, q, work)
    joints = scene.joints
    for j in range(joints):
        total = 0.0
        for row in range(3 * scene.contacts):
            total += work.jacobian[row * joints + j] * f[row]
        tau[j] = total


@kernel
def _product(work: JointWorkRecord, rows: int, joints: int, a: int, b: int, of_rows: bool) -> float:
    """Entry (a, b) of J J^T if `of_rows`, else of J^T J."""
    total = 0.0
    if of_rows:
        for j in range(joints):
            total += work.jacobian[a * joints + j] * work.jacobian[b * joints + j]
    else:
        for row in range(rows):
            total += work.jacobian[row * joints + a] * work.jacobian[row * joints + b]
    return total


@kernel
def _least_squares(scene: SceneRecord, work: JointWorkRecord, v: Vec, dq: Vec) -> int:
    """Set dq to the damped least-squares solution of least norm of J dq = v; SINGULAR where a direction is lost."""
    rows, joints = 3 * scene.contacts, scene.joints
    wide = rows < joints
    size = rows if wide else joints
    largest = 0.0
    for a in range(size):
        for b in range(size):
            work.matrix[a * size + b] = _product(work, rows, joints, a, b, wide)
        largest = max(largest, work.matrix[a * size + a])
    for a in range(size):
        work.matrix[a * size + a] += _DAMPING * _DAMPING
        total = 0.0
        for row in range(rows):
            total += 0.0 if wide else work.jacobian[row * joints + a] * v[row]
        work.side[a] = v[a] if wide else total
    pivot = solve_positive(work.matrix, work.side, size)
    for j in range(joints):
        total = 0.0
        for row in range(rows):
            total += work.jacobian[row * joints + j] * work.side[row] if wide else 0.0
        dq[j] = total if wide else work.side[j]
    return (
        KinematicsStatus.SINGULAR if pivot <= _SINGULAR_RATIO * largest + _DAMPING * _DAMPING else KinematicsStatus.DONE
    )


@kernel
def rates_of(kin: Kin, scene: SceneRecord, q: Vec, v: Vec, work: JointWorkRecord, dq: Vec) -> int:
    """Set dq = J^-1 v for velocities v of all points [m/s], or the nearest; SINGULAR where a direction is lost."""
    status = kin[RATES](scene.geometry[:], q[:], v[:], dq[:])
    if status != KinematicsStatus.NOT_GIVEN:
        return status
    find_jacobian(kin, scene, q, work)
    return _least_squares(scene, work, v, dq)


@kernel
def _position_error(kin: Kin, scene: SceneRecord, x: Vec, q: Vec, work: JointWorkRecord) -> float:
    """Set work.place to x minus the points at q; return its largest component [m]."""
    points_of(kin, scene, q, work.place)
    largest = 0.0
    for row in range(3 * scene.contacts):
        work.place[row] = x[row] - work.place[row]
        largest = max(largest, abs(work.place[row]))
    return largest


@kernel
def joints_of(kin: Kin, scene: SceneRecord, x: Vec, work: JointWorkRecord, q: Vec) -> int:
    """Set q to joints that bring the points to x [m], starting from q; UNREACHABLE: to the nearest found.

    Joint limits are ignored: the caller clamps to them.
    """
    status = kin[INVERSE](scene.geometry[:], q[:], x[:], q[:])
    if status != KinematicsStatus.NOT_GIVEN:
        return status
    last = math.inf
    for _ in range(_STEPS):
        if not _position_error(kin, scene, x, q, work) > _REACHED:
            return KinematicsStatus.DONE
        square = 0.0
        for row in range(3 * scene.contacts):
            square += work.place[row] * work.place[row]
        if square > last:  # overshoot: halve the step
            for j in range(scene.joints):
                work.step[j] *= 0.5
                q[j] -= work.step[j]
            continue
        last = square
        find_jacobian(kin, scene, q, work)
        _least_squares(scene, work, work.place, work.step)
        largest = 0.0
        for j in range(scene.joints):
            largest = max(largest, abs(work.step[j]))
        share = min(1.0, _LONGEST_STEP / largest) if largest > 0.0 else 0.0
        for j in range(scene.joints):
            work.step[j] *= share
            q[j] += work.step[j]
    return (
        KinematicsStatus.DONE
        if _position_error(kin, scene, x, q, work) <= math.sqrt(_REACHED)
        else KinematicsStatus.UNREACHABLE
    )


@kernel
def to_robot(kin: Kin, scene: SceneRecord, q: Vec, f: Vec, out: Vec) -> None:
    """Set out to the forces f on the points, from their sensor frames to the robot frame; out must not be f."""
    if kin[TO_ROBOT](scene.geometry[:], q[:], f[:], out[:]) == KinematicsStatus.NOT_GIVEN:
        for row in range(3 * scene.contacts):
            out[row] = f[row]


@kernel
def to_tool(kin: Kin, scene: SceneRecord, q: Vec, f: Vec, out: Vec) -> None:
    """Set out to the forces f on the points, from the robot frame to their sensor frames; out must not be f."""
    if kin[TO_TOOL](scene.geometry[:], q[:], f[:], out[:]) == KinematicsStatus.NOT_GIVEN:
        for row in range(3 * scene.contacts):
            out[row] = f[row]
