"""Processor time from a tracker's record to a pose: parsing, plausibility check, and prediction."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from mimics_app.contracts.clock import process_seconds
from mimics_app.inputs.trackers.ascension import FlockParser, flock_record
from mimics_app.inputs.trackers.plausibility import Plausibility
from mimics_app.inputs.trackers.polhemus import FastrakParser, fastrak_record
from mimics_app.inputs.trackers.scripted_person import person_at
from mimics_app.inputs.trackers.serial_tracker import RecordParser
from mimics_app.inputs.trackers.track import Track

__all__ = ["measure_records"]

_RECORDS = 2000
_RATE_HZ = 120.0
_UNIT = 0.01
"""Unit of the record's numbers [m]."""
_AHEAD_NS = 10_000_000
"""Prediction of the requested pose [ns]."""
_GOAL_MS = 1.0


def measure_records() -> dict[str, object]:
    """Return the processor time from the last byte of a record to its pose [ms], by protocol: p50, p99, max."""
    lines: dict[str, tuple[RecordParser, Callable[[float], bytes]]] = {
        "fastrak": (FastrakParser(_UNIT), lambda t: fastrak_record(1, *person_at("head", t, 1), _UNIT)),
        "flock": (FlockParser(), lambda t: flock_record(*person_at("head", t, 1))),
    }
    return {"goal": _GOAL_MS, **{name: _spread_of(*line) for name, line in lines.items()}}


def _spread_of(parser: RecordParser, record_at: Callable[[float], bytes]) -> dict[str, float]:
    believed, track, spent = Plausibility(), Track(), []
    for number in range(_RECORDS):
        t_s = number / _RATE_HZ
        record, t_ns = record_at(t_s), round(1e9 * t_s)
        begun = process_seconds()
        for found in parser.feed(record, t_ns):
            if believed.admits(found):
                track.add(found)
        track.pose(t_ns + _AHEAD_NS)
        spent.append(1e3 * (process_seconds() - begun))
    p50, p99 = np.percentile(spent, (50, 99)).tolist()
    return {"p50": p50, "p99": p99, "max": max(spent)}
