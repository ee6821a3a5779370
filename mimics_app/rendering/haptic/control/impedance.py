"""Impedance control: motion in, force out, for devices that take forces and whose own inertia is small.

    F = F_virtual - b v

Gravity and inertia are the device's: nothing is done about them. The viscosity b is rendered, so that a light device
has damping to count on. To a trial's start the device is drawn by a spring and damper behind a reference that moves as
the PD controllers of D2.1 4.2.5 and 4.2.6 would move a robot that follows.
"""

from __future__ import annotations

import math

from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.kernel import kernel
from mimics_app.rendering.haptic.kernels.vectors import clamp_norm

__all__ = ["draw_along", "draw_joints"]


@kernel
def draw_along(
    x: Vec, v: Vec, v_reference: Vec, stiffness: float, damping: float, most: float, dt: float, reference: Vec, f: Vec
) -> None:
    """Force f [N] that draws the device behind a reference that moves on with v_reference.

    The reference waits for the device: it is never further away than where the spring alone reaches `most`.

    Args:
        x: Where the device is [m], shape [3], any frame.
        v: Its velocity [m/s].
        v_reference: Velocity of the reference [m/s].
        stiffness: Of the spring [N/m], > 0.
        damping: Of the damper [N s/m].
        most: Largest force [N].
        dt: Tick [s].
        reference: Where the reference is [m]; moved on.
        f: Force out.
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
    """Torques tau [N, N m] that draw the joints behind a reference that moves on with dq_reference; it waits for them.

    Spring, damper and limit are those of the points times the square, or the length, of each joint's lever to them, so
    that a pose in which the points cannot be moved holds no joint up.

    Args:
        q: Joints, shape [joints] or longer, as all that follow.
        dq: Their velocities.
        dq_reference: Velocities of the reference.
        jacobian: Of all points, row by row.
        rows: Its rows.
        gains: Stiffness [N/m] > 0, damping [N s/m], and largest force [N] at a point, shape [3].
        dt: Tick [s].
        reference: Where the reference is; moved on.
        tau: Torques out, shape [joints].
    """
    joints = tau.shape[0]
    for j in range(joints):
        square = 0.0
        for row in range(rows):
            square += jacobian[row * joints + j] ** 2
        stiffness, damping, most = gains[0] * square, gains[1] * square, gains[2] * math.sqrt(square)
        reach = most / stiffness if stiffness > 0.0 else 0.0
        gap = min(reach, max(-reach, reference[j] + dq_reference[j] * dt - q[j]))
        reference[j] = q[j] + gap
        tau[j] = min(most, max(-most, stiffness * gap + damping * (dq_reference[j] - dq[j])))
