"""What a device's kinematics functions say, by their closed form where there is one, else from the Jacobian.

`kin` is the tuple of the device's functions in the order of contracts.device_descriptor, `scene` the SCENE record with
its joints, contacts and geometry. Points come one behind the other, three numbers each.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.device_descriptor import (
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
from mimics_app.contracts.kernel import kernel
from mimics_app.contracts.loop_fields import MAX_CONTACTS, MAX_JOINTS
from mimics_app.rendering.haptic.kernels.solve import solve_positive

if TYPE_CHECKING:
    from mimics_app.contracts.record_types import JointWorkRecord, SceneRecord

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
        ("points", "f8", (_ROWS,)),  # where the points are, or should be, robot frame [m]
        ("velocities", "f8", (_ROWS,)),  # their velocities [m/s]
        ("jacobian", "f8", (_ROWS * MAX_JOINTS,)),  # row by row
        ("matrix", "f8", (_ROWS * _ROWS,)),  # of the equations to solve
        ("side", "f8", (_ROWS,)),  # their right side, then their solution
        ("place", "f8", (_ROWS,)),  # where a step of an inverse leads
        ("step", "f8", (MAX_JOINTS,)),
        ("wish", "f8", (MAX_JOINTS,)),
        ("reached", "f8", (MAX_JOINTS,)),  # joints of a place
        ("forces", "f8", (_ROWS,)),  # on the points, robot frame [N]
    ],
    align=True,
)
"""Scratch of the kinematics of one device."""

_NOT_GIVEN = int(KinematicsStatus.NOT_GIVEN)
_DONE = int(KinematicsStatus.DONE)
_SINGULAR = int(KinematicsStatus.SINGULAR)
_UNREACHABLE = int(KinematicsStatus.UNREACHABLE)

_DAMPING = 2e-3
"""Of the damped least squares: a direction in which all joints together move a point less than this [m/rad] is lost."""

_SINGULAR_RATIO = 1e-4
"""Smallest over largest pivot of J J^T (or J^T J) below which a pose counts as singular: 1 % of the largest lever."""

_STEPS = 60
_REACHED = 1e-9
"""A place is reached within this [m]."""

_LONGEST_STEP = 0.5
"""Of one step of an inverse, largest joint [m, rad]."""


@kernel
def points_of(kin: Kin, scene: SceneRecord, q: Vec, x: Vec) -> None:
    """Points x [m], shape [3 contacts or more], of the joints q."""
    kin[FORWARD](scene.geometry[:], q[:], q[:], x[:])


@kernel
def find_jacobian(kin: Kin, scene: SceneRecord, q: Vec, work: JointWorkRecord) -> None:
    """work.jacobian at the joints q."""
    kin[JACOBIAN](scene.geometry[:], q[:], q[:], work.jacobian[:])


@kernel
def velocities_of(kin: Kin, scene: SceneRecord, q: Vec, dq: Vec, work: JointWorkRecord, v: Vec) -> None:
    """V = J dq [m/s] of all points; v is not dq."""
    if kin[VELOCITY](scene.geometry[:], q[:], dq[:], v[:]) != _NOT_GIVEN:
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
    """Tau = J^T f [N, N m] of forces f on all points, robot frame [N]; tau is not f."""
    if kin[TORQUE](scene.geometry[:], q[:], f[:], tau[:]) != _NOT_GIVEN:
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
    """Entry a, b of J J^T where `of_rows`, else of J^T J."""
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
    """Dq that comes nearest to J dq = v, damped; of many the smallest. SINGULAR where a direction is lost."""
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
    return _SINGULAR if pivot <= _SINGULAR_RATIO * largest + _DAMPING * _DAMPING else _DONE


@kernel
def rates_of(kin: Kin, scene: SceneRecord, q: Vec, v: Vec, work: JointWorkRecord, dq: Vec) -> int:
    """Dq = J^-1 v for velocities v of all points [m/s], or what comes nearest; SINGULAR where a direction is lost."""
    status = kin[RATES](scene.geometry[:], q[:], v[:], dq[:])
    if status != _NOT_GIVEN:
        return status
    find_jacobian(kin, scene, q, work)
    return _least_squares(scene, work, v, dq)


@kernel
def _missing(kin: Kin, scene: SceneRecord, x: Vec, q: Vec, work: JointWorkRecord) -> float:
    """work.place = x less where q leads; its largest component [m]."""
    points_of(kin, scene, q, work.place)
    most = 0.0
    for row in range(3 * scene.contacts):
        work.place[row] = x[row] - work.place[row]
        most = max(most, abs(work.place[row]))
    return most


@kernel
def joints_of(kin: Kin, scene: SceneRecord, x: Vec, work: JointWorkRecord, q: Vec) -> int:
    """Joints q that bring the points to x [m], from the joints q on entry; UNREACHABLE: the nearest that was found.

    Joint limits are not asked: what is beyond them the caller clamps and reports.
    """
    status = kin[INVERSE](scene.geometry[:], q[:], x[:], q[:])
    if status != _NOT_GIVEN:
        return status
    last = math.inf
    for _ in range(_STEPS):
        if not _missing(kin, scene, x, q, work) > _REACHED:
            return _DONE
        off = 0.0
        for row in range(3 * scene.contacts):
            off += work.place[row] * work.place[row]
        if off > last:  # the step led too far: half of it back
            for j in range(scene.joints):
                work.step[j] *= 0.5
                q[j] -= work.step[j]
            continue
        last = off
        find_jacobian(kin, scene, q, work)
        _least_squares(scene, work, work.place, work.step)
        most = 0.0
        for j in range(scene.joints):
            most = max(most, abs(work.step[j]))
        share = min(1.0, _LONGEST_STEP / most) if most > 0.0 else 0.0
        for j in range(scene.joints):
            work.step[j] *= share
            q[j] += work.step[j]
    return _DONE if _missing(kin, scene, x, q, work) <= math.sqrt(_REACHED) else _UNREACHABLE


@kernel
def to_robot(kin: Kin, scene: SceneRecord, q: Vec, f: Vec, out: Vec) -> None:
    """Forces on the points from the frames of their sensors to the robot frame; out is not f."""
    if kin[TO_ROBOT](scene.geometry[:], q[:], f[:], out[:]) == _NOT_GIVEN:
        for row in range(3 * scene.contacts):
            out[row] = f[row]


@kernel
def to_tool(kin: Kin, scene: SceneRecord, q: Vec, f: Vec, out: Vec) -> None:
    """Forces on the points from the robot frame to the frames of their sensors; out is not f."""
    if kin[TO_TOOL](scene.geometry[:], q[:], f[:], out[:]) == _NOT_GIVEN:
        for row in range(3 * scene.contacts):
            out[row] = f[row]
