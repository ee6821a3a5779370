"""Outputs of a tick: command vector for the device, sample row of the recording, and snapshot."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.compiled.record_copy import field_copier
from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.loop.controller_slots import Slot
from mimics_app.contracts.loop.haptic import (
    POINT_SAMPLE,
    POINT_SNAPSHOT,
    SAMPLE,
    SNAPSHOT,
    SafetyState,
)
from mimics_app.contracts.loop.loop_fields import FURTHER, LOOP_FIELDS, MAX_CONTACTS, MAX_JOINTS, Per, moves_of
from mimics_app.contracts.loop.loop_ports import (
    COMMAND_BELT,
    COMMAND_DQ,
    COMMAND_ENABLED,
    COMMAND_FORCE,
    COMMAND_STATE,
    COMMAND_TORQUE,
    COMMAND_VIBRATION,
    DATA_AGE,
    DATA_BUTTONS,
    DATA_DELAY,
    DATA_DQ,
    DATA_FORCE,
    DATA_GRASP,
    DATA_Q,
    DATA_TORQUE,
)
from mimics_app.maths.vec import norm

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import (
        SampleRecord,
        SceneRecord,
        SnapshotRecord,
        StateRecord,
        Table,
        TotalsRecord,
    )

__all__ = [
    "read_inputs",
    "sample_bytes",
    "snapshot_bytes",
    "write_command",
    "write_inputs",
    "write_outputs",
    "write_snapshot",
]


_copy_outputs = field_copier(moves_of(LOOP_FIELDS, recorded=True))
_copy_published = field_copier(moves_of(LOOP_FIELDS, recorded=False))

_OF_EACH_POINT = [field for field in LOOP_FIELDS if field.per is Per.POINT]
_copy_further_outputs = field_copier(moves_of(_OF_EACH_POINT, recorded=True))
_copy_further_published = field_copier(moves_of(_OF_EACH_POINT, recorded=False))


def _front(dtype: np.dtype[np.void]) -> int:
    """Return the length of what is before the rows of further points [bytes]."""
    assert dtype.fields is not None
    return int(dtype.fields[FURTHER][1])


_SAMPLE_OF_ONE, _SNAPSHOT_OF_ONE = _front(SAMPLE), _front(SNAPSHOT)
_SAMPLE_OF_FURTHER, _SNAPSHOT_OF_FURTHER = POINT_SAMPLE.itemsize, POINT_SNAPSHOT.itemsize


@kernel
def sample_bytes(contacts: int) -> int:
    """Return the length of the sample of a device with so many points of contact [bytes]; what follows is zero."""
    return _SAMPLE_OF_ONE + max(0, contacts - 1) * _SAMPLE_OF_FURTHER


@kernel
def snapshot_bytes(contacts: int) -> int:
    """Return the length of the snapshot of a device with so many points of contact [bytes]; what follows is zero."""
    return _SNAPSHOT_OF_ONE + max(0, contacts - 1) * _SNAPSHOT_OF_FURTHER


@kernel
def write_command(scene: SceneRecord, states: Table[StateRecord], dt: float, command: Vec) -> None:
    """Fill the command vector for the device, and add up the way of a treadmill's belt over the tick of dt [s]."""
    state = states[0]
    for i in range(MAX_JOINTS):
        command[COMMAND_DQ + i] = state.command[i]
        command[COMMAND_TORQUE + i] = state.torque_command[i]
    for c in range(scene.contacts):
        for i in range(3):
            command[COMMAND_FORCE + 3 * c + i] = states[c].f_command[i]
        force = norm(states[c].f_user_world)
        command[COMMAND_VIBRATION + c] = min(1.0, force / scene.force_limit) if force > 0.0 else 0.0
    moves = SafetyState.HOMED <= state.safety < SafetyState.SAFE_STOP
    braked = state.control.slot != Slot.OFF and state.control.out.braked == 1
    command[COMMAND_ENABLED] = 1.0 if moves and not braked else 0.0
    command[COMMAND_STATE] = float(state.safety)
    share = state.control.out.belt if state.control.slot != Slot.OFF else 0.0
    command[COMMAND_BELT] = share * state.reference_state.speed.value * state.reference_state.amplitude.value
    state.belt_travel += command[COMMAND_ENABLED] * command[COMMAND_BELT] * dt


@kernel
def write_inputs(
    data: Vec, status: int, stop_word: int, held: int, period: float, state: StateRecord, dt: float, row: SampleRecord
) -> None:
    """Write the inputs of a replay to the sample row, exactly as read from the device."""
    row.t = state.tick * dt
    row.tick = float(state.tick)
    for i in range(MAX_JOINTS):
        row.q[i] = data[DATA_Q + i]
        row.dq[i] = data[DATA_DQ + i]
        row.torque_meas[i] = data[DATA_TORQUE + i]
    for i in range(3):
        row.f_meas[i] = data[DATA_FORCE + i]
    row.grasp = data[DATA_GRASP]
    for c in range(1, state.contacts):
        point = row.further[c - 1]
        for i in range(3):
            point.f_meas[i] = data[DATA_FORCE + 3 * c + i]
        point.grasp = data[DATA_GRASP + c]
    row.buttons = data[DATA_BUTTONS]
    row.age = data[DATA_AGE]
    row.delay = data[DATA_DELAY]
    row.status = float(status)
    row.sequence = float(state.sequence)
    row.stop_word = float(stop_word)
    row.held = float(held)
    row.period_s = period


@kernel
def read_inputs(row: SampleRecord, data: Vec) -> None:
    """Restore the data vector of the device from a sample row."""
    for i in range(MAX_JOINTS):
        data[DATA_Q + i] = row.q[i]
        data[DATA_DQ + i] = row.dq[i]
        data[DATA_TORQUE + i] = row.torque_meas[i]
    for i in range(3):
        data[DATA_FORCE + i] = row.f_meas[i]
    data[DATA_GRASP] = row.grasp
    for c in range(1, MAX_CONTACTS):
        point = row.further[c - 1]
        for i in range(3):
            data[DATA_FORCE + 3 * c + i] = point.f_meas[i]
        data[DATA_GRASP + c] = point.grasp
    data[DATA_BUTTONS] = row.buttons
    data[DATA_AGE] = row.age
    data[DATA_DELAY] = row.delay


@kernel
def write_outputs(contacts: int, states: Table[StateRecord], totals: Table[TotalsRecord], row: SampleRecord) -> None:
    """Write the outputs of the tick, of the device and of each of its points of contact, to the sample row.

    A replay compares them.
    """
    _copy_outputs(states[0], totals[0], row)
    for c in range(1, contacts):
        _copy_further_outputs(states[c], totals[c], row.further[c - 1])


@kernel
def write_snapshot(
    contacts: int, states: Table[StateRecord], totals: Table[TotalsRecord], t_ns: int, out: SnapshotRecord
) -> None:
    """Write the state after a tick that was released at `t_ns` [ns] to the snapshot."""
    out.tick = states[0].tick - 1
    out.t_ns = t_ns
    _copy_published(states[0], totals[0], out)
    for c in range(1, contacts):
        _copy_further_published(states[c], totals[c], out.further[c - 1])
