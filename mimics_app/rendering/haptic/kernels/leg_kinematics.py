"""Kinematics of planar legs: hip and knee each, one leg behind the other, touching with the foot.

Hip flexion t1 and knee flexion t2 are positive, 0 in standing. The frame has its origin between the hips, x forward, y
to the left, z up; a leg stays in its plane. With psi = t1 - t2 the foot is at

    x = l1 sin t1 + l2 sin psi + f cos psi        z = -l1 cos t1 - l2 cos psi + f sin psi

l1 the thigh, l2 shank and height of the ankle, f how far the point of contact lies before the ankle. From the knee to
the foot it is l = hypot(l2, f), and det J = l1 l sin(t2 - delta) with delta = atan2(f, l2): where the knee is bent by
delta the leg is stretched as far as the foot is concerned, and cannot move it along.
"""

from __future__ import annotations

import math

from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.kernel import kernel

__all__ = ["GEOMETRY", "LEGS", "foot_torques", "foot_velocity", "leg_jacobian", "leg_joints", "place_foot"]


LEGS = 0  # how many
THIGH = 1  # l1 [m]
SHANK = 2  # l2 [m]
FOOT = 3  # f [m]
HIP_WIDTH = 4  # between the planes of two legs [m]
GEOMETRY = 5  # numbers in use

_OFF_PLANE = 1e-6
"""A place this far beside the plane of a leg [m] is not reached."""

_BEYOND = 1e-12
"""Of the cosine of the knee: round-off at full reach is no lack of it."""


@kernel
def _side(geometry: Vec, leg: int) -> float:
    """Where the plane of a leg lies [m]: one leg in the middle, of two the first to the left."""
    return 0.0 if geometry[LEGS] < 2.0 else geometry[HIP_WIDTH] * (0.5 - leg)


@kernel
def place_foot(geometry: Vec, leg: int, q: Vec, x: Vec) -> None:
    """Foot x [m], shape [3], of the joints q of one leg [rad], shape [2]."""
    psi = q[0] - q[1]
    x[0] = geometry[THIGH] * math.sin(q[0]) + geometry[SHANK] * math.sin(psi) + geometry[FOOT] * math.cos(psi)
    x[1] = _side(geometry, leg)
    x[2] = geometry[FOOT] * math.sin(psi) - geometry[THIGH] * math.cos(q[0]) - geometry[SHANK] * math.cos(psi)


@kernel
def leg_jacobian(geometry: Vec, q: Vec) -> tuple[float, float, float, float]:
    """dx/dt1, dx/dt2, dz/dt1, dz/dt2 [m/rad] of one foot."""
    psi = q[0] - q[1]
    across = geometry[SHANK] * math.cos(psi) - geometry[FOOT] * math.sin(psi)
    along = geometry[SHANK] * math.sin(psi) + geometry[FOOT] * math.cos(psi)
    return geometry[THIGH] * math.cos(q[0]) + across, -across, geometry[THIGH] * math.sin(q[0]) + along, -along


@kernel
def foot_velocity(geometry: Vec, q: Vec, dq: Vec, v: Vec) -> None:
    """V = J dq [m/s], shape [3], of one foot."""
    x1, x2, z1, z2 = leg_jacobian(geometry, q)
    v[0] = x1 * dq[0] + x2 * dq[1]
    v[1] = 0.0
    v[2] = z1 * dq[0] + z2 * dq[1]


@kernel
def foot_torques(geometry: Vec, q: Vec, f: Vec, tau: Vec) -> None:
    """Tau = J^T f [N m], shape [2], of a force f on one foot [N]; what is across the plane the leg's hinges take."""
    x1, x2, z1, z2 = leg_jacobian(geometry, q)
    tau[0] = x1 * f[0] + z1 * f[2]
    tau[1] = x2 * f[0] + z2 * f[2]


@kernel
def leg_joints(geometry: Vec, leg: int, x: Vec, q: Vec) -> bool:
    """Joints q of one leg that bring its foot to x [m]; False where none do, then to the nearest place along the path.

    On entry q holds the last joints: the knee stays on its side of the stretched pose.
    """
    thigh, shank = geometry[THIGH], math.hypot(geometry[SHANK], geometry[FOOT])
    stretched = math.atan2(geometry[FOOT], geometry[SHANK])
    cosine = (x[0] * x[0] + x[2] * x[2] - thigh * thigh - shank * shank) / (2.0 * thigh * shank)
    reached = abs(cosine) <= 1.0 + _BEYOND and abs(x[1] - _side(geometry, leg)) <= _OFF_PLANE
    bent = math.acos(min(1.0, max(-1.0, cosine)))
    if q[1] < stretched:
        bent = -bent
    q[0] = math.atan2(x[0], -x[2]) + math.atan2(shank * math.sin(bent), thigh + shank * math.cos(bent))
    q[1] = bent + stretched
    return reached
