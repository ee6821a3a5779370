"""World space PD controller (D2.1 4.2.6): the seed's way through the joints, and the straight way."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.kernel import kernel
from mimics_app.rendering.haptic.control.joint_pd import joint_pd
from mimics_app.rendering.haptic.kernels.kinematics import (
    apply_inverse_jacobian,
    apply_jacobian,
    forward,
    inverse,
)
from mimics_app.rendering.haptic.kernels.vectors import copy

__all__ = ["world_pd_straight", "world_pd_through_joints"]

Vec = NDArray[np.float64]


@kernel
def world_pd_through_joints(
    q: Vec, dq: Vec, target: Vec, kp: Vec, kd: Vec, d1: float, scratch: Vec, command: Vec
) -> None:
    """Inverse kinematics (2), then joint PD (5), as 4.2.6 describes.

    Although the mask says world space, the gains are joint gains: equal ones draw a straight line in (r, phi), which
    is an arc in the world. A sweep of +-0.5 rad at r = 0.46 m bows r (1 - cos 0.5) = 56 mm off its chord.

    Args:
        q: Joints [m, rad, m].
        dq: Joint velocities.
        target: Reference position, robot frame [m].
        kp: Gains [1/s] per joint.
        kd: Gains [-] per joint.
        d1: Axis offset [m].
        scratch: Shape [3], overwritten with the joints of the target.
        command: Joint velocities out.
    """
    copy(q, scratch)
    inverse(target, d1, scratch)
    joint_pd(q, dq, scratch, kp, kd, command)


@kernel
def world_pd_straight(q: Vec, dq: Vec, target: Vec, kp: Vec, kd: Vec, d1: float, scratch: Vec, command: Vec) -> None:
    """Command = J^-1 (Kp (x_r - x) - Kd v): with equal gains a straight line in the world. Arguments as above.

    The bow of the same sweep is 0.6 mm at Kp = 10 and 1 ms, first order in the step.
    """
    forward(q, d1, scratch)
    apply_jacobian(q, d1, dq, command)
    for i in range(3):
        scratch[i] = kp[i] * (target[i] - scratch[i]) - kd[i] * command[i]
    apply_inverse_jacobian(q, d1, scratch, command)
