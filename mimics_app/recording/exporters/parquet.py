"""Tables as Apache Parquet, for pandas, R, DuckDB and other programs of data analysis."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from mimics_app.recording.exporter_kinds import Exporter
from mimics_app.recording.exporters._arrow import arrow_numbers, batch_of
from mimics_app.recording.line_tables import (
    Column,
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
    import pyarrow as pa

__all__ = ["EXPORTER"]

_GROUP_ROWS = 16384
"""Rows of a row group, which is in memory as a whole: 11 MB of 83 columns."""


class _Parquet(Exporter):
    """One table a file, compressed; the unit of a column is in its metadata."""

    about = "Parquet: haptic.parquet, signal_NAME.parquet, attempts.parquet, events_SOURCE_KIND.parquet, gaps.parquet"

    def open(self, run: Run, folder: Path) -> Iterator[Path]:
        """See `Exporter.open`."""
        series = series_of(run)
        for each in series:
            name = each.name if each.name == "haptic" else f"signal_{each.name}"
            yield _write_series(folder / f"{name}.parquet", each)
        yield _write_rows(folder / "attempts.parquet", attempts_table(run))
        for source, kind in event_kinds(run):
            yield _write_rows(folder / f"events_{source}_{kind}.parquet", event_rows(run, source, kind))
        yield _write_rows(folder / "gaps.parquet", gaps_table(series))


def _write_series(file: Path, series: Series) -> Path:
    import pyarrow as pa
    from pyarrow.parquet import ParquetWriter

    units = {"t_s": "s", "source_s": "s", **dict(zip(series.columns, series.units, strict=True))}
    fields = [pa.field(name, pa.float64(), metadata={"unit": unit}) for name, unit in units.items()]
    schema = pa.schema(fields, metadata={"rate_hz": json.dumps(series.rate)})
    with ParquetWriter(file, schema, compression="zstd", compression_level=1) as writer:
        waiting: list[pa.RecordBatch] = []
        for batch in series.batches():
            waiting.append(batch_of([batch.t_s, batch.source_s, *batch.values.T], schema))
            if sum(map(len, waiting)) >= _GROUP_ROWS:
                writer.write_table(pa.Table.from_batches(waiting))
                waiting = []
        if waiting:
            writer.write_table(pa.Table.from_batches(waiting))
    return file


def _write_rows(file: Path, rows: Rows) -> Path:
    import pyarrow as pa
    from pyarrow.parquet import write_table

    write_table(pa.table({name: _array(column) for name, column in columns_of(rows)}), file)
    return file


def _array(column: Column) -> pa.Array:
    """Return a column as an Arrow array, vectors as lists."""
    import pyarrow as pa

    if not isinstance(column, np.ndarray):
        return pa.array(column)
    numbers = arrow_numbers(column.reshape(-1))
    if column.ndim == 1:
        return numbers
    return pa.ListArray.from_arrays(pa.array(range(0, column.size + 1, column.shape[1]), pa.int32()), numbers)


EXPORTER = _Parquet()
