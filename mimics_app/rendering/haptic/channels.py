"""The loop's view of the session memory and of its own working arrays, as tuples that compiled code can take."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numba import from_dtype, types
from numpy.typing import NDArray

from mimics_app.contracts.haptic import EVENT, INBOX, SAMPLE, SCENE, SNAPSHOT
from mimics_app.contracts.loop_ports import COMMAND_LENGTH, DATA_LENGTH, INBOX_LENGTH
from mimics_app.contracts.object_rows import Rows
from mimics_app.contracts.session_memory import SessionMemory
from mimics_app.rendering.haptic.kernels.state import STATE, new_state
from mimics_app.rendering.haptic.objects import OBJECT_WORK, ROW_STACK, ObjectWork

__all__ = ["CHANNELS", "WORK", "Channels", "Work", "channels_of", "new_work"]

Words = NDArray[np.int64]
Records = NDArray[Any]


class Channels(NamedTuple):
    """Arrays of `SessionMemory` that the loop reads or writes; see there for who owns what."""

    control: Words
    scene_words: Words
    scenes: Records
    rows: Rows
    inbox_words: Words
    inboxes: Records
    snapshot_words: Words
    snapshots: Records
    poses: NDArray[np.float64]
    audio_words: Words
    audio_snapshots: Records
    sample_words: Words
    samples: Records
    main_event_words: Words
    main_events: Records
    audio_event_words: Words
    audio_events: Records
    recorder_event_words: Words
    recorder_events: Records
    lateness: Words
    duration: Words


class Work(NamedTuple):
    """Arrays of the loop alone.

    Attributes:
        state: STATE record, shape [1].
        objects: What the loop makes of the haptic objects.
        sample: SAMPLE record being filled, shape [1].
        event: EVENT record being filled, shape [1].
        data: From the device, shape [DATA_LENGTH].
        command: To the device, shape [COMMAND_LENGTH].
        inbox: To the device, shape [INBOX_LENGTH].
        timespec: Scratch of the clock, shape [2].
    """

    state: Records
    objects: ObjectWork
    sample: Records
    event: Records
    data: NDArray[np.float64]
    command: NDArray[np.float64]
    inbox: NDArray[np.float64]
    timespec: Words


def channels_of(memory: SessionMemory) -> Channels:
    """The channels of a session."""
    return Channels(**{name: getattr(memory, name) for name in Channels._fields})


def new_work(objects: ObjectWork) -> Work:
    """Fresh working arrays around those of the objects."""
    return Work(
        state=new_state(),
        objects=objects,
        sample=np.zeros(1, SAMPLE),
        event=np.zeros(1, EVENT),
        data=np.zeros(DATA_LENGTH),
        command=np.zeros(COMMAND_LENGTH),
        inbox=np.zeros(INBOX_LENGTH),
        timespec=np.zeros(2, np.int64),
    )


_WORDS = types.int64[::1]
_VECTOR = types.float64[::1]


def _records(dtype: np.dtype[Any]) -> Any:
    return from_dtype(dtype)[::1]


CHANNELS = types.NamedTuple(  # type: ignore[no-untyped-call]
    [
        _WORDS,
        _WORDS,
        _records(SCENE),
        ROW_STACK,
        _WORDS,
        _records(INBOX),
        _WORDS,
        _records(SNAPSHOT),
        types.float64[:, :, ::1],
        _WORDS,
        _records(SNAPSHOT),
        _WORDS,
        _records(SAMPLE),
        _WORDS,
        _records(EVENT),
        _WORDS,
        _records(EVENT),
        _WORDS,
        _records(EVENT),
        _WORDS,
        _WORDS,
    ],
    Channels,
)
"""Compiled type of `Channels`, field by field."""

WORK = types.NamedTuple(  # type: ignore[no-untyped-call]
    [
        _records(STATE),
        OBJECT_WORK,
        _records(SAMPLE),
        _records(EVENT),
        _VECTOR,
        _VECTOR,
        _VECTOR,
        _WORDS,
    ],
    Work,
)
"""Compiled type of `Work`, field by field."""
