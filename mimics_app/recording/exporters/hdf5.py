"""One HDF5 file, for Python, MATLAB, Julia and R."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from mimics_app.recording.exporter_kinds import Exporter
from mimics_app.recording.line_tables import (
    Rows,
    attempts_table,
    columns_of,
    event_kinds,
    event_rows,
    gaps_table,
)
from mimics_app.recording.run import Run
from mimics_app.recording.series import Series, series_of

if TYPE_CHECKING:
    from h5py import Dataset, Group

__all__ = ["EXPORTER"]

_CHUNK_ROWS = 8192
_CACHE_BYTES = 1 << 20
"""Memory for unfinished chunks of each data set."""


class _Hdf5(Exporter):
    """A group for each series, with a data set for each field; groups of events, attempts and gaps.

    Units are in the attribute `units` of each data set, the header of the run is in the attribute `session`.
    """

    about = "HDF5: recording.h5 with the groups haptic, signals, events, attempts and gaps"

    def open(self, run: Run, folder: Path) -> Iterator[Path]:
        """See `Exporter.open`."""
        import h5py

        path = folder / "recording.h5"
        with h5py.File(path, "x", rdcc_nbytes=_CACHE_BYTES) as file:
            series = series_of(run)
            for each in series:
                _write_series(file.create_group(each.name if each.name == "haptic" else f"signals/{each.name}"), each)
            for source, kind in event_kinds(run):
                _write_rows(file.create_group(f"events/{source}_{kind}"), event_rows(run, source, kind))
            _write_rows(file.create_group("attempts"), attempts_table(run))
            _write_rows(file.create_group("gaps"), gaps_table(series))
            file.create_dataset("session", data=json.dumps(run.session))
        yield path


def _write_series(group: Group, series: Series) -> None:
    group.attrs["rate_hz"] = series.rate
    times = [_growing(group, name, ["s"], vector=False) for name in ("t_s", "source_s")]
    fields = [(each, _growing(group, each.name, each.units, vector=each.vector)) for each in series.fields]
    for batch in series.batches():
        _append(times[0], batch.t_s)
        _append(times[1], batch.source_s)
        begin = 0
        for field, data in fields:
            end = begin + len(field.units)
            _append(data, batch.values[:, begin:end] if field.vector else batch.values[:, begin])
            begin = end


def _growing(group: Group, name: str, units: Sequence[str], *, vector: bool) -> Dataset:
    """Create a data set that grows, with the lightest of the compressions that every HDF5 library reads."""
    tail = (len(units),) if vector else ()
    made = group.create_dataset(
        name,
        (0, *tail),
        "f8",
        maxshape=(None, *tail),
        chunks=(_CHUNK_ROWS, *tail),
        compression="gzip",
        compression_opts=1,
        shuffle=True,
    )
    made.attrs["units"] = list(units) if vector else units[0]
    return made


def _append(data: Dataset, values: np.ndarray) -> None:
    rows = len(data)
    data.resize(rows + len(values), axis=0)
    data[rows:] = values


def _write_rows(group: Group, rows: Rows) -> None:
    for name, column in columns_of(rows):
        group.create_dataset(name, data=column if isinstance(column, np.ndarray) else _texts(column))


def _texts(column: list[str]) -> np.ndarray:
    import h5py

    return np.array([text.replace("\0", "") for text in column], dtype=h5py.string_dtype())


EXPORTER = _Hdf5()
