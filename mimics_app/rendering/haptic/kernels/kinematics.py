"""Kinematics of the HapticMaster (D2.1 equations 1-4).

Joints q = (q1 [m] radial, q2 [rad] about the vertical axis, q3 [m] vertical), shape [3]. The robot frame (WCS) lies in
the centre of the workspace: x radial at q2 = 0, y lateral, z up. r = q1 + d1 is the distance from the rotation axis,
d1 = stroke / 2 + offset (0.46 m for 0.36 m of stroke and 0.28 m of offset). The tool frame (TCS) rotates with q2: its
axes are radial, tangential, vertical.
"""

from __future__ import annotations

import math

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Mat, Vec

__all__ = [
    "apply_inverse_jacobian",
    "apply_jacobian",
    "apply_jacobian_transposed",
    "forward",
    "inverse",
    "jacobian",
    "robot_to_tool",
    "tool_to_robot",
]


_SMALLEST_RADIUS = 1e-9
"""Distance from the rotation axis below which q2 is undefined [m]."""


@kernel
def forward(q: Vec, d1: float, x: Vec) -> None:
    """Set x [m] to the position in the robot frame (equation 1): x = r cos q2 - d1, y = r sin q2, z = q3."""
    r = q[0] + d1
    x[0] = r * math.cos(q[1]) - d1
    x[1] = r * math.sin(q[1])
    x[2] = q[2]


@kernel
def inverse(x: Vec, d1: float, q: Vec) -> None:
    """Set q to the joints that reach x [m] (equation 2). On entry q holds the last joints.

    The printed q2 = arctg(y / (x + d1)) loses the quadrant behind the axis (x + d1 = -0.1, y = 0.05 gives -0.46 rad
    instead of 2.68) and divides by zero on it; atan2 has neither fault. On the axis itself q2 is undefined and the last
    one is kept.
    """
    radial = x[0] + d1
    r = math.sqrt(radial * radial + x[1] * x[1])
    q[0] = r - d1
    if r > _SMALLEST_RADIUS:
        q[1] = math.atan2(x[1], radial)
    q[2] = x[2]


@kernel
def jacobian(q: Vec, d1: float, J: Mat) -> None:
    """Set J = dp/dq, shape [3, 3] (equations 3, 4; partial derivatives, printed as total). det J = r, never singular.

    The middle column is in m/rad, the others are pure numbers: entries of J are not comparable.
    """
    c = math.cos(q[1])
    s = math.sin(q[1])
    r = q[0] + d1
    J[0, 0] = c
    J[0, 1] = -r * s
    J[1, 0] = s
    J[1, 1] = r * c
    J[2, 2] = 1.0
    J[0, 2] = J[1, 2] = J[2, 0] = J[2, 1] = 0.0


@kernel
def apply_jacobian(q: Vec, d1: float, dq: Vec, v: Vec) -> None:
    """Set v = J dq: joint velocities to the velocity of the handle, robot frame [m/s]; v must not be dq."""
    c = math.cos(q[1])
    s = math.sin(q[1])
    tangential = (q[0] + d1) * dq[1]
    v[0] = c * dq[0] - s * tangential
    v[1] = s * dq[0] + c * tangential
    v[2] = dq[2]


@kernel
def apply_inverse_jacobian(q: Vec, d1: float, v: Vec, dq: Vec) -> None:
    """Set dq = J^-1 v; dq must not be v."""
    c = math.cos(q[1])
    s = math.sin(q[1])
    dq[0] = c * v[0] + s * v[1]
    dq[1] = (c * v[1] - s * v[0]) / (q[0] + d1)
    dq[2] = v[2]


@kernel
def apply_jacobian_transposed(q: Vec, d1: float, f: Vec, torque: Vec) -> None:
    """Set torque = J^T f = (F_r [N], r F_t [N m], F_z [N]) for a force f in the robot frame; torque must not be f."""
    robot_to_tool(q, f, torque)
    torque[1] *= q[0] + d1


@kernel
def tool_to_robot(q: Vec, a: Vec, out: Vec) -> None:
    """Set out to the vector a from the tool frame (r, t, z) in the robot frame; out must not be a."""
    c = math.cos(q[1])
    s = math.sin(q[1])
    out[0] = c * a[0] - s * a[1]
    out[1] = s * a[0] + c * a[1]
    out[2] = a[2]


@kernel
def robot_to_tool(q: Vec, a: Vec, out: Vec) -> None:
    """Set out to the vector a from the robot frame in the tool frame (r, t, z); out must not be a."""
    c = math.cos(q[1])
    s = math.sin(q[1])
    out[0] = c * a[0] + s * a[1]
    out[1] = c * a[1] - s * a[0]
    out[2] = a[2]
