"""One MCAP file, for Foxglove and PlotJuggler.

A row of a series is one message in the encoding of ROS 2 (CDR: after four bytes, the numbers as they lie in memory), so
that an hour of ticks is encoded by numpy; a message of JSON for each tick would take minutes. Events are JSON.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np

from mimics_app.contracts.clock import SECOND_NS
from mimics_app.contracts.errors import UsageError
from mimics_app.contracts.version import __version__
from mimics_app.recording.event_log import to_json
from mimics_app.recording.exporter_kinds import Exporter
from mimics_app.recording.line_tables import attempts_table, event_kinds, event_rows, gaps_table
from mimics_app.recording.run import Run
from mimics_app.recording.series import Batch, Series, series_of

if TYPE_CHECKING:
    from mcap.writer import Writer

__all__ = ["EXPORTER"]

_CDR_LITTLE_ENDIAN = b"\0\1\0\0"
"""Head of a message in CDR, from whose end the alignment counts."""
_ANY_OBJECT = json.dumps({"type": "object"}).encode()


class _Mcap(Exporter):
    """A topic for each series and each kind of event; the log time is the corrected one, on the clock of the run."""

    about = "MCAP: recording.mcap with the topics haptic, signals/NAME, events/SOURCE/KIND, attempts and gaps"

    def open(self, run: Run, folder: Path) -> Iterator[Path]:
        """See `Exporter.open`."""
        path = folder / "recording.mcap"
        with path.open("xb") as file:
            writer = _writer(file)
            writer.start(library=f"mimics_app {__version__}")
            series = series_of(run)
            for each in series:
                _write_series(writer, each, run.start_ns)
            schema = writer.register_schema("mimics_app/Object", "jsonschema", _ANY_OBJECT)
            for source, kind in event_kinds(run):
                _write_rows(writer, schema, f"events/{source}/{kind}", event_rows(run, source, kind))
            _write_rows(writer, schema, "attempts", attempts_table(run))
            _write_rows(writer, schema, "gaps", gaps_table(series))
            writer.add_metadata("session", {name: json.dumps(item) for name, item in run.session.items()})
            writer.finish()
        yield path


def _writer(file: BinaryIO) -> Writer:
    try:
        from mcap.writer import CompressionType, Writer
    except ImportError as error:
        raise UsageError("MCAP needs mcap, which is not installed", 'pip install "mimics_app[export]"') from error
    return Writer(file, compression=CompressionType.LZ4)


def _write_series(writer: Writer, series: Series, start_ns: int) -> None:
    name = series.name if series.name == "haptic" else f"signals/{series.name}"
    lines = ["float64 t_s # s", "float64 source_s # s"]
    for field in series.fields:
        kind = f"float64[{len(field.units)}]" if field.vector else "float64"
        lines.append(f"{kind} {field.name.lower()} # {', '.join(dict.fromkeys(field.units))}")
    schema = writer.register_schema(f"mimics_app/msg/{series.name.title()}", "ros2msg", "\n".join(lines).encode())
    channel = writer.register_channel(name, "cdr", schema, {"rate_hz": repr(series.rate)})
    for batch in series.batches():
        data, length = _messages(batch)
        log_ns = (start_ns + np.rint(batch.t_s * SECOND_NS)).astype(np.int64).clip(min=0).tolist()
        for i, t_ns in enumerate(log_ns):
            writer.add_message(channel, t_ns, data[i * length : (i + 1) * length], t_ns)


def _messages(batch: Batch) -> tuple[bytes, int]:
    """Return the messages of a batch one after another, and the length of each [bytes]."""
    columns = 2 + batch.values.shape[1]
    rows = np.empty(len(batch.t_s), [("head", "V4"), ("values", "<f8", (columns,))])
    rows["head"] = np.void(_CDR_LITTLE_ENDIAN)
    rows["values"][:, 0], rows["values"][:, 1], rows["values"][:, 2:] = batch.t_s, batch.source_s, batch.values
    return rows.tobytes(), rows.itemsize


def _write_rows(writer: Writer, schema: int, topic: str, rows: list[dict[str, Any]]) -> None:
    channel = writer.register_channel(topic, "json", schema)
    for row in rows:
        t_ns = next((row[name] for name in ("t_ns", "begin_ns") if isinstance(row.get(name), int)), 0)
        writer.add_message(channel, max(0, t_ns), to_json(row), max(0, t_ns))


EXPORTER = _Mcap()
