"""Admittance control in joint space for any device: virtual masses at its points of contact.

    (m sum J^T J + I) q'' = sum J^T (f - b x' - m J' q') + tau,   x' = J q'

m and b are the virtual mass and damping of D2.1 4.2.7 at every point of contact, f the measured and virtual force on
it, tau the torques of the user at the joints, I the virtual inertia of the joints, the only one that acts in singular
directions. For three joints and one point this is the point mass of equations (6, 7) with their coupling terms. The
damping is implicit, and so stable at any value.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.loop.device_descriptor import Kin
from mimics_app.contracts.loop.loop_fields import MAX_JOINTS
from mimics_app.rendering.haptic.kernels.joints import find_jacobian, to_robot, torques_of, velocities_of
from mimics_app.rendering.haptic.kernels.solve import solve_positive

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import ControlInputRecord, ControlWorkRecord

__all__ = ["admit_joints"]


@kernel
def _coupling(kin: Kin, now: ControlInputRecord, dq: Vec, work: ControlWorkRecord) -> None:
    """Write J' q' [m/s^2] of all points to work.place: their acceleration at constant joint velocities."""
    velocities_of(kin, now, now.q, dq, work, work.velocities)
    for j in range(MAX_JOINTS):
        work.wish[j] = now.q[j] + now.dt * dq[j]
    velocities_of(kin, now, work.wish, dq, work, work.place)
    for row in range(3 * now.contacts):
        work.place[row] = (work.place[row] - work.velocities[row]) / now.dt


@kernel
def admit_joints(kin: Kin, now: ControlInputRecord, work: ControlWorkRecord, dq: Vec) -> None:
    """Advance the joint velocities dq by one tick (semi-implicit Euler).

    Args:
        kin: Kinematics functions of the device.
        now: CONTROL_INPUT record: joints, virtual mass and damping at each point, forces and torques.
        work: CONTROL_WORK record, scratch.
        dq: Joint velocities [m/s, rad/s], shape [MAX_JOINTS].
    """
    joints, mass, dt = now.joints, now.virtual_mass, now.dt
    _coupling(kin, now, dq, work)
    to_robot(kin, now, now.q, now.f_meas, work.forces)
    for row in range(3 * now.contacts):
        work.forces[row] += now.f_user[row]
        work.forces[row] -= mass * work.place[row]
    torques_of(kin, now, now.q, work.forces, work, work.step)
    find_jacobian(kin, now, now.q, work)
    for a in range(joints):
        work.side[a] = dt * (work.step[a] + now.torque_meas[a]) + now.joint_inertia[a] * dq[a]
        for b in range(joints):
            entry = 0.0
            for row in range(3 * now.contacts):
                entry += work.jacobian[row * joints + a] * work.jacobian[row * joints + b]
            work.side[a] += mass * entry * dq[b]
            work.matrix[a * joints + b] = (mass + dt * now.virtual_damping) * entry
        work.matrix[a * joints + a] += now.joint_inertia[a]
    solve_positive(work.matrix, work.side, joints)
    for a in range(joints):
        dq[a] = work.side[a]
