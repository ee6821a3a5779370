"""Impedance control: motion in, force out, for devices that take forces and have a small inertia.

    F = F_virtual - b v

Gravity and inertia of the device are not compensated. The viscosity b is rendered to give a light device a known
damping. To a trial's start a spring and damper draw the device behind a reference that moves as the PD controllers of
D2.1 4.2.5 and 4.2.6 command.
"""

from __future__ import annotations

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.rendering.haptic.kernels.limiter import lever_of
from mimics_app.rendering.haptic.kernels.vectors import clamp_norm

__all__ = ["draw_along", "draw_joints"]


@kernel
def draw_along(
    x: Vec, v: Vec, v_reference: Vec, stiffness: float, damping: float, most: float, dt: float, reference: Vec, f: Vec
) -> None:
    """Compute the force f [N] that draws the device behind a reference moving at v_reference.

    The reference waits for the device: its distance is at most the one at which the spring alone reaches `most`.

    Args:
        x: Position of the device [m], shape [3], any frame.
        v: Its velocity [m/s].
        v_reference: Velocity of the reference [m/s].
        stiffness: Stiffness of the spring [N/m], > 0.
        damping: Damping beside it [N s/m].
        most: Largest force [N].
        dt: Tick [s].
        reference: Position of the reference [m]; advanced.
        f: Out: force [N].
    """
    for i in range(3):
        f[i] = reference[i] + v_reference[i] * dt - x[i]
    clamp_norm(f, most / stiffness)
    for i in range(3):
        reference[i] = x[i] + f[i]
        f[i] = stiffness * f[i] + damping * (v_reference[i] - v[i])
    clamp_norm(f, most)


@kernel
def draw_joints(
    q: Vec, dq: Vec, dq_reference: Vec, jacobian: Vec, rows: int, gains: Vec, dt: float, reference: Vec, tau: Vec
) -> None:
    """Compute torques tau [N, N m] that draw the joints behind a reference moving at dq_reference; it waits for them.

    Stiffness and damping at the points are scaled by the square of each joint's lever arm to them, the force limit by
    its length, so that a singular pose blocks no joint.

    Args:
        q: Joints, shape [joints] or longer, like all vectors below.
        dq: Joint velocities.
        dq_reference: Joint velocities of the reference.
        jacobian: Jacobian of all points, row by row.
        rows: Number of its rows.
        gains: Stiffness [N/m] > 0, damping [N s/m], and largest force [N] at a point, shape [3].
        dt: Tick [s].
        reference: Joints of the reference; advanced.
        tau: Out: torques, shape [joints].
    """
    joints = tau.shape[0]
    for j in range(joints):
        lever = lever_of(jacobian, rows, joints, j)
        stiffness, damping, most = gains[0] * lever * lever, gains[1] * lever * lever, gains[2] * lever
        reach = most / stiffness if stiffness > 0.0 else 0.0
        gap = min(reach, max(-reach, reference[j] + dq_reference[j] * dt - q[j]))
        reference[j] = q[j] + gap
        tau[j] = min(most, max(-most, stiffness * gap + damping * (dq_reference[j] - dq[j])))
