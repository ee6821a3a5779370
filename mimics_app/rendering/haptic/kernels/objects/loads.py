"""What pulls at the bodies beside their contacts: weight, F_aux, T_aux; and which sleeper wakes by it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.kernel import kernel
from mimics_app.rendering.haptic.kernels.objects.bodies import wake
from mimics_app.rendering.haptic.kernels.vectors import copy

if TYPE_CHECKING:
    from mimics_app.contracts.record_types import BodyRecord, DynamicsRecord, Floats, MotionRecord, Table

__all__ = ["load_bodies"]


_SAME_LOAD = 1e-9
"""A load that differs by this share from the one a body fell asleep under wakes it."""


@kernel
def _differs(a: Vec, b: Vec) -> bool:
    """True when a is not b, but for rounding."""
    square, apart = 0.0, 0.0
    for i in range(3):
        square += b[i] * b[i]
        apart += (a[i] - b[i]) * (a[i] - b[i])
    return apart > _SAME_LOAD * _SAME_LOAD * square


@kernel
def load_bodies(
    bodies: Table[BodyRecord],
    motions: Table[MotionRecord],
    dynamics: Table[DynamicsRecord],
    aux_forces: Floats,
    aux_torques: Floats,
    count: int,
) -> None:
    """Add F_aux, T_aux and weight to what touch, effects and grip gathered; a sleeper that feels anything new wakes.

    Args:
        bodies: BODY rows.
        motions: MOTION rows, updated.
        dynamics: DYNAMICS rows, updated.
        aux_forces: ObjectWork.aux_forces.
        aux_torques: ObjectWork.aux_torques.
        count: Bodies in use.
    """
    for k in range(count):
        body, motion, dynamic = bodies[k], motions[k], dynamics[k]
        for i in range(3):
            motion.force[i] += aux_forces[k, i] + body.mass * body.gravity[i]
            motion.torque[i] += aux_torques[k, i]
        if motion.asleep:
            felt = _differs(motion.force, dynamic.rest_force) or _differs(motion.torque, dynamic.rest_torque)
            if not (felt or motion.touched):
                continue
            wake(motion)
        copy(motion.force, dynamic.rest_force)
        copy(motion.torque, dynamic.rest_torque)
        dynamic.stirred = 0
