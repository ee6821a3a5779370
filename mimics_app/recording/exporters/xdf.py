"""One XDF file, for EEGLAB, MNE and other programs of the lab streaming layer.

The layout is that of the specification of XDF 1.0 (github.com/sccn/xdf): chunks of a length, a tag and a content. Time
stamps are the corrected times since tick 0. All streams are on one clock, so that every clock offset is 0; `source_s`
is the first channel of each series.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import BinaryIO
from xml.etree import ElementTree

import numpy as np

from mimics_app.recording.event_log import to_json
from mimics_app.recording.exporter_kinds import Exporter
from mimics_app.recording.line_tables import Rows, attempts_table, gaps_table, timed_events
from mimics_app.recording.run import Run
from mimics_app.recording.series import Batch, Series, series_of

__all__ = ["EXPORTER"]

_FILE_HEADER, _STREAM_HEADER, _SAMPLES, _CLOCK_OFFSET, _BOUNDARY, _STREAM_FOOTER = range(1, 7)
_MARK = bytes.fromhex("43a546dccbf5410fb30ed5467383cbe4")
"""Content of a boundary chunk, by which a reader finds the next chunk after damage."""
_BOUNDARY_S = 10.0
"""Time between two boundary chunks [s]."""

_Info = dict[str, "str | _Info | list[_Info]"]
"""Metadata as they are nested in XML: a text, an element, or several elements of one name."""


class _Xdf(Exporter):
    """A stream for each series, and streams of texts: events and attempts, each as a JSON object at its time."""

    about = "XDF: recording.xdf with the streams haptic, NAME of each signal, events, attempts and gaps"

    def open(self, run: Run, folder: Path) -> Iterator[Path]:
        """See `Exporter.open`."""
        path = folder / "recording.xdf"
        with path.open("xb") as file:
            file.write(b"XDF:")
            _chunk(file, _FILE_HEADER, _xml({"version": "1.0"}))
            series = series_of(run)
            for number, each in enumerate(series, start=1):
                _write_series(_Stream(file, number), each)
            attempts = sorted(attempts_table(run), key=lambda row: float(row.get("begin_s", 0.0)))
            gaps = sorted(gaps_table(series), key=lambda row: float(row["begin_s"]))
            tables: dict[str, Rows] = {"events": timed_events(run), "attempts": attempts, "gaps": gaps}
            for number, (name, rows) in enumerate(tables.items(), start=len(series) + 1):
                _write_texts(_Stream(file, number), name, "t_s" if name == "events" else "begin_s", rows)
        yield path


class _Stream:
    """One stream of a file.

    Attributes:
        samples: Number of samples written.
    """

    def __init__(self, file: BinaryIO, number: int) -> None:
        self._file, self._head = file, struct.pack("<I", number)
        self.samples = 0
        self._first_s = self._last_s = 0.0
        self._next_mark_s = -np.inf
        self._offsets: list[float] = []

    def begin(self, info: _Info) -> None:
        """Write its header."""
        _chunk(self._file, _STREAM_HEADER, self._head + _xml(info))

    def put(self, t_s: Sequence[float], content: bytes) -> None:
        """Write samples with their time stamps; clock offsets and boundaries come before them when they are due."""
        if t_s[0] >= self._next_mark_s:
            _chunk(self._file, _CLOCK_OFFSET, self._head + struct.pack("<dd", t_s[0], 0.0))
            _chunk(self._file, _BOUNDARY, _MARK)
            self._offsets.append(float(t_s[0]))
            self._next_mark_s = t_s[0] + _BOUNDARY_S
        _chunk(self._file, _SAMPLES, self._head + b"\4" + struct.pack("<I", len(t_s)) + content)
        self._first_s = self._first_s if self.samples else float(t_s[0])
        self._last_s = float(t_s[-1])
        self.samples += len(t_s)

    def end(self) -> None:
        """Write its footer."""
        offsets: list[_Info] = [{"time": repr(t_s), "value": "0.0"} for t_s in self._offsets]
        info: _Info = {
            "first_timestamp": repr(self._first_s),
            "last_timestamp": repr(self._last_s),
            "sample_count": str(self.samples),
            "clock_offsets": {"offset": offsets},
        }
        _chunk(self._file, _STREAM_FOOTER, self._head + _xml(info))


def _write_series(stream: _Stream, series: Series) -> None:
    named = [("source_s", "s"), *zip(series.columns, series.units, strict=True)]
    kind = "Haptics" if series.name == "haptic" else series.name.upper()
    stream.begin(_info(series.name, kind, series.rate, "double64", named))
    for batch in series.batches():
        stream.put(batch.t_s.tolist(), _numbers(batch))
    stream.end()


def _numbers(batch: Batch) -> bytes:
    """Return the samples of a batch as XDF lays them out: 8 (bytes of a time stamp), time stamp, values."""
    columns = 1 + batch.values.shape[1]
    rows = np.empty(len(batch.t_s), [("bytes", "u1"), ("t_s", "<f8"), ("values", "<f8", (columns,))])
    rows["bytes"], rows["t_s"] = 8, batch.t_s
    rows["values"][:, 0], rows["values"][:, 1:] = batch.source_s, batch.values
    return rows.tobytes()


def _write_texts(stream: _Stream, name: str, time: str, rows: Rows) -> None:
    """Write rows, each at its time of a name [s], at 0 where it has none."""
    stream.begin(_info(name, "Markers", 0.0, "string", [(name, "")]))
    for row in rows:
        t_s, text = float(row.get(time, 0.0)), to_json(row)
        stream.put([t_s], b"\x08" + struct.pack("<d", t_s) + b"\4" + struct.pack("<I", len(text)) + text)
    stream.end()


def _info(name: str, kind: str, rate: float, number_format: str, channels: Sequence[tuple[str, str]]) -> _Info:
    """Return the metadata of a stream, with label and unit of each channel."""
    described: list[_Info] = [{"label": label, "unit": unit} for label, unit in channels]
    return {
        "name": name,
        "type": kind,
        "channel_count": str(len(channels)),
        "nominal_srate": repr(rate),
        "channel_format": number_format,
        "created_at": "0.0",
        "desc": {"channels": {"channel": described}},
    }


def _xml(info: _Info) -> bytes:
    """Return metadata as XML below the element `info`."""
    top = ElementTree.Element("info")
    _fill(top, info)
    return ElementTree.tostring(top, encoding="utf-8", xml_declaration=True)


def _fill(element: ElementTree.Element, info: _Info) -> None:
    for name, value in info.items():
        for each in value if isinstance(value, list) else [value]:
            child = ElementTree.SubElement(element, name)
            if isinstance(each, str):
                child.text = each
            else:
                _fill(child, each)


def _chunk(file: BinaryIO, tag: int, content: bytes) -> None:
    """Write a chunk: number of bytes of the length, length of tag and content, tag, content."""
    file.write(struct.pack("<BQH", 8, len(content) + 2, tag))
    file.write(content)


EXPORTER = _Xdf()
