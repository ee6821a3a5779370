"""World space PD controller (D2.1 4.2.6): through inverse kinematics, as D2.1 has it, or along a straight path."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.loop.device_descriptor import Kin, KinematicsStatus
from mimics_app.maths.vec import clamp_joints, copy
from mimics_app.rendering.haptic.control.joint_pd import joint_pd
from mimics_app.rendering.haptic.kernels.joints import joints_of, points_of, rates_of, velocities_of

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import ControlInputRecord, ControlWorkRecord

__all__ = ["world_pd_straight", "world_pd_through_joints"]


@kernel
def world_pd_through_joints(
    kin: Kin, now: ControlInputRecord, kp: Vec, kd: Vec, work: ControlWorkRecord, command: Vec
) -> int:
    """Inverse kinematics (2), then joint PD (5), as in 4.2.6.

    Although D2.1 calls it world space, the gains are joint gains: equal ones give a straight line in joint space, on
    the HapticMaster an arc in the world: a sweep of +-0.5 rad at r = 0.46 m deviates r (1 - cos 0.5) = 56 mm from its
    chord. A target beyond the joint limits is approached as far as they allow.

    Args:
        kin: Kinematics functions of the device.
        now: CONTROL_INPUT record: joints and their limits, target of each point of contact, robot frame [m].
        kp: Gain per joint [1/s].
        kd: Gain per joint [-].
        work: CONTROL_WORK record; `reached` receives the joints of the target.
        command: Out: joint velocities.

    Returns:
        KinematicsStatus of the inverse, UNREACHABLE also for a target beyond a joint limit.
    """
    copy(now.q, work.reached)
    status = joints_of(kin, now, now.target, work, work.reached)
    outside = clamp_joints(work.reached, now.joint_min, now.joint_max)
    joint_pd(now.q, now.dq, work.reached, kp, kd, command)
    return KinematicsStatus.UNREACHABLE if outside != 0 else status


@kernel
def world_pd_straight(
    kin: Kin, now: ControlInputRecord, kp: Vec, kd: Vec, work: ControlWorkRecord, command: Vec
) -> int:
    """Command = J^-1 (Kp (x_r - x) - Kd v), gains per axis: equal ones give a straight line in the world.

    The deviation of the same sweep is 0.6 mm at Kp = 10 and 1 ms, first order in the step. Arguments as in
    `world_pd_through_joints`; returns SINGULAR where the device cannot move in some direction.
    """
    points_of(kin, now, now.q, work.place)
    velocities_of(kin, now, now.q, now.dq, work, work.forces)
    for row in range(3 * now.contacts):
        i = row % 3
        work.place[row] = kp[i] * (now.target[row] - work.place[row]) - kd[i] * work.forces[row]
    return rates_of(kin, now, now.q, work.place, work, command)
