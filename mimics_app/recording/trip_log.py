"""Logs of the second before each trip, one file each: `trips/trip_000.arrows`, `trip_001.arrows`, ...

Each is a complete stream like haptic.arrows. The recorder writes it atomically as soon as the row of the trip arrives,
so that it survives a crash; the report extracts missing ones from the run.
"""

from __future__ import annotations

from collections import deque
from contextlib import suppress
from pathlib import Path

import numpy as np

from mimics_app.contracts.arrays import Records
from mimics_app.contracts.loop.haptic import SAMPLE, EventKind
from mimics_app.contracts.loop.loop_fields import Extent
from mimics_app.contracts.shared_memory.session_memory import Capacities
from mimics_app.recording.arrow_format import (
    END_OF_STREAM,
    decode_samples,
    encode_samples,
    schema_bytes,
)
from mimics_app.recording.arrow_scan import read_schema, sorted_scan
from mimics_app.recording.column_layout import layout_of, samples_schema
from mimics_app.recording.columns import HAPTICMASTER
from mimics_app.recording.run import Run
from mimics_app.recording.run_folder import PRIVATE_FOLDER, write_atomically

__all__ = ["FOLDER", "MOST_TRIPS", "TripLog", "complete_trips", "read_trip", "trip_file"]


FOLDER = "trips"
"""Subfolder of the run folder."""

_ROWS_BEFORE = 1000
"""Rows kept before that of a trip: 1 s."""

_KEPT = _ROWS_BEFORE + Capacities().samples
"""Rows buffered: a trip may be reported after as many rows as the ring holds."""

MOST_TRIPS = 100
"""Largest number of logs; later trips are in the events only."""


def trip_file(folder: Path, number: int) -> Path:
    """Return the path of the log of trip `number`, 0 first."""
    return folder / FOLDER / f"trip_{number:03d}.arrows"


def _write_trip(folder: Path, number: int, samples: Records, extent: Extent) -> None:
    path = trip_file(folder, number)
    path.parent.mkdir(mode=PRIVATE_FOLDER, exist_ok=True)
    blocks = [encode_samples(samples, 0, int(samples["tick"][0]), extent)] if len(samples) else []
    write_atomically(path, b"".join([schema_bytes(samples_schema(extent)), *blocks, END_OF_STREAM]))


def _rows_of_trip(samples: Records, tick: int) -> Records:
    """Return the rows of the second before a tick, and its own."""
    ticks = samples["tick"]
    return samples[(ticks >= tick - _ROWS_BEFORE) & (ticks <= tick)]


def trip_ticks(events: Records) -> list[int]:
    """Return the ticks of the trips among EVENT records, in order."""
    return [int(tick) for tick in events["tick"][events["kind"] == EventKind.TRIP]]


class TripLog:
    """Buffer of the newest rows that writes those before each trip.

    Args:
        folder: The run folder.
        earlier: Number of trips reported to an earlier recorder.
        extent: Extent of the device.
    """

    def __init__(self, folder: Path, earlier: int = 0, extent: Extent = HAPTICMASTER) -> None:
        self._folder = folder
        self._extent = extent
        self._number = earlier
        self._waiting: list[int] = []
        self._recent: deque[Records] = deque()
        self._rows = 0

    def note_events(self, events: Records) -> None:
        """Note the trips among EVENT records [n]."""
        self._waiting += trip_ticks(events)

    def note_samples(self, samples: Records) -> None:
        """Take SAMPLE records [n], in order, and write the trips with complete rows.

        Raises:
            OSError: The disk is full or failed; that trip is not written.
        """
        if len(samples) == 0:
            return
        self._recent.append(samples.copy())
        self._rows += len(samples)
        while self._rows - len(self._recent[0]) >= _KEPT:
            self._rows -= len(self._recent.popleft())
        while self._waiting and self._waiting[0] <= samples["tick"][-1]:
            self._write_next()

    def finish(self) -> None:
        """Write the remaining trips with the buffered rows.

        Raises:
            OSError: As `note_samples`.
        """
        while self._waiting:
            self._write_next()

    def _write_next(self) -> None:
        tick, number = self._waiting.pop(0), self._number
        self._number += 1
        if number < MOST_TRIPS:
            recent = np.concatenate(list(self._recent)) if self._recent else np.zeros(0, SAMPLE)
            _write_trip(self._folder, number, _rows_of_trip(recent, tick), self._extent)


def complete_trips(run: Run) -> list[tuple[int, Path]]:
    """Write the missing logs of trips from the rows of a run; return tick and file of each trip with a log.

    A trip has none where the folder cannot be written.
    """
    found = []
    for number, tick in enumerate(trip_ticks(run.events)[:MOST_TRIPS]):
        path = trip_file(run.folder, number)
        with suppress(OSError):
            if not path.exists():
                _write_trip(run.folder, number, _rows_of_trip(run.haptic, tick), run.layout.extent)
            found.append((tick, path))
    return found


def read_trip(path: Path) -> Records:
    """Return the SAMPLE records of a trip's log, shape [n]; empty where it is damaged."""
    layout = layout_of(read_schema(path))[0]
    found, _ = sorted_scan(path, lambda data: decode_samples(data, layout), layout.schema)
    pieces = [each.block.records for each in found]
    return np.concatenate(pieces) if pieces else np.empty(0, SAMPLE)
