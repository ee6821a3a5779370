"""One MCAP file, for Foxglove and PlotJuggler.

A row of a series is one message in the encoding of ROS 2 (CDR: after four bytes, the numbers as they lie in memory), so
that an hour of ticks is encoded by numpy; a message of JSON for each tick would take minutes. Events are JSON.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.clock import SECOND_NS
from mimics_app.contracts.errors import UsageError
from mimics_app.contracts.version import __version__
from mimics_app.recording.event_log import to_json
from mimics_app.recording.exporter_kinds import Exporter
from mimics_app.recording.line_tables import Rows, attempts_table, event_kinds, event_rows, gaps_table
from mimics_app.recording.run import Run
from mimics_app.recording.series import Batch, Series, series_of

if TYPE_CHECKING:
    from mimics_app.recording.exporters._mcap_file import McapFile

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
            made = _begun(file)
            series = series_of(run)
            for each in series:
                _write_series(made, each, run.start_ns)
            schema = made.schema("mimics_app/Object", "jsonschema", _ANY_OBJECT)
            for source, kind in event_kinds(run):
                _write_rows(made, schema, f"events/{source}/{kind}", event_rows(run, source, kind))
            _write_rows(made, schema, "attempts", attempts_table(run))
            _write_rows(made, schema, "gaps", gaps_table(series))
            made.metadata("session", {name: json.dumps(item) for name, item in run.session.items()})
            made.finish()
        yield path


def _begun(file: BinaryIO) -> McapFile:
    try:
        from mimics_app.recording.exporters._mcap_file import McapFile
    except ImportError as error:
        raise UsageError("MCAP needs mcap, which is not installed", 'pip install "mimics_app[export]"') from error
    return McapFile(file, f"mimics_app {__version__}")


def _write_series(made: McapFile, series: Series, start_ns: int) -> None:
    name = series.name if series.name == "haptic" else f"signals/{series.name}"
    lines = ["float64 t_s # s", "float64 source_s # s"]
    for field in series.fields:
        kind = f"float64[{len(field.units)}]" if field.vector else "float64"
        lines.append(f"{kind} {field.name.lower()} # {', '.join(dict.fromkeys(field.units))}")
    schema = made.schema(f"mimics_app/msg/{series.name.title()}", "ros2msg", "\n".join(lines).encode())
    channel = made.channel(name, "cdr", schema, {"rate_hz": repr(series.rate)})
    for batch in series.batches():
        log_ns = (start_ns + np.rint(batch.t_s * SECOND_NS)).astype(np.int64).clip(min=0)
        made.put_rows(channel, log_ns, _messages(batch))


def _messages(batch: Batch) -> NDArray[Any]:
    """Return the messages of a batch, each as its bytes lie in CDR."""
    columns = 2 + batch.values.shape[1]
    rows = np.empty(len(batch.t_s), [("head", "V4"), ("values", "<f8", (columns,))])
    rows["head"] = np.void(_CDR_LITTLE_ENDIAN)
    rows["values"][:, 0], rows["values"][:, 1], rows["values"][:, 2:] = batch.t_s, batch.source_s, batch.values
    return rows


def _write_rows(made: McapFile, schema: int, topic: str, rows: Rows) -> None:
    channel = made.channel(topic, "json", schema, {})
    made.put_texts(channel, ((_time_of(row), to_json(row)) for row in rows))


def _time_of(row: Mapping[str, Any]) -> int:
    """Return the time of a row [ns], 0 where it has none."""
    t_ns = next((row[name] for name in ("t_ns", "begin_ns") if isinstance(row.get(name), int)), 0)
    return max(0, int(t_ns))


EXPORTER = _Mcap()
