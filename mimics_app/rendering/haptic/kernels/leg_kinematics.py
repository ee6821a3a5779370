"""Kinematics of planar legs with hip and knee joint; their points of contact are the feet.

Hip flexion t1 and knee flexion t2 are positive, 0 in standing. The frame has its origin between the hips, x forward, y
to the left, z up; a leg stays in its plane. With psi = t1 - t2 the foot is at

    x = l1 sin t1 + l2 sin psi + f cos psi        z = -l1 cos t1 - l2 cos psi + f sin psi

l1 is the thigh, l2 shank and height of the ankle, f the distance of the point of contact before the ankle. The distance
from knee to foot is l = hypot(l2, f), and det J = l1 l sin(t2 - delta) with delta = atan2(f, l2): at a knee flexion of
delta the leg is stretched from hip to foot and cannot move the foot along that line.
"""

from __future__ import annotations

import math

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec

__all__ = [
    "GEOMETRY",
    "HIP_WIDTH",
    "LEGS",
    "foot_drop",
    "foot_torques",
    "foot_velocity",
    "leg_jacobian",
    "leg_joints",
    "place_foot",
]


LEGS = 0  # number of legs
THIGH = 1  # l1 [m]
SHANK = 2  # l2 [m]
FOOT = 3  # f [m]
HIP_WIDTH = 4  # between the planes of two legs [m]
GEOMETRY = 5  # numbers in use

_OFF_PLANE = 1e-6
"""Largest distance of a reachable position from the plane of a leg [m]."""

_BEYOND = 1e-12
"""Tolerance of the knee's cosine beyond 1 [-]: round-off at full reach."""


@kernel
def _side(geometry: Vec, leg: int) -> float:
    """Lateral position y of the plane of a leg [m]: 0 for a single leg, of two the first on the left."""
    return 0.0 if geometry[LEGS] < 2.0 else geometry[HIP_WIDTH] * (0.5 - leg)


@kernel
def foot_drop(geometry: Vec, cos_1: float, sin_psi: float, cos_psi: float) -> float:
    """Depth -z of the foot below the hips [m], summed in the order whose rounding recordings hold."""
    return geometry[THIGH] * cos_1 - geometry[FOOT] * sin_psi + geometry[SHANK] * cos_psi


@kernel
def place_foot(geometry: Vec, leg: int, q: Vec, x: Vec) -> None:
    """Set x [m], shape [3], to the foot at the joints q of one leg [rad], shape [2]."""
    psi = q[0] - q[1]
    sin_psi, cos_psi = math.sin(psi), math.cos(psi)
    x[0] = geometry[THIGH] * math.sin(q[0]) + geometry[SHANK] * sin_psi + geometry[FOOT] * cos_psi
    x[1] = _side(geometry, leg)
    x[2] = -foot_drop(geometry, math.cos(q[0]), sin_psi, cos_psi)


@kernel
def leg_jacobian(geometry: Vec, q: Vec) -> tuple[float, float, float, float]:
    """Derivatives dx/dt1, dx/dt2, dz/dt1, dz/dt2 [m/rad] of one foot."""
    psi = q[0] - q[1]
    across = geometry[SHANK] * math.cos(psi) - geometry[FOOT] * math.sin(psi)
    along = geometry[SHANK] * math.sin(psi) + geometry[FOOT] * math.cos(psi)
    return geometry[THIGH] * math.cos(q[0]) + across, -across, geometry[THIGH] * math.sin(q[0]) + along, -along


@kernel
def foot_velocity(geometry: Vec, q: Vec, dq: Vec, v: Vec) -> None:
    """Set v = J dq [m/s], shape [3], of one foot."""
    x1, x2, z1, z2 = leg_jacobian(geometry, q)
    v[0] = x1 * dq[0] + x2 * dq[1]
    v[1] = 0.0
    v[2] = z1 * dq[0] + z2 * dq[1]


@kernel
def foot_torques(geometry: Vec, q: Vec, f: Vec, tau: Vec) -> None:
    """Set tau = J^T f [N m], shape [2], of a force f on one foot [N]; the hinges bear its lateral component."""
    x1, x2, z1, z2 = leg_jacobian(geometry, q)
    tau[0] = x1 * f[0] + z1 * f[2]
    tau[1] = x2 * f[0] + z2 * f[2]


@kernel
def leg_joints(geometry: Vec, leg: int, x: Vec, q: Vec) -> bool:
    """Set q to joints of one leg that bring its foot to x [m]; False where none do, then to the nearest position.

    The nearest position lies on the line from the hip to x. On entry q holds the last joints: the knee stays on its
    side of the stretched pose.
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
