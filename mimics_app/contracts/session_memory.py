"""The shared memory of one session: who writes which array, and where each lies.

Main, audio, recorder and console processes attach to the same segment and see the same arrays by name.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from enum import IntEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts import ring, triple_buffer
from mimics_app.contracts.haptic import EVENT, INBOX, POSE, SAMPLE, SCENE, SNAPSHOT
from mimics_app.contracts.object_rows import ROW_DTYPES, ObjectCapacities, Rows
from mimics_app.contracts.segment import ArraySpec, Segment

__all__ = ["Capacities", "ControlWord", "SessionMemory"]


class ControlWord(IntEnum):
    """Indices into `control`; each word on a cache line of its own, one writer each."""

    STOP = 0  # stop key, device supervisor or console: 1 asks for E_STOP
    QUIT = 8  # main: 1 ends the loop
    TICKS = 16  # loop: ticks done
    MISSED = 24  # loop: ticks that ended more than one period after their release, after the first second
    HELD = 32  # loop: ticks later than late_hold_ns
    STALE = 40  # loop: ticks with device data older than stale_warn_ns
    STOPS = 48  # loop: stops latched since the start
    HOLDS = 72  # loop: times the force was ramped down for late ticks (DEGRADED) since the start
    CLOSED = 56  # main: 1 tells the children that nothing more will come
    START_NS = 64  # loop: monotonic time of tick 0's release [ns]


@dataclass(frozen=True, slots=True)
class Capacities:
    """Sizes fixed when the session is built."""

    objects: ObjectCapacities = field(default_factory=ObjectCapacities)
    samples: int = 16384  # 16 s at 1 kHz, twice what a recorder on a busy machine takes to be replaced; a power of two
    events: int = 2048  # for as long; a power of two
    lateness_bins: int = 2048


class SessionMemory:
    """The arrays of a session by name.

    Attributes:
        control: int64 words, see `ControlWord`.
        scene_words, scenes: triple buffer main -> loop of SCENE records, shape [3].
        shapes, bodies, effects, points, wires: the tables beside each of the three, shape [3, capacity].
        inbox_words, inboxes: triple buffer main -> loop of INBOX records, shape [3].
        snapshot_words, snapshots, poses: triple buffer loop -> main; poses has shape [3, 1 + bodies, 7].
        audio_words, audio_snapshots: triple buffer loop -> audio of SNAPSHOT records, shape [3].
        sample_words, samples: ring loop -> recorder of SAMPLE records.
        main_event_words, main_events; audio_event_words, audio_events; recorder_event_words, recorder_events:
            rings loop -> each consumer of EVENT records.
        lateness, duration: int64 histograms written by the loop (see rendering.haptic.histogram).
    """

    control: NDArray[np.int64]
    scene_words: NDArray[np.int64]
    scenes: NDArray[Any]
    shapes: NDArray[Any]
    bodies: NDArray[Any]
    effects: NDArray[Any]
    points: NDArray[Any]
    wires: NDArray[Any]
    inbox_words: NDArray[np.int64]
    inboxes: NDArray[Any]
    snapshot_words: NDArray[np.int64]
    snapshots: NDArray[Any]
    poses: NDArray[np.float64]
    audio_words: NDArray[np.int64]
    audio_snapshots: NDArray[Any]
    sample_words: NDArray[np.int64]
    samples: NDArray[Any]
    main_event_words: NDArray[np.int64]
    main_events: NDArray[Any]
    audio_event_words: NDArray[np.int64]
    audio_events: NDArray[Any]
    recorder_event_words: NDArray[np.int64]
    recorder_events: NDArray[Any]
    lateness: NDArray[np.int64]
    duration: NDArray[np.int64]

    def __init__(self, capacities: Capacities | None = None, segment: Segment | None = None) -> None:
        self.capacities = capacities or Capacities()
        specs = _specs(self.capacities)
        fresh = segment is None
        self.segment = segment or Segment.for_arrays(specs)
        self.__dict__.update(self.segment.arrays(specs))
        if fresh:
            for words in (self.scene_words, self.inbox_words, self.snapshot_words, self.audio_words):
                triple_buffer.initialise(words)

    @property
    def rows(self) -> Rows:
        """The tables of objects beside `scenes`, shape [3, capacity] each."""
        return Rows(self.shapes, self.bodies, self.effects, self.points, self.wires)

    def __reduce__(self) -> tuple[Callable[..., SessionMemory], tuple[Capacities, Segment]]:
        return SessionMemory, (self.capacities, self.segment)


def _specs(capacities: Capacities) -> list[ArraySpec]:
    exchange = (triple_buffer.WORDS,)
    head_and_tail = (ring.WORDS,)
    return [
        ("control", (80,), np.int64),
        ("scene_words", exchange, np.int64),
        ("scenes", (3,), SCENE),
        *((name, (3, getattr(capacities.objects, name)), dtype) for name, dtype in ROW_DTYPES.items()),
        ("inbox_words", exchange, np.int64),
        ("inboxes", (3,), INBOX),
        ("snapshot_words", exchange, np.int64),
        ("snapshots", (3,), SNAPSHOT),
        ("poses", (3, 1 + capacities.objects.bodies, POSE), np.float64),
        ("audio_words", exchange, np.int64),
        ("audio_snapshots", (3,), SNAPSHOT),
        ("sample_words", head_and_tail, np.int64),
        ("samples", (capacities.samples,), SAMPLE),
        ("main_event_words", head_and_tail, np.int64),
        ("main_events", (capacities.events,), EVENT),
        ("audio_event_words", head_and_tail, np.int64),
        ("audio_events", (capacities.events,), EVENT),
        ("recorder_event_words", head_and_tail, np.int64),
        ("recorder_events", (capacities.events,), EVENT),
        ("lateness", (capacities.lateness_bins,), np.int64),
        ("duration", (capacities.lateness_bins,), np.int64),
    ]
