"""Shared memory of one session: its arrays by name, with their layout and their writers.

Main, audio, recorder and console processes attach to the same segment.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from enum import IntEnum
from operator import attrgetter
from typing import Annotated, get_type_hints

import numpy as np
from numpy.typing import DTypeLike, NDArray

from mimics_app.contracts.arrays import Records, Words
from mimics_app.contracts.commands.command_records import ANSWER, COMMAND, CommandSource
from mimics_app.contracts.loop.contact_force import CONTACT_FORCE
from mimics_app.contracts.loop.haptic import EVENT, INBOX, POSE, SAMPLE, SCENE, SNAPSHOT
from mimics_app.contracts.loop.loop_fields import Extent
from mimics_app.contracts.loop.object_rows import ROW_DTYPES, ObjectCapacities, Rows
from mimics_app.contracts.shared_memory.newest_bytes import NEWEST_WORDS
from mimics_app.contracts.shared_memory.segment import ArraySpec, Segment
from mimics_app.contracts.shared_memory.shared_words import EXCHANGE_WORDS, RING_WORDS, STOP_STRIDE, initialise_exchange
from mimics_app.contracts.shared_memory.sound_scene import SOUND_SCENE

__all__ = [
    "PICTURE_SIZE",
    "SECOND_PICTURE_SIZE",
    "SHARED_ARRAYS",
    "SIGNAL_SAMPLE",
    "AttendanceWord",
    "Capacities",
    "ControlWord",
    "SessionMemory",
    "Shared",
]


class ControlWord(IntEnum):
    """Indices into `control`; each word has its own cache line and one writer."""

    CLEARED = 0  # main: sum of the stop words at the last reset; another sum requests E_STOP
    QUIT = 8  # main: 1 ends the loop
    TICKS = 16  # loop: ticks done
    MISSED = 24  # loop: ticks that ended more than one period after their release, after the first second
    HELD = 32  # loop: ticks later than late_hold_ns
    STALE = 40  # loop: ticks with device data older than stale_warn_ns
    STOPS = 48  # loop: stops latched since the start
    HOLDS = 72  # loop: times the force was ramped down for late ticks (DEGRADED) since the start
    CLOSED = 56  # main: 1: no further data
    START_NS = 64  # loop: monotonic time of tick 0's release [ns]
    UNREAD = 80  # loop: ticks without new data of the device, after the first second


class AttendanceWord(IntEnum):
    """Indices into `attendance`, which the operator's page writes."""

    PASS_NS = 0  # monotonic time of the page's last pass [ns]
    OPERATORS = 1  # clients that may give commands
    WATCHERS = 2  # clients that show the subject's picture
    MIRRORS = 4  # second displays that follow the scene
    SECOND_VIEW = 3  # view of the picture beside it: 1 + its place among the scene's views; 0: none


SIGNAL_SAMPLE = np.dtype([("t_ns", np.int64), ("value", np.float32), ("signal", np.int16), ("kind", np.int16)])
"""One sample of a body signal for the operator: time [ns], value, index of its name; kind 0: a sample, 1: an event."""

PICTURE_SIZE = (640, 360)
"""Largest picture for the operator [px]."""

SECOND_PICTURE_SIZE = (480, 270)
"""Size of the picture of another view for the operator [px]."""


@dataclass(frozen=True, slots=True)
class Capacities:
    """Capacities fixed when the session is built; rings have a power of two."""

    objects: ObjectCapacities = field(default_factory=ObjectCapacities)
    samples: int = 16384  # 16 s at 1 kHz, twice the time to replace a recorder on a busy machine
    events: int = 2048  # for the same time
    commands: int = 64  # of one source between two frames
    forces: int = 4096  # half a second of FOLLOWED_AT_ONCE contacts
    signal_samples: int = 16384  # of all body signals, for the operator: several seconds
    status_bytes: int = 65536  # of the state for the operator
    picture_bytes: int = 3 * PICTURE_SIZE[0] * PICTURE_SIZE[1] + 64  # of the subject's picture for the operator
    second_picture_bytes: int = 3 * SECOND_PICTURE_SIZE[0] * SECOND_PICTURE_SIZE[1] + 64  # of another view beside it
    mirror_bytes: int = 1 << 19  # of a frame for second displays: 10,000 moved nodes
    lateness_bins: int = 2048
    extent: Extent = field(default_factory=Extent)  # subset of the loop's numbers that the device has


@dataclass(frozen=True, slots=True)
class Shared:
    """Layout of a shared array.

    Attributes:
        dtype: Dtype of its elements.
        shape: Numbers, or names of capacities ("events", "objects.bodies").
    """

    dtype: DTypeLike
    shape: tuple[int | str, ...]

    def sizes(self, capacities: Capacities) -> tuple[int, ...]:
        """Return the shape in numbers."""
        return tuple(each if isinstance(each, int) else int(attrgetter(each)(capacities)) for each in self.shape)


_Exchange = Annotated[Words, Shared(np.int64, (EXCHANGE_WORDS,))]
_Ends = Annotated[Words, Shared(np.int64, (RING_WORDS,))]
_Events = Annotated[Records, Shared(EVENT, ("events",))]


class SessionMemory:
    """Arrays of a session by name; their layout is derived from these annotations."""

    control: Annotated[Words, Shared(np.int64, (88,))]  # see `ControlWord`

    stop_words: Annotated[Words, Shared(np.int64, (STOP_STRIDE * len(CommandSource),))]  # requests of each source

    # triple buffer main -> loop: a parameter block with its tables
    scene_words: _Exchange
    scenes: Annotated[Records, Shared(SCENE, (3,))]
    shapes: Annotated[Records, Shared(ROW_DTYPES["shapes"], (3, "objects.shapes"))]
    bodies: Annotated[Records, Shared(ROW_DTYPES["bodies"], (3, "objects.bodies"))]
    effects: Annotated[Records, Shared(ROW_DTYPES["effects"], (3, "objects.effects"))]
    points: Annotated[Records, Shared(ROW_DTYPES["points"], (3, "objects.points"))]
    wires: Annotated[Records, Shared(ROW_DTYPES["wires"], (3, "objects.wires"))]
    tunnels: Annotated[Records, Shared(ROW_DTYPES["tunnels"], (3, "objects.tunnels"))]
    curves: Annotated[Records, Shared(ROW_DTYPES["curves"], (3, "objects.curves"))]

    # triple buffer main -> loop: the pointing device
    inbox_words: _Exchange
    inboxes: Annotated[Records, Shared(INBOX, (3,))]

    # triple buffers loop -> main, with the poses of the bodies, and loop -> audio
    snapshot_words: _Exchange
    snapshots: Annotated[Records, Shared(SNAPSHOT, (3,))]
    poses: Annotated[NDArray[np.float64], Shared(np.float64, (3, "objects.bodies", POSE))]
    audio_words: _Exchange
    audio_snapshots: Annotated[Records, Shared(SNAPSHOT, (3,))]

    # triple buffer main -> audio: the head and the emitters
    sound_scene_words: _Exchange
    sound_scenes: Annotated[Records, Shared(SOUND_SCENE, (3,))]

    # rings loop -> recorder, and loop -> each consumer of events
    sample_words: _Ends
    samples: Annotated[Records, Shared(SAMPLE, ("samples",))]
    main_event_words: _Ends
    main_events: _Events
    audio_event_words: _Ends
    audio_events: _Events
    recorder_event_words: _Ends
    recorder_events: _Events

    # ring loop -> audio: forces of contacts per tick
    audio_force_words: _Ends
    audio_forces: Annotated[Records, Shared(CONTACT_FORCE, ("forces",))]

    # rings source of commands -> main, and main -> source
    command_words: Annotated[NDArray[np.int64], Shared(np.int64, (len(CommandSource), RING_WORDS))]
    commands: Annotated[Records, Shared(COMMAND, (len(CommandSource), "commands"))]
    answer_words: Annotated[NDArray[np.int64], Shared(np.int64, (len(CommandSource), RING_WORDS))]
    answers: Annotated[Records, Shared(ANSWER, (len(CommandSource), "commands"))]

    # newest values main -> operator's page, and the history of body signals, which is read without being consumed
    status_words: Annotated[Words, Shared(np.int64, (NEWEST_WORDS,))]
    status: Annotated[NDArray[np.uint8], Shared(np.uint8, (2, "status_bytes"))]
    picture_words: Annotated[Words, Shared(np.int64, (NEWEST_WORDS,))]
    picture: Annotated[NDArray[np.uint8], Shared(np.uint8, (2, "picture_bytes"))]
    second_picture_words: Annotated[Words, Shared(np.int64, (NEWEST_WORDS,))]
    second_picture: Annotated[NDArray[np.uint8], Shared(np.uint8, (2, "second_picture_bytes"))]
    mirror_words: Annotated[Words, Shared(np.int64, (NEWEST_WORDS,))]
    mirror: Annotated[NDArray[np.uint8], Shared(np.uint8, (2, "mirror_bytes"))]
    signal_words: _Ends
    signal_samples: Annotated[Records, Shared(SIGNAL_SAMPLE, ("signal_samples",))]

    # operator's page -> main, see `AttendanceWord`
    attendance: Annotated[Words, Shared(np.int64, (len(AttendanceWord),))]

    # histograms of the loop, see rendering.haptic.histogram
    lateness: Annotated[Words, Shared(np.int64, ("lateness_bins",))]
    duration: Annotated[Words, Shared(np.int64, ("lateness_bins",))]
    data_age: Annotated[Words, Shared(np.int64, ("lateness_bins",))]

    def __init__(self, capacities: Capacities | None = None, segment: Segment | None = None) -> None:
        self.capacities = capacities or Capacities()
        specs = _specs(self.capacities)
        fresh = segment is None
        self.segment = segment or Segment.for_arrays(specs)
        self.__dict__.update(self.segment.arrays(specs))
        if fresh:
            exchanges = (self.scene_words, self.inbox_words, self.snapshot_words, self.audio_words)
            for words in (*exchanges, self.sound_scene_words):
                initialise_exchange(words)

    @property
    def rows(self) -> Rows:
        """The tables of objects beside `scenes`, shape [3, capacity] each."""
        return Rows(self.shapes, self.bodies, self.effects, self.points, self.wires, self.tunnels, self.curves)

    def __reduce__(self) -> tuple[Callable[..., SessionMemory], tuple[Capacities, Segment]]:
        return SessionMemory, (self.capacities, self.segment)


def _shared_arrays() -> dict[str, Shared]:
    hints = get_type_hints(SessionMemory, include_extras=True)
    return {name: hint.__metadata__[0] for name, hint in hints.items()}


SHARED_ARRAYS: dict[str, Shared] = _shared_arrays()
"""All arrays of a `SessionMemory` by name, in the order of their layout."""


def _specs(capacities: Capacities) -> list[ArraySpec]:
    return [(name, shared.sizes(capacities), shared.dtype) for name, shared in SHARED_ARRAYS.items()]
