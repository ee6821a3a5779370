"""Position controllers of a leg (D2.1 Figure 54): computed torque and PD, and the object stiffness that they allow.

    computed torque   tau = M(q) (q_d'' + 2 z w e' + w^2 e) + c(q, q') + g(q)      e = q_d - q
    PD                tau = K (e + 2 z / w e')

M includes the motors' masses at their shafts, m (d eta / d theta)^2. Computed torque cancels coupling and weight, so
that each joint's error decays alike; PD lags under weight and motion. A person who bears the own leg is not carried.

A rigid object is as stiff as the position controller holds the leg on its surface: a force on the foot along the normal
n moves it by n^T J K^-1 J^T n, and K_x = (J K_theta^-1 J^T)^-1. D2.1 4.3.4: the maximal position controller is also
"the maximal object stiffness".
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.rendering.haptic.kernels.leg_kinematics import leg_jacobian
from mimics_app.rendering.haptic.kernels.lokomat.linkage import lever
from mimics_app.rendering.haptic.kernels.two_link import LINKS, centrifugal, mass_matrix, weight

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import LegFrameRecord, PositionSettingsRecord

__all__ = ["POSITION_SETTINGS", "driven_mass", "foot_stiffness", "position_torques", "servo_stiffness"]

POSITION_SETTINGS = np.dtype(
    [
        ("links", np.float64, LINKS),  # leg and its part of the orthosis (`two_link`), without motors
        ("carried", np.float64, LINKS),  # the part whose weight the drives carry: all of it, or the orthosis alone
        ("motor", np.float64, 2),  # mass of rotor and spindle along the shaft [kg]
        ("bandwidth", np.float64),  # w [rad/s]
        ("ratio", np.float64),  # damping ratio z
        ("stiffness", np.float64, 2),  # K of PD [N m/rad]
        ("computed", np.int64),  # 1: computed torque, 0: PD
    ],
    align=True,
)


@kernel
def driven_mass(settings: PositionSettingsRecord, leg: LegFrameRecord, q: Vec) -> tuple[float, float, float]:
    """Entries m11, m12, m22 of the mass matrix of leg, orthosis and motors [kg m^2]."""
    m11, m12, m22 = mass_matrix(settings.links, math.cos(q[1]))
    hip, knee = lever(leg.links[0], q[0]), lever(leg.links[1], q[1])
    return m11 + settings.motor[0] * hip * hip, m12, m22 + settings.motor[1] * knee * knee


@kernel
def servo_stiffness(settings: PositionSettingsRecord, leg: LegFrameRecord, q: Vec) -> tuple[float, float, float]:
    """Entries k11, k12, k22 of K_theta, torque per error of the joints [N m/rad]."""
    if settings.computed == 0:
        return settings.stiffness[0], 0.0, settings.stiffness[1]
    m11, m12, m22 = driven_mass(settings, leg, q)
    square = settings.bandwidth * settings.bandwidth
    return square * m11, square * m12, square * m22


@kernel
def position_torques(
    settings: PositionSettingsRecord,
    leg: LegFrameRecord,
    q: Vec,
    dq: Vec,
    wish: Vec,
    wish_rate: Vec,
    wish_change: Vec,
    tau: Vec,
) -> None:
    """Set the torques that lead a leg to wanted joints.

    Args:
        settings: POSITION_SETTINGS record.
        leg: LEG_FRAME record.
        q: Joint angles [rad], shape [2] like all below.
        dq: Their velocities [rad/s].
        wish: q_d [rad].
        wish_rate: q_d' [rad/s].
        wish_change: q_d'' [rad/s^2], for computed torque.
        tau: Out: torques [N m].
    """
    k11, k12, k22 = servo_stiffness(settings, leg, q)
    lag = 2.0 * settings.ratio / settings.bandwidth
    a = wish[0] - q[0] + lag * (wish_rate[0] - dq[0])
    b = wish[1] - q[1] + lag * (wish_rate[1] - dq[1])
    tau[0], tau[1] = k11 * a + k12 * b, k12 * a + k22 * b
    if settings.computed == 1:
        m11, m12, m22 = driven_mass(settings, leg, q)
        c1, c2 = centrifugal(settings.links, math.sin(q[1]), dq[0], dq[1])
        g1, g2 = weight(settings.carried, q[0], q[1])
        tau[0] += m11 * wish_change[0] + m12 * wish_change[1] + c1 + g1
        tau[1] += m12 * wish_change[0] + m22 * wish_change[1] + c2 + g2


@kernel
def foot_stiffness(
    settings: PositionSettingsRecord, leg: LegFrameRecord, q: Vec, normal_x: float, normal_z: float
) -> float:
    """Stiffness [N/m] of the foot against a force along a unit normal: 1 / (n^T J K_theta^-1 J^T n)."""
    k11, k12, k22 = servo_stiffness(settings, leg, q)
    x1, x2, z1, z2 = leg_jacobian(leg.geometry, q)
    hip, knee = normal_x * x1 + normal_z * z1, normal_x * x2 + normal_z * z2
    return (k11 * k22 - k12 * k12) / (k22 * hip * hip - 2.0 * k12 * hip * knee + k11 * knee * knee)
