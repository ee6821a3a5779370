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
from mimics_app.rendering.haptic.kernels.vectors import copy

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import JointWorkRecord, SceneRecord, StateRecord, Table

__all__ = ["admit_joints"]


@kernel
def _coupling(kin: Kin, scene: SceneRecord, q: Vec, dq: Vec, dt: float, work: JointWorkRecord) -> None:
    """Write J' q' [m/s^2] of all points to work.place: their acceleration at constant joint velocities."""
    velocities_of(kin, scene, q, dq, work, work.velocities)
    for j in range(MAX_JOINTS):
        work.wish[j] = q[j] + dt * dq[j]
    velocities_of(kin, scene, work.wish, dq, work, work.place)
    for row in range(3 * scene.contacts):
        work.place[row] = (work.place[row] - work.velocities[row]) / dt


@kernel
def _forces(kin: Kin, scene: SceneRecord, states: Table[StateRecord], q: Vec, work: JointWorkRecord) -> None:
    """Write the measured plus virtual force on each point, robot frame [N], to work.forces; work.side is scratch."""
    for c in range(scene.contacts):
        copy(states[c].f_meas, work.side[3 * c : 3 * c + 3])
    to_robot(kin, scene, q, work.side, work.forces)
    for c in range(scene.contacts):
        for i in range(3):
            work.forces[3 * c + i] += states[c].f_user[i]


@kernel
def admit_joints(
    kin: Kin, scene: SceneRecord, states: Table[StateRecord], mass: float, damping: float, dt: float, dq: Vec
) -> None:
    """Advance the joint velocities dq by one tick (semi-implicit Euler).

    Args:
        kin: Kinematics functions of the device.
        scene: SCENE record: joints, points of contact, joint_inertia.
        states: STATE records: joints, measured forces and torques, forces on the user.
        mass: Virtual mass at each point [kg].
        damping: Virtual damping there [N s/m].
        dt: Tick [s].
        dq: Joint velocities [m/s, rad/s], shape [MAX_JOINTS].
    """
    state, work, joints = states[0], states[0].joint_work, scene.joints
    q = state.q
    _coupling(kin, scene, q, dq, dt, work)
    _forces(kin, scene, states, q, work)
    for row in range(3 * scene.contacts):
        work.forces[row] -= mass * work.place[row]
    torques_of(kin, scene, q, work.forces, work, work.step)
    find_jacobian(kin, scene, q, work)
    for a in range(joints):
        work.side[a] = dt * (work.step[a] + state.torque_meas[a]) + scene.joint_inertia[a] * dq[a]
        for b in range(joints):
            entry = 0.0
            for row in range(3 * scene.contacts):
                entry += work.jacobian[row * joints + a] * work.jacobian[row * joints + b]
            work.side[a] += mass * entry * dq[b]
            work.matrix[a * joints + b] = (mass + dt * damping) * entry
        work.matrix[a * joints + a] += scene.joint_inertia[a]
    solve_positive(work.matrix, work.side, joints)
    for a in range(joints):
        dq[a] = work.side[a]
