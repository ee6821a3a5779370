"""Effects and force fields of one tick: their forces on the user, and the opposite on the bodies they belong to.

An effect acts between the user, at one point of contact of the device, and its place. The place is fixed in the world,
or moves with a body; then the body gets the opposite force there, as enabled by 4.2.8.2 (enable haptic force, enable
haptic torque). An effect on a body alone acts on its centre of mass about a place in the world, without a force on the
user.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.loop.haptic_objects import BodyFlag, EffectKind
from mimics_app.contracts.loop.loop_fields import MAX_CONTACTS
from mimics_app.contracts.loop.loop_ports import MAX_FIELDS
from mimics_app.maths.vec import copy, fill, rotate, rotate_back
from mimics_app.rendering.haptic.kernels.objects.effect_laws import (
    bound,
    brake,
    is_within,
    magnet,
    pull_back,
    push,
    shake,
    spring,
    stick_and_slip,
)
from mimics_app.rendering.haptic.kernels.objects.effect_paths import find_path, guide, pull_to_path
from mimics_app.rendering.haptic.kernels.objects.object_inputs import INPUT_POSITION, INPUT_TIME, INPUT_VELOCITY
from mimics_app.rendering.haptic.kernels.tunnel_state import restart_tracking

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import (
        BodyRecord,
        EffectMemoryRecord,
        EffectRecord,
        Fields,
        MotionRecord,
        ObjectCountsRecord,
        ObjectWork,
        Rows,
        TotalsRecord,
    )

__all__ = ["apply_effects"]


_FORCE_ON_OBJECT = int(BodyFlag.FORCE_ON_OBJECT)
_TORQUE_ON_OBJECT = int(BodyFlag.TORQUE_ON_OBJECT)

_FARTHEST = 1e6
"""Distance from the origin beyond which the closest point of a path is not searched [m]."""


@kernel
def _forget(memory: EffectMemoryRecord) -> None:
    """Clear the state of a disabled effect."""
    memory.quarantined = 0
    memory.sticking = 0
    restart_tracking(memory.path)


@kernel
def _place(
    effect: EffectRecord, work: ObjectWork, counts: ObjectCountsRecord, inputs: Vec, memory: EffectMemoryRecord
) -> None:
    """Set memory.p and memory.v relative to the effect's place: of its point of contact, or of the body acted on."""
    on_body = effect.on_body != 0
    position, velocity = INPUT_POSITION + 3 * effect.contact, INPUT_VELOCITY + 3 * effect.contact
    for i in range(3):
        memory.force[i] = 0.0
        memory.p[i] = inputs[position + i] - memory.position[i]
        memory.v[i] = inputs[velocity + i]
    memory.held = 0
    if not 0 <= effect.body < counts.bodies:
        return
    motion = work.motions[effect.body]
    if on_body:
        for i in range(3):
            memory.p[i] = motion.centre[i] - memory.position[i]
            memory.v[i] = motion.velocity[i]
        return
    for i in range(3):
        R = motion.rotation
        turned = R[i, 0] * memory.position[0] + R[i, 1] * memory.position[1] + R[i, 2] * memory.position[2]
        memory.arm[i] = motion.position[i] + turned - motion.centre[i]
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        spin = motion.omega[j] * memory.arm[k] - motion.omega[k] * memory.arm[j]
        memory.p[i] = inputs[position + i] - motion.centre[i] - memory.arm[i]
        memory.v[i] = inputs[velocity + i] - motion.velocity[i] - spin


@kernel
def _stick(effect: EffectRecord, work: ObjectWork, counts: ObjectCountsRecord, memory: EffectMemoryRecord) -> None:
    """Stick-slip in the frame of its anchor: that of the body if it acts between user and body, else the world."""
    if effect.on_body != 0 or not 0 <= effect.body < counts.bodies:
        stick_and_slip(effect, memory.p, memory)
        return
    R = work.motions[effect.body].rotation
    local = memory.damper
    rotate_back(R, memory.p, local)
    stick_and_slip(effect, local, memory)
    copy(memory.force, local)
    rotate(R, local, memory.force)


@kernel
def _along_path(effect: EffectRecord, work: ObjectWork, memory: EffectMemoryRecord) -> None:
    """Path spring and guidance; their path is fixed in the world."""
    far = 0.0
    for i in range(3):
        memory.p[i] += memory.position[i]
        far += abs(memory.p[i])
    if not (0 <= effect.path < work.paths.shape[0] and far < _FARTHEST):
        restart_tracking(memory.path)
        return
    path = work.paths[effect.path]
    if path.pieces < 1:
        return
    remaining = find_path(path, memory)
    if effect.kind == EffectKind.PATH_SPRING:
        pull_to_path(effect, memory)
    else:
        guide(effect, memory, remaining)


@kernel
def _call_field(effect: EffectRecord, work: ObjectWork, fields: Fields, t: float, memory: EffectMemoryRecord) -> None:
    """Force of a plug-in's compiled function, which gets copies of its inputs in arrays of its own."""
    if not (0 <= effect.field < MAX_FIELDS and is_within(effect, memory)):
        return
    p, v, out = work.field_vectors[0], work.field_vectors[1], work.field_vectors[2]
    copy(effect.parameters, work.field_parameters)
    copy(memory.p, p)
    copy(memory.v, v)
    fill(out, 0.0)
    fields[effect.field](work.field_parameters, p, v, t, out)
    copy(out, memory.force)
    bound(memory.force, memory.size)


@kernel
def _act(
    effect: EffectRecord,
    work: ObjectWork,
    counts: ObjectCountsRecord,
    fields: Fields,
    t: float,
    memory: EffectMemoryRecord,
) -> None:
    """Compute the force of the effect by its law."""
    kind = effect.kind
    if kind == EffectKind.SPRING:
        spring(effect, memory)
    elif kind == EffectKind.VISCOSITY:
        brake(effect, memory)
    elif kind == EffectKind.CONSTANT:
        push(effect, memory)
    elif kind == EffectKind.MAGNET:
        magnet(effect, memory)
    elif kind == EffectKind.VIBRATION:
        shake(effect, memory, t)
    elif kind == EffectKind.STICK_SLIP:
        _stick(effect, work, counts, memory)
    elif kind == EffectKind.WORKSPACE:
        pull_back(effect, memory)
    elif kind == EffectKind.PATH_SPRING or kind == EffectKind.GUIDANCE:
        _along_path(effect, work, memory)
    elif kind == EffectKind.FIELD:
        _call_field(effect, work, fields, t, memory)


@kernel
def _waits_for_touch(effect: EffectRecord, work: ObjectWork, counts: ObjectCountsRecord) -> bool:
    """True for vibration and stick-slip of a body that the effect's point of contact does not touch."""
    of_body = 0 <= effect.body < counts.bodies and effect.on_body == 0
    surface = effect.kind == EffectKind.VIBRATION or effect.kind == EffectKind.STICK_SLIP
    return of_body and surface and (work.motions[effect.body].touched >> effect.contact) & 1 == 0


@kernel
def _add_to_body(body: BodyRecord, motion: MotionRecord, memory: EffectMemoryRecord, totals: TotalsRecord) -> None:
    """Add the effect's force to the user, and its opposite to the body it moves with."""
    for i in range(3):
        totals.effect_force[i] += memory.force[i]
        motion.force_user[i] += memory.force[i]
    if body.flags & _FORCE_ON_OBJECT:
        for i in range(3):
            motion.force[i] -= memory.force[i]
    if body.flags & _TORQUE_ON_OBJECT:
        for i in range(3):
            j, k = (i + 1) % 3, (i + 2) % 3
            motion.torque[i] -= memory.arm[j] * memory.force[k] - memory.arm[k] * memory.force[j]


@kernel
def _deliver(
    effect: EffectRecord, rows: Rows, work: ObjectWork, counts: ObjectCountsRecord, memory: EffectMemoryRecord
) -> None:
    """Add the force to the totals of the user and to the body of the effect."""
    totals = work.totals[effect.contact]
    of_body = 0 <= effect.body < counts.bodies
    if effect.on_body != 0:
        if of_body:
            for i in range(3):
                work.motions[effect.body].force[i] += memory.force[i]
        return
    if of_body:
        _add_to_body(rows.bodies[effect.body], work.motions[effect.body], memory, totals)
    else:
        for i in range(3):
            totals.effect_force[i] += memory.force[i]
    if effect.kind == EffectKind.VIBRATION or effect.kind == EffectKind.STICK_SLIP:
        for i in range(3):
            totals.ordered_force[i] += memory.force[i]
    if memory.held != 0:
        stiffness = memory.stiffness if effect.kind != EffectKind.VISCOSITY else 0.0
        totals.stiffness += stiffness
        totals.even_stiffness += stiffness
        totals.even_damping += effect.damping


@kernel
def _is_finite(memory: EffectMemoryRecord) -> bool:
    """True when the force is finite."""
    return math.isfinite(memory.force[0] + memory.force[1] + memory.force[2])


@kernel
def apply_effects(rows: Rows, work: ObjectWork, counts: ObjectCountsRecord, inputs: Vec, fields: Fields) -> None:
    """Add the forces of all effects to effect_force of their points of contact and to the bodies they act on.

    A force that is not finite counts as zero: that of a force field quarantines the field and is reported in
    quarantined of the first point's totals, any other sets status there.

    Args:
        rows: `Rows` of this tick.
        work: `ObjectWork` after `touch_points`; its effects hold the inputs that `carry_signals` set.
        counts: SCENE.objects.
        inputs: See kernels.objects.object_inputs, shape [INPUT_LENGTH].
        fields: Force fields by EFFECT.field, see loop_ports.FIELDS.
    """
    t = inputs[INPUT_TIME]
    for k in range(counts.effects):
        effect, memory = rows.effects[k], work.effects[k]
        if effect.enabled == 0 or not 0 <= effect.contact < MAX_CONTACTS:
            _forget(memory)
            continue
        if memory.quarantined != 0:
            continue
        if _waits_for_touch(effect, work, counts):
            memory.sticking = 0
            continue
        memory.stiffness = max(0.0, memory.stiffness)
        _place(effect, work, counts, inputs, memory)
        _act(effect, work, counts, fields, t, memory)
        if _is_finite(memory):
            _deliver(effect, rows, work, counts, memory)
        elif effect.kind == EffectKind.FIELD:
            if work.totals[0].quarantined < 0:  # one per tick, so that each is reported
                memory.quarantined = 1
                work.totals[0].quarantined = k
        else:
            _forget(memory)
            work.totals[0].status = 1
