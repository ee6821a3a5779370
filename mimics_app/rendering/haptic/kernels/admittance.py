"""Admittance control (D2.1 4.2.7, equations 6 and 7): force in, motion out, in three forms.

Forces are one vector in the tool frame (radial, tangential, vertical): F = F_meas + Rz(q2)^T F_virt, where F_virt acts
on the user (minus the force on the object of equation 11). The printed equations call the forces scalars; equation 6
takes the radial and the vertical component, equation 7 the tangential one.

    seed       r'' = F_r / m,                  phi'' = F_t / (m r)
    polar      r'' = F_r / m + r phi'^2,       phi'' = F_t / (m r) - 2 r' phi' / r
    cartesian  x'' = F / m in the robot frame, q' = J^-1 x'

A point mass needs the two coupling terms that (6, 7) omit: at phi' = 1 rad/s, r = 0.46 m and 3 kg the missing force is
1.4 N radially and, at r' = 0.2 m/s, 1.2 N tangentially; a free mass then gains energy. The seed form is kept for
demonstration. The printed equations have no damping either, which stabilises contact with a stiffening arm where more
mass does not.
"""

from __future__ import annotations

from typing import NamedTuple

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.loop.haptic import AdmittanceForm
from mimics_app.maths.vec import clamp_norm, norm, scale
from mimics_app.rendering.haptic.kernels.kinematics import (
    apply_inverse_jacobian,
    apply_jacobian,
    tool_to_robot,
)

__all__ = ["VirtualMass", "acceleration_cartesian", "acceleration_polar", "acceleration_seed", "admit", "limit_motion"]


class VirtualMass(NamedTuple):
    """The mass that a person moves, and the limits of its motion.

    Attributes:
        mass: Mass [kg]; at least 3 for an arm and handle of up to 2 kg.
        damping: Damping [N s/m].
        max_acceleration: Largest norm of the acceleration [m/s^2].
        max_velocity: Largest norm of the velocity [m/s].
    """

    mass: float
    damping: float
    max_acceleration: float
    max_velocity: float


@kernel
def acceleration_seed(q: Vec, f: Vec, mass: float, d1: float, ddq: Vec) -> None:
    """Joint accelerations [m/s^2, rad/s^2, m/s^2] as printed in (6) and (7), f [N] in the tool frame."""
    ddq[0] = f[0] / mass
    ddq[1] = f[1] / (mass * (q[0] + d1))
    ddq[2] = f[2] / mass


@kernel
def acceleration_polar(q: Vec, dq: Vec, f: Vec, mass: float, d1: float, ddq: Vec) -> None:
    """Joint accelerations of a point mass: (6) and (7) with their coupling terms, f [N] in the tool frame."""
    r = q[0] + d1
    ddq[0] = f[0] / mass + r * dq[1] * dq[1]
    ddq[1] = f[1] / (mass * r) - 2.0 * dq[0] * dq[1] / r
    ddq[2] = f[2] / mass


@kernel
def acceleration_cartesian(q: Vec, f: Vec, mass: float, a: Vec) -> None:
    """Acceleration [m/s^2] of a point mass in the robot frame, f [N] in the tool frame."""
    tool_to_robot(q, f, a)
    scale(a, 1.0 / mass)


@kernel
def limit_motion(v_last: Vec, max_acceleration: float, max_velocity: float, dt: float, v: Vec) -> None:
    """Limit the change from v_last to v and the length of v, both by scaling whole vectors.

    Clamping joint by joint, as the masks of D2.1 suggest, would change the direction of the motion.
    """
    for i in range(3):
        v[i] -= v_last[i]
    clamp_norm(v, max_acceleration * dt)
    for i in range(3):
        v[i] += v_last[i]
    clamp_norm(v, max_velocity)


@kernel
def admit(
    form: int,
    q: Vec,
    f: Vec,
    virtual: VirtualMass,
    d1: float,
    dt: float,
    scratch: Vec,
    v: Vec,
    dq: Vec,
) -> None:
    """Advance the virtual mass by one tick (semi-implicit Euler) and compute the joint velocities to send.

    Args:
        form: AdmittanceForm.
        q: Measured joints.
        f: Sum of the forces on the mass, tool frame [N].
        virtual: Virtual mass and its limits.
        d1: Axis offset [m].
        dt: Tick [s].
        scratch: Shape [3].
        v: Velocity of the mass, robot frame [m/s]; state of the Cartesian form, output of the others.
        dq: Joint velocities; state of the polar and seed forms, output of the Cartesian one.
    """
    mass, damping, max_acceleration, max_velocity = virtual
    if form == AdmittanceForm.CARTESIAN:
        acceleration_cartesian(q, f, mass, scratch)
        for i in range(3):
            scratch[i] -= damping / mass * v[i]
        clamp_norm(scratch, max_acceleration)
        for i in range(3):
            v[i] += dt * scratch[i]
        clamp_norm(v, max_velocity)
        apply_inverse_jacobian(q, d1, v, dq)
        return
    if form == AdmittanceForm.SEED:
        acceleration_seed(q, f, mass, d1, scratch)
    else:
        acceleration_polar(q, dq, f, mass, d1, scratch)
    for i in range(3):
        scratch[i] -= damping / mass * dq[i]
    _shorten_joint_acceleration(q, d1, max_acceleration, scratch, v)
    for i in range(3):
        dq[i] += dt * scratch[i]
    apply_jacobian(q, d1, dq, v)
    scale(dq, clamp_norm(v, max_velocity))


@kernel
def _shorten_joint_acceleration(q: Vec, d1: float, limit: float, ddq: Vec, work: Vec) -> None:
    """Scale ddq so that the Cartesian acceleration J ddq it adds is at most `limit` [m/s^2]."""
    apply_jacobian(q, d1, ddq, work)
    length = norm(work)
    if length > limit:
        scale(ddq, limit / length)
