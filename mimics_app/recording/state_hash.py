"""State hash of a session: equal for bit-identical runs only."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.loop.loop_fields import Extent
from mimics_app.recording.columns import HAPTICMASTER, TIMING_FIELDS, field_columns, present_columns, rows_of

__all__ = ["StateHash"]

_EVENT_FIELDS = "tick kind body_a body_b material_a material_b position_world normal_world speed force value".split()


class StateHash:
    """Running SHA-256 of the samples, the events and the trial rows of one session.

    Three hashes are computed in parallel and combined at the end, so the result depends neither on the order in which
    the streams are read nor on the size of the blocks. Values that depend on real time are excluded: lateness and
    duration of a tick, monotonic time of an event (its tick is included).

    Args:
        extent: Extent of the device; columns beyond it are not hashed.
    """

    def __init__(self, extent: Extent = HAPTICMASTER) -> None:
        self._columns = np.setdiff1d(present_columns(extent), field_columns(TIMING_FIELDS))
        self._samples = hashlib.sha256()
        self._events = hashlib.sha256()
        self._trials = hashlib.sha256()
        self._counts = [0, 0, 0]

    def add_samples(self, samples: NDArray[Any]) -> None:
        """Add samples, shape [n], in order."""
        self._samples.update(rows_of(samples)[:, self._columns].tobytes())
        self._counts[0] += len(samples)

    def add_events(self, events: NDArray[Any]) -> None:
        """Add EVENT records, shape [n], in order."""
        for event in events:
            for name in _EVENT_FIELDS:
                self._events.update(np.ascontiguousarray(event[name]).tobytes())
        self._counts[1] += len(events)

    def add_trial(self, row: Mapping[str, object]) -> None:
        """Add a finished trial as plain JSON values; the order of the keys and empty cells have no effect."""
        filled = {name: value for name, value in row.items() if value is not None and value != ""}
        text = json.dumps(filled, sort_keys=True, separators=(",", ":"))
        self._trials.update(text.encode() + b"\n")
        self._counts[2] += 1

    @property
    def rows(self) -> int:
        """Number of samples added."""
        return self._counts[0]

    def hexdigest(self) -> str:
        """Return the hash of everything added so far, 64 hexadecimal digits."""
        whole = hashlib.sha256(b"mimics state 1 %d %d %d " % tuple(self._counts))
        for part in (self._samples, self._events, self._trials):
            whole.update(part.digest())
        return whole.hexdigest()
