"""Kinematics of any device: the closed form of its own functions where it has one, else from its Jacobian.

`kin` is the tuple of the device's functions in the order of contracts.loop.device_descriptor, `scene` a record with its
joints, contacts and geometry: SCENE, or CONTROL_INPUT in a controller. Points are concatenated, three numbers each.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.loop.device_descriptor import (
    FORWARD,
    INVERSE,
    JACOBIAN,
    RATES,
    TO_ROBOT,
    TORQUE,
    VELOCITY,
    Kin,
    KinematicsStatus,
)
from mimics_app.maths.vec import norm
from mimics_app.rendering.haptic.kernels.solve import solve_positive

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import ControlWorkRecord, Description

__all__ = [
    "find_jacobian",
    "joints_of",
    "points_of",
    "rates_of",
    "share_below",
    "to_robot",
    "torques_of",
    "velocities_of",
]


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
def points_of(kin: Kin, scene: Description, q: Vec, x: Vec) -> None:
    """Set x [m], shape [3 contacts or more], to the points at the joints q."""
    kin[FORWARD](scene.geometry[:], q[:], q[:], x[:])


@kernel
def find_jacobian(kin: Kin, scene: Description, q: Vec, work: ControlWorkRecord) -> None:
    """Set work.jacobian at the joints q."""
    kin[JACOBIAN](scene.geometry[:], q[:], q[:], work.jacobian[:])


@kernel
def velocities_of(kin: Kin, scene: Description, q: Vec, dq: Vec, work: ControlWorkRecord, v: Vec) -> None:
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
def share_below(contacts: int, velocities: Vec, limit: float) -> float:
    """Largest common factor 0-1 that brings the speed of every point within `limit` [m/s]."""
    share = 1.0
    for c in range(contacts):
        speed = norm(velocities[3 * c : 3 * c + 3])
        if speed > limit:
            share = min(share, limit / speed)
    return share


@kernel
def torques_of(kin: Kin, scene: Description, q: Vec, f: Vec, work: ControlWorkRecord, tau: Vec) -> None:
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
def _product(work: ControlWorkRecord, rows: int, joints: int, a: int, b: int, of_rows: bool) -> float:
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
def _least_squares(scene: Description, work: ControlWorkRecord, v: Vec, dq: Vec) -> int:
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
def rates_of(kin: Kin, scene: Description, q: Vec, v: Vec, work: ControlWorkRecord, dq: Vec) -> int:
    """Set dq = J^-1 v for velocities v of all points [m/s], or the nearest; SINGULAR where a direction is lost."""
    status = kin[RATES](scene.geometry[:], q[:], v[:], dq[:])
    if status != KinematicsStatus.NOT_GIVEN:
        return status
    find_jacobian(kin, scene, q, work)
    return _least_squares(scene, work, v, dq)


@kernel
def _position_error(kin: Kin, scene: Description, x: Vec, q: Vec, work: ControlWorkRecord) -> float:
    """Set work.place to x minus the points at q; return its largest component [m]."""
    points_of(kin, scene, q, work.place)
    largest = 0.0
    for row in range(3 * scene.contacts):
        work.place[row] = x[row] - work.place[row]
        largest = max(largest, abs(work.place[row]))
    return largest


@kernel
def joints_of(kin: Kin, scene: Description, x: Vec, work: ControlWorkRecord, q: Vec) -> int:
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
def to_robot(kin: Kin, scene: Description, q: Vec, f: Vec, out: Vec) -> None:
    """Set out to the forces f on the points, from their sensor frames to the robot frame; out must not be f."""
    if kin[TO_ROBOT](scene.geometry[:], q[:], f[:], out[:]) == KinematicsStatus.NOT_GIVEN:
        for row in range(3 * scene.contacts):
            out[row] = f[row]
