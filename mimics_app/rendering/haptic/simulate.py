"""One tick of all objects: signals in, forces on the user out, bodies advanced."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.compiled.kernel import typed_kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.loop.loop_fields import MAX_CONTACTS
from mimics_app.contracts.loop.object_rows import Rows
from mimics_app.maths.vec import all_finite
from mimics_app.rendering.haptic.kernels.objects.bodies import place_bodies, step_bodies
from mimics_app.rendering.haptic.kernels.objects.collisions import collide_bodies
from mimics_app.rendering.haptic.kernels.objects.force_effects import apply_effects
from mimics_app.rendering.haptic.kernels.objects.grip import grip_bodies
from mimics_app.rendering.haptic.kernels.objects.interaction_points import place_points
from mimics_app.rendering.haptic.kernels.objects.object_inputs import (
    INPUT_FORCE_MEASURED,
    INPUT_GRASP,
    INPUT_POSITION,
    INPUT_VELOCITY,
)
from mimics_app.rendering.haptic.kernels.objects.shape_poses import pose_shapes
from mimics_app.rendering.haptic.kernels.objects.totals import clear_totals
from mimics_app.rendering.haptic.kernels.objects.touch import touch_points
from mimics_app.rendering.haptic.kernels.objects.wires import carry_signals
from mimics_app.rendering.haptic.objects import SIMULATE, ObjectWork

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import Fields, ObjectCountsRecord

__all__ = ["simulate_objects"]


@typed_kernel(SIMULATE)
def simulate_objects(
    rows: Rows, work: ObjectWork, counts: ObjectCountsRecord, inputs: Vec, fields: Fields, dt: float, force: Vec
) -> None:
    """Simulate one tick of all objects.

    Args:
        rows: Tables of objects from the main thread.
        work: Advanced by one tick.
        counts: SCENE.objects.
        inputs: See kernels.objects.object_inputs, shape [INPUT_LENGTH].
        fields: Force fields by EFFECT.field.
        dt: Tick [s].
        force: Out: force of the objects on each point of contact, world [N], shape [3 * MAX_CONTACTS].
    """
    for each in range(work.totals.shape[0]):
        clear_totals(work.totals[each])
    carry_signals(rows, work, counts, inputs)
    place_bodies(rows, work, counts)
    pose_shapes(rows, work, counts)
    place_points(rows, work, counts, inputs[INPUT_POSITION:INPUT_VELOCITY], inputs[INPUT_VELOCITY:INPUT_FORCE_MEASURED])
    touch_points(rows, work, counts, dt)
    apply_effects(rows, work, counts, inputs, fields)
    for contact in range(MAX_CONTACTS):
        grip_bodies(rows, work, counts, contact, inputs[INPUT_GRASP + contact], dt)
    collide_bodies(rows, work, counts, dt)
    step_bodies(rows, work, counts, dt)
    for contact in range(MAX_CONTACTS):
        totals = work.totals[contact]
        for i in range(3):
            force[3 * contact + i] = totals.shape_force[i] + totals.effect_force[i] + totals.grip_force[i]
        work.totals[0].status = max(work.totals[0].status, totals.status)
    if not all_finite(force):
        work.totals[0].status = 1
