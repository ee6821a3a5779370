"""EDF+ files, for programs of electrophysiology: one for each field of the loop and each signal.

A file begins with its first sample, whose time `t_s` is its first annotation; events.edf begins with tick 0.
Samples have 16 bits between the smallest and the largest value of a channel. The format has no missing value: in a gap
the last one is repeated, and an annotation "gap" has its begin and duration; the last record is filled likewise.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from datetime import datetime
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.errors import UsageError
from mimics_app.recording.exporter_kinds import Exporter
from mimics_app.recording.exporters._spool import gridded, spooled
from mimics_app.recording.line_tables import attempts_table, timed_events
from mimics_app.recording.report_values import mapping
from mimics_app.recording.run import Run
from mimics_app.recording.series import series_of

__all__ = ["EXPORTER"]

_COUNTERS = frozenset({"tick", "sequence", "bodies", "lateness_ns", "duration_ns"})
"""Fields of the loop that 16 bits cannot hold or that are no physical value; the other formats have them."""
_RECORD_S = 1.0
_LABEL, _UNIT = 16, 8
"""Longest label and unit of a channel in the header."""


class _Edf(Exporter):
    """A file for each field or signal, and events.edf with every event but the frames as annotations."""

    about = "EDF+: haptic_FIELD.edf and signal_NAME.edf of 16 bits, events.edf with annotations"

    def open(self, run: Run, folder: Path) -> Iterator[Path]:
        """See `Exporter.open`."""
        edfio, start = _library(), _start(run)
        for each in series_of(run):
            with spooled(each, folder, gridded(each)) as spool:
                if not spool.rows:
                    continue
                first_s = float(spool.times("t_s")[0])
                gaps = [(begin - first_s, end - begin, why) for begin, end, why in each.gaps()]
                notes = [edfio.EdfAnnotation(0.0, None, f"first sample: t_s = {first_s!r}")]
                notes += [edfio.EdfAnnotation(onset, length, f"gap: {why}") for onset, length, why in gaps if onset > 0]
                for name, units, values in spool.fields():
                    if name in _COUNTERS:
                        continue
                    signals = _signals(edfio, name, units, values.reshape(spool.rows, -1), each.rate)
                    path = folder / f"{'haptic' if each.name == 'haptic' else 'signal'}_{name}.edf"
                    yield _write(edfio, path, signals, notes, start)
        yield _write(edfio, folder / "events.edf", [], _annotations(edfio, run), start)


def _library() -> ModuleType:
    try:
        import edfio
    except ImportError as error:
        raise UsageError("EDF needs edfio, which is not installed", 'pip install "mimics_app[export]"') from error
    return edfio


def _start(run: Run) -> datetime | None:
    """Return the wall time at the beginning of the session; None where the header lacks it."""
    try:
        return datetime.fromisoformat(str(mapping(run.session.get("clock")).get("utc")))
    except ValueError:
        return None


def _signals(edfio: ModuleType, name: str, units: Sequence[str], values: F8, rate: float) -> list[Any]:
    columns = values.T
    labels = [f"{name}[{i}]" for i in range(len(units))] if len(units) > 1 else [name]
    return [
        edfio.EdfSignal(
            _filled(column, rate),
            sampling_frequency=rate,
            label=label[-_LABEL:],
            physical_dimension=unit[:_UNIT],
            physical_range=_range(column),
        )
        for label, unit, column in zip(labels, units, columns, strict=True)
    ]


def _filled(column: F8, rate: float) -> F8:
    """Return samples of whole records, a missing one as the one before it."""
    count = -(-len(column) // round(rate * _RECORD_S)) * round(rate * _RECORD_S)
    known = np.flatnonzero(np.isfinite(column))
    if not len(known):
        return np.zeros(count)
    before = np.searchsorted(known, np.arange(count), side="right") - 1
    return column[known[np.maximum(before, 0)]]


def _range(column: F8) -> tuple[float, float]:
    """Return physical minimum and maximum, which must differ."""
    known = column[np.isfinite(column)]
    low, high = (float(known.min()), float(known.max())) if len(known) else (0.0, 0.0)
    return (low, high) if high > low else (low - 1.0, high + 1.0)


def _annotations(edfio: ModuleType, run: Run) -> list[Any]:
    """Return the events with a time, but for the frames, and the attempts with their duration, in order of time."""
    events = [row for row in timed_events(run, frames=False) if row["t_s"] >= 0.0]
    found = [edfio.EdfAnnotation(row["t_s"], None, f"{row['source']}/{row['kind']}") for row in events]
    for row in attempts_table(run):
        begin, end = row.get("begin_s", -1.0), row.get("end_s", -1.0)
        if 0.0 <= begin <= end:
            found.append(edfio.EdfAnnotation(begin, end - begin, f"trial {row.get('trial')}: {row.get('outcome')}"))
    return sorted(found, key=lambda note: note.onset)


def _write(edfio: ModuleType, path: Path, signals: list[Any], notes: list[Any], start: datetime | None) -> Path:
    recording = edfio.Recording(startdate=start.date() if start else None)
    time = start.time().replace(microsecond=0) if start else None
    edf = edfio.Edf(
        signals,
        recording=recording,
        starttime=time,
        annotations=notes,
        data_record_duration=_RECORD_S if signals else None,
    )
    edf.write(path)
    return path


EXPORTER = _Edf()
