"""Loads on the bodies other than contacts, weight, F_aux and T_aux, and the waking of sleepers by a changed load."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.rendering.haptic.kernels.objects.bodies import wake
from mimics_app.rendering.haptic.kernels.vectors import copy

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import ObjectCountsRecord, ObjectWork, Rows

__all__ = ["load_bodies"]


_SAME_LOAD = 1e-9
"""Relative change of the load on a sleeping body from which it wakes [-]."""


@kernel
def _differs(a: Vec, b: Vec) -> bool:
    """True when a differs from b by more than rounding."""
    square, apart = 0.0, 0.0
    for i in range(3):
        square += b[i] * b[i]
        apart += (a[i] - b[i]) * (a[i] - b[i])
    return apart > _SAME_LOAD * _SAME_LOAD * square


@kernel
def load_bodies(rows: Rows, work: ObjectWork, counts: ObjectCountsRecord) -> None:
    """Add F_aux, T_aux and weight to the forces of touch, effects and grip; a changed load wakes a sleeping body.

    Args:
        rows: `Rows` of this tick.
        work: `ObjectWork`; motions and dynamics are updated.
        counts: SCENE.objects.
    """
    for k in range(counts.bodies):
        body, motion, dynamic = rows.bodies[k], work.motions[k], work.dynamics[k]
        for i in range(3):
            motion.force[i] += work.aux_forces[k, i] + body.mass * body.gravity[i]
            motion.torque[i] += work.aux_torques[k, i]
        if motion.asleep:
            changed = _differs(motion.force, dynamic.rest_force) or _differs(motion.torque, dynamic.rest_torque)
            if not (changed or motion.touched):
                continue
            wake(motion)
        copy(motion.force, dynamic.rest_force)
        copy(motion.torque, dynamic.rest_torque)
        dynamic.stirred = 0
