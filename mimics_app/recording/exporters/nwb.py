"""One file of Neurodata Without Borders (NWB), for programs of neurophysiology."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import ExitStack
from datetime import UTC, datetime
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any
from uuid import NAMESPACE_URL, uuid5

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.errors import UsageError
from mimics_app.recording.event_log import to_json
from mimics_app.recording.exporter_kinds import Exporter
from mimics_app.recording.exporters._spool import Spool, spooled
from mimics_app.recording.line_tables import Rows, attempts_table, gaps_table, text_of, timed_events
from mimics_app.recording.report_values import mapping
from mimics_app.recording.run import Run
from mimics_app.recording.series import series_of

if TYPE_CHECKING:
    from hdmf.data_utils import GenericDataChunkIterator
    from pynwb import NWBFile

__all__ = ["EXPORTER"]

_ROWS = 8192
_UNITS = {"1": "n.a.", "": "n.a."}


class _Nwb(Exporter):
    """A TimeSeries for each field or signal, with its corrected times; trials, events, gaps as invalid times."""

    about = "NWB: recording.nwb with a time series for each field, trials, events and invalid times"

    def open(self, run: Run, folder: Path) -> Iterator[Path]:
        """See `Exporter.open`."""
        pynwb = _library()
        path = folder / "recording.nwb"
        with ExitStack() as stack:
            series = series_of(run)
            spools = [stack.enter_context(spooled(each, folder)) for each in series]
            file = _file(pynwb, run)
            for spool in spools:
                _add_series(pynwb, file, spool)
            _add_tables(pynwb, file, run)
            for row in gaps_table(series):
                file.add_invalid_time_interval(row["begin_s"], row["end_s"], tags=[row["series"], row["why"]])
            _set_identities(file)
            with pynwb.NWBHDF5IO(path, "w") as out:
                out.write(file)
        yield path


def _library() -> ModuleType:
    try:
        import pynwb
    except ImportError as error:
        raise UsageError("NWB needs pynwb, which is not installed", 'pip install "mimics_app[export]"') from error
    return pynwb


def _file(pynwb: ModuleType, run: Run) -> NWBFile:
    try:
        start = datetime.fromisoformat(str(mapping(run.session.get("clock")).get("utc")))
    except ValueError:
        start = datetime.fromtimestamp(0.0, UTC)
    scene = str(mapping(run.session.get("scene")).get("name") or "scene")
    code = str(mapping(run.session.get("settings")).get("participant") or "unknown")
    return pynwb.NWBFile(
        session_description=f"The scene {scene}, rendered as touch, picture and sound",
        identifier=run.folder.name,
        session_start_time=start,
        file_create_date=[start],
        subject=pynwb.file.Subject(subject_id=code, species="Homo sapiens", sex="U"),
    )


def _add_series(pynwb: ModuleType, file: NWBFile, spool: Spool) -> None:
    name = spool.series.name
    times = _lazy(spool, "t_s")
    raw = pynwb.TimeSeries(
        name=f"{name}_source_s",
        data=_lazy(spool, "source_s"),
        unit="s",
        timestamps=times,
        description="time of each row as its source counted it",
    )
    file.add_acquisition(raw)
    for field in spool.series.fields:
        units = list(dict.fromkeys(field.units))
        full = name if field.name == name else f"{name}_{field.name}"
        unit = _UNITS.get(units[0], units[0]) if len(units) == 1 else "n.a."
        made = pynwb.TimeSeries(
            name=full,
            data=_lazy(spool, field.name),
            unit=unit,
            timestamps=raw,
            description=f"{field.name} of the recording",
            comments=f"units: {', '.join(field.units)}",
        )
        file.add_acquisition(made)


def _lazy(spool: Spool, name: str) -> GenericDataChunkIterator:
    """Return a field as what the library reads chunk by chunk."""
    return _chunked(
        spool.shape(name),
        np.dtype(np.float64),
        lambda rows, *others: spool.rows_of(name, rows.start, rows.stop)[(slice(None), *others)],
    )


def _written(events: Rows) -> GenericDataChunkIterator:
    """Return the events as JSON, which are made as they are written."""
    return _chunked(
        (len(events),),
        np.dtype(object),
        lambda rows: np.array([to_json(event).decode() for event in events[rows]], object),
    )


def _chunked(
    shape: tuple[int, ...], dtype: np.dtype[Any], read: Callable[..., NDArray[Any]]
) -> GenericDataChunkIterator:
    """Return values of a shape that a function reads, by the slices along its axes, while they are written."""
    from hdmf.data_utils import GenericDataChunkIterator

    class _Chunks(GenericDataChunkIterator):  # type: ignore[misc]
        def _get_data(self, selection: tuple[slice, ...]) -> NDArray[Any]:
            return read(*selection)

        def _get_maxshape(self) -> tuple[int, ...]:
            return shape

        def _get_dtype(self) -> np.dtype[Any]:
            return dtype

    rows = (min(_ROWS, max(1, shape[0])), *shape[1:])
    return _Chunks(buffer_shape=rows, chunk_shape=rows)


def _add_tables(pynwb: ModuleType, file: NWBFile, run: Run) -> None:
    attempts = [row for row in attempts_table(run) if "begin_s" in row and "end_s" in row]
    names = list(dict.fromkeys(name for row in attempts for name in row if name not in ("begin_s", "end_s")))
    for name in names if attempts else ():
        file.add_trial_column(name, f"{name} of trials.csv")
    for row in attempts:
        cells = {name: text_of(row.get(name)) for name in names}
        file.add_trial(start_time=row["begin_s"], stop_time=row["end_s"], **cells)
    events = timed_events(run)
    if events:
        about = "events of the recording as JSON objects"
        columns = [
            pynwb.event.TimestampVectorData(
                name="timestamp", description="time since tick 0 [s]", data=[event["t_s"] for event in events]
            ),
            pynwb.core.VectorData(name="annotation", description="all values of the event", data=_written(events)),
        ]
        file.add_events_table(pynwb.event.EventsTable(name="events", description=about, columns=columns))


def _set_identities(file: NWBFile) -> None:
    """Replace the random identity of each object by one of the recording, so that the same gives the same bytes.

    The library has no setter; a version that names the attribute otherwise would keep its random ones.
    """
    for number, item in enumerate(file.all_children()):
        item._AbstractContainer__object_id = str(uuid5(NAMESPACE_URL, f"{file.identifier}/{number}/{item.name}"))


EXPORTER = _Nwb()
