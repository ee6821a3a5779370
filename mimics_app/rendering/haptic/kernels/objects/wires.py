"""Wires between outputs and inputs of blocks (D2.1 4.2.8.2, 4.2.12): input += gain output + offset, every tick.

Outputs of the robot are those of this tick; those of objects, and the force on the user, are those of the last tick, as
in a block diagram with one delay in each loop. A wire from a body that is not yet placed adds nothing.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.loop.haptic_objects import SignalSource, SignalTarget
from mimics_app.contracts.loop.loop_fields import MAX_CONTACTS
from mimics_app.maths.vec import copy
from mimics_app.rendering.haptic.kernels.objects.object_inputs import (
    INPUT_FORCE_MEASURED,
    INPUT_FORCE_USER,
    INPUT_GRASP,
    INPUT_POSITION,
    INPUT_TIME,
    INPUT_VELOCITY,
)

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import MotionRecord, ObjectCountsRecord, ObjectWork, Rows, WireRecord

__all__ = ["carry_signals"]


@kernel
def _of_inputs(inputs: Vec, source: int, contact: int, i: int) -> float:
    """Component i of an output of the robot, at one of its points of contact."""
    at = 3 * contact + i
    if source == SignalSource.POSITION_ROBOT:
        return inputs[INPUT_POSITION + at]
    if source == SignalSource.VELOCITY_ROBOT:
        return inputs[INPUT_VELOCITY + at]
    if source == SignalSource.FORCE_MEASURED:
        return inputs[INPUT_FORCE_MEASURED + at]
    if source == SignalSource.FORCE_USER:
        return inputs[INPUT_FORCE_USER + at]
    if i > 0:
        return 0.0
    return inputs[INPUT_GRASP + contact] if source == SignalSource.GRASP else inputs[INPUT_TIME]


@kernel
def _of_body(motion: MotionRecord, source: int, i: int) -> float:
    """Component i of an output of a body."""
    if source == SignalSource.POSITION_OBJECT:
        return motion.position[i]
    if source == SignalSource.VELOCITY_OBJECT:
        return motion.velocity[i]
    if source == SignalSource.OMEGA_OBJECT:
        return motion.omega[i]
    if SignalSource.AXIS_X_OBJECT <= source <= SignalSource.AXIS_Z_OBJECT:
        return motion.rotation[i, source - SignalSource.AXIS_X_OBJECT]
    if source == SignalSource.FORCE_OBJECT:
        return motion.force_user[i]
    if i > 0:
        return 0.0
    on = motion.touched if source == SignalSource.TOUCHED else motion.collided
    return 1.0 if on != 0 else 0.0


@kernel
def _is_placed(motion: MotionRecord) -> bool:
    """True for a body with a pose: its orientation is not zero."""
    q = motion.orientation
    return q[0] != 0.0 or q[1] != 0.0 or q[2] != 0.0 or q[3] != 0.0


@kernel
def _read(work: ObjectWork, counts: ObjectCountsRecord, wire: WireRecord, inputs: Vec, i: int) -> float:
    """Component i of the output at the source of a wire; 0 for a row that is not in use."""
    if wire.source <= SignalSource.TIME:
        return _of_inputs(inputs, wire.source, wire.source_row, i) if 0 <= wire.source_row < MAX_CONTACTS else 0.0
    if 0 <= wire.source_row < counts.bodies:
        return _of_body(work.motions[wire.source_row], wire.source, i)
    return 0.0


@kernel
def _write(work: ObjectWork, counts: ObjectCountsRecord, wire: WireRecord, i: int, value: float) -> None:
    """Add component i of a value to an input."""
    row = wire.target_row
    if wire.target <= SignalTarget.TORQUE_AUX:
        if 0 <= row < counts.bodies:
            aux = work.aux_forces if wire.target == SignalTarget.FORCE_AUX else work.aux_torques
            aux[row, i] += value
        return
    if not 0 <= row < counts.effects:
        return
    memory = work.effects[row]
    if wire.target == SignalTarget.EFFECT_POSITION:
        memory.position[i] += value
    elif i == 0 and wire.target == SignalTarget.EFFECT_FORCE:
        memory.size += value
    elif i == 0 and wire.target == SignalTarget.EFFECT_STIFFNESS:
        memory.stiffness += value


@kernel
def carry_signals(rows: Rows, work: ObjectWork, counts: ObjectCountsRecord, inputs: Vec) -> None:
    """Set every input to the value of its row plus the values of its wires.

    Call it before `place_bodies`, which clears the forces on the bodies of the last tick.

    Args:
        rows: `Rows` of this tick.
        work: `ObjectWork`; aux_forces, aux_torques and the inputs of effects are set.
        counts: SCENE.objects.
        inputs: See kernels.objects.object_inputs, shape [INPUT_LENGTH].
    """
    for k in range(counts.bodies):
        copy(rows.bodies[k].force_aux, work.aux_forces[k])
        copy(rows.bodies[k].torque_aux, work.aux_torques[k])
    for k in range(counts.effects):
        effect, memory = rows.effects[k], work.effects[k]
        memory.size = effect.force
        memory.stiffness = effect.stiffness
        copy(effect.position, memory.position)
    for k in range(counts.wires):
        wire = rows.wires[k]
        of_body = wire.source > SignalSource.TIME and 0 <= wire.source_row < counts.bodies
        if of_body and not _is_placed(work.motions[wire.source_row]):
            continue
        x = _read(work, counts, wire, inputs, 0)
        y = _read(work, counts, wire, inputs, 1)
        z = _read(work, counts, wire, inputs, 2)
        for i in range(3):
            value = wire.gain[i, 0] * x + wire.gain[i, 1] * y + wire.gain[i, 2] * z + wire.offset[i]
            _write(work, counts, wire, i, value)
