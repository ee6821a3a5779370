"""Equations of D2.1 as printed, each with the fault that its corrected form in the loop describes: for demonstration.

None of them is reached by a session.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import F8, Vec
from mimics_app.lab.haptic.friction_laws import sliding_speed
from mimics_app.lab.haptic.rotation_updates import three_turns
from mimics_app.rendering.haptic.kernels.contact import hold_face, in_box, leave
from mimics_app.rendering.haptic.kernels.rotation import product, store_unit

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import ContactRecord

__all__ = [
    "cube_printed",
    "joint_pd_printed",
    "pair_force_printed",
    "regularised_printed",
    "rotate_printed",
    "spring_damper_printed",
]


@kernel
def joint_pd_printed(q: Vec, dq: Vec, target: Vec, kp: Vec, kd: Vec, command: Vec) -> None:
    """(5) as printed, Kp (q - q_r): it diverges. Arguments as `joint_pd`."""
    for i in range(3):
        command[i] = kp[i] * (q[i] - target[i]) - kd[i] * dq[i]


@kernel
def spring_damper_printed(depth: float, rate: float, k: float, b: float) -> float:
    """Normal force [N] of (9) as printed, taken as the force on the user: without clamp it pulls on the way out.

    A free mass rebounds with exp(-pi zeta / sqrt(1 - zeta^2)) of its speed instead of
    exp(-2 zeta arccos(zeta) / sqrt(1 - zeta^2)).
    """
    if depth <= 0.0:
        return 0.0
    return k * depth + b * rate


@kernel
def rotate_printed(q: F8, momentum: Vec, inverse_inertia: Vec, dt: float) -> None:
    """Rotate q by (12) as printed: phi' = I^-1 L with constant I, dR = rot(x) rot(y) rot(y).

    Arguments as `rotate_exponential`.
    """
    x = dt * inverse_inertia[0] * momentum[0]
    y = dt * inverse_inertia[1] * momentum[1]
    store_unit(product(three_turns(x, y, y, False), (q[0], q[1], q[2], q[3])), q)


@kernel
def cube_printed(p: Vec, dimensions: Vec, contact: ContactRecord) -> None:
    """Test a box by the face of (14) as printed, the smallest |HIP'_i| - dim_i/2: the farthest one."""
    if not in_box(p, dimensions):
        leave(p, contact)
        return
    farthest = 0
    for i in range(1, 3):
        if abs(p[i]) - 0.5 * dimensions[i] < abs(p[farthest]) - 0.5 * dimensions[farthest]:
            farthest = i
    contact.feature = farthest + 1 if p[farthest] >= 0.0 else -farthest - 1
    hold_face(p, dimensions, contact)


@kernel
def pair_force_printed(depth: float, approach: float, k: float, b: float) -> float:
    """Normal force [N] of (17) as printed, n from body 1 to body 2: k_s d - b_s v_d.n.

    Bodies separate exp(+pi zeta / sqrt(1 - zeta^2)) times faster than they approached.
    """
    if depth <= 0.0:
        return 0.0
    return k * depth - b * approach


@kernel
def regularised_printed(v: Vec, normal_force: float, mu: float, threshold: float, out: Vec) -> None:
    """4.3.2 as printed, without the minus sign: it drives the foot."""
    gain = mu * normal_force / max(sliding_speed(v), threshold)
    for i in range(out.shape[0]):
        out[i] = gain * v[i]
