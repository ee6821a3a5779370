"""Session memory and working arrays of the loop as named tuples for compiled code."""

from __future__ import annotations

from collections import namedtuple
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numba import from_dtype, typeof, types
from numpy.typing import NDArray

from mimics_app.contracts.arrays import Records, Words
from mimics_app.contracts.loop.contact_force import CONTACT_FORCE, FOLLOWED_AT_ONCE, STRUCK
from mimics_app.contracts.loop.haptic import EVENT, SAMPLE
from mimics_app.contracts.loop.loop_fields import FURTHER, HapticSnapshot, PointSnapshot
from mimics_app.contracts.loop.loop_ports import COMMAND_LENGTH, DATA_LENGTH, INBOX_LENGTH
from mimics_app.contracts.loop.object_rows import ObjectCapacities, Rows
from mimics_app.contracts.shared_memory import triple_buffer
from mimics_app.contracts.shared_memory.session_memory import SHARED_ARRAYS, SessionMemory
from mimics_app.rendering.haptic.kernels.spoiled_data import SPOILING_LENGTH
from mimics_app.rendering.haptic.kernels.state import new_states
from mimics_app.rendering.haptic.objects import ROW_STACK, ObjectWork, new_object_work

__all__ = ["CHANNELS", "WORK", "Channels", "Work", "channels_of", "new_work", "newest_snapshot"]


_COMMANDS = ("command_words", "commands", "answer_words", "answers")
_CHANNELS = ("rows", *(name for name in SHARED_ARRAYS if name not in (*Rows._fields, *_COMMANDS)))
"""Names of the session's arrays in the loop: one by one, the tables of objects as one tuple; none of the commands."""

if TYPE_CHECKING:
    Channels = SessionMemory
else:
    Channels = namedtuple("Channels", _CHANNELS, module=__name__)
    Channels.__doc__ = "Arrays of `SessionMemory`, which also names the writer of each."


class Work(NamedTuple):
    """Private arrays of the loop.

    Attributes:
        state: STATE records of the points of contact, shape [MAX_CONTACTS].
        objects: Working arrays of the haptic objects.
        sample: Current SAMPLE record, shape [1].
        event: Current EVENT record, shape [1].
        struck: STRUCK records of the contacts followed for the sound, shape [FOLLOWED_AT_ONCE].
        force: Current CONTACT_FORCE record, shape [1].
        data: Data vector from the device, shape [DATA_LENGTH].
        command: Command vector to the device, shape [COMMAND_LENGTH].
        inbox: Inbox vector to the device, shape [INBOX_LENGTH].
        spoiling: Fault of a simulated device, shape [SPOILING_LENGTH]; zeros for none.
        timespec: Scratch of the clock, shape [2].
    """

    state: Records
    objects: ObjectWork
    sample: Records
    event: Records
    struck: Records
    force: Records
    data: NDArray[np.float64]
    command: NDArray[np.float64]
    inbox: NDArray[np.float64]
    spoiling: NDArray[np.float64]
    timespec: Words


def channels_of(memory: SessionMemory) -> Channels:
    """Return the arrays of a session for the loop."""
    return Channels(**{name: getattr(memory, name) for name in _CHANNELS})


def new_work(objects: ObjectWork) -> Work:
    """Return fresh working arrays around those of the objects."""
    return Work(
        state=new_states(),
        objects=objects,
        sample=np.zeros(1, SAMPLE),
        event=np.zeros(1, EVENT),
        struck=np.zeros(FOLLOWED_AT_ONCE, STRUCK),
        force=np.zeros(1, CONTACT_FORCE),
        data=np.zeros(DATA_LENGTH),
        command=np.zeros(COMMAND_LENGTH),
        inbox=np.zeros(INBOX_LENGTH),
        spoiling=np.zeros(SPOILING_LENGTH),
        timespec=np.zeros(2, np.int64),
    )


def newest_snapshot(memory: SessionMemory, joints: int, contacts: int) -> HapticSnapshot:
    """Return the newest published state of a device with so many joints and points; its arrays are copies."""
    slot, _ = triple_buffer.acquire(memory.snapshot_words)
    # The bytes: numpy copies a record field by field, which takes three times as long.
    record = np.frombuffer(bytearray(memory.snapshots[slot].tobytes()), memory.snapshots.dtype)
    values: dict[str, Any] = dict(zip(record.dtype.names or (), record.item(), strict=True))
    values |= {name: values[name][:joints] for name in ("q", "torque_meas")}
    rows = values.pop(FURTHER)[: max(0, contacts - 1)]
    further = tuple(PointSnapshot(**dict(zip(rows.dtype.names, row.item(), strict=True))) for row in rows)
    return HapticSnapshot(**values, poses=memory.poses[slot].copy(), further=further)


def _channel_type(name: str) -> Any:
    if name == "rows":
        return ROW_STACK
    shared = SHARED_ARRAYS[name]
    return types.Array(from_dtype(np.dtype(shared.dtype)), len(shared.shape), "C")


CHANNELS = types.NamedTuple([_channel_type(name) for name in _CHANNELS], Channels)  # type: ignore[no-untyped-call]
"""Compiled type of `Channels`."""

WORK = typeof(new_work(new_object_work(ObjectCapacities(1, 1, 1, 1, 1))))  # type: ignore[no-untyped-call]
"""Compiled type of `Work`; the same for all capacities."""
