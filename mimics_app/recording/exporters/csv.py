"""Tables as CSV: the ticks of the loop, the trials, the events of each kind, and each body signal."""

from __future__ import annotations

import csv
from collections.abc import Iterator
from pathlib import Path

from mimics_app.recording.exporter_kinds import Exporter
from mimics_app.recording.exporters._arrow import batch_of
from mimics_app.recording.line_tables import (
    Rows,
    attempts_table,
    event_kinds,
    event_rows,
    gaps_table,
    safe_cell,
    text_of,
)
from mimics_app.recording.run import Run
from mimics_app.recording.series import Series, series_of

__all__ = ["EXPORTER"]


class _Csv(Exporter):
    """One table a file; the first row of a series names each column and its unit: "f_user_world[0] [N]"."""

    about = "CSV: haptic.csv, signal_NAME.csv, attempts.csv, events_SOURCE_KIND.csv, gaps.csv"

    def open(self, run: Run, folder: Path) -> Iterator[Path]:
        """See `Exporter.open`."""
        series = series_of(run)
        for each in series:
            yield _write_series(folder / f"{'' if each.name == 'haptic' else 'signal_'}{each.name}.csv", each)
        yield _write_rows(folder / "attempts.csv", attempts_table(run))
        for source, kind in event_kinds(run):
            yield _write_rows(folder / f"events_{source}_{kind}.csv", event_rows(run, source, kind))
        if gaps := gaps_table(series):
            yield _write_rows(folder / "gaps.csv", gaps)


def _write_series(file: Path, series: Series) -> Path:
    import pyarrow as pa
    from pyarrow.csv import CSVWriter, WriteOptions

    named = zip(series.columns, series.units, strict=True)
    names = ["t_s [s]", "source_s [s]", *(f"{name} [{unit}]" if unit else name for name, unit in named)]
    schema = pa.schema([(name, pa.float64()) for name in names])
    with file.open("xb") as out, CSVWriter(out, schema, write_options=WriteOptions(quoting_style="needed")) as writer:
        for batch in series.batches():
            writer.write_batch(batch_of([batch.t_s, batch.source_s, *batch.values.T], schema))
    return file


def _write_rows(file: Path, rows: Rows) -> Path:
    names = list(dict.fromkeys(name for row in rows for name in row))
    with file.open("x", newline="", encoding="utf-8") as out:
        writer = csv.writer(out)
        writer.writerow(names)
        writer.writerows([_cell(row.get(name)) for name in names] for row in rows)
    return file


def _cell(value: object) -> object:
    return value if isinstance(value, int | float) else safe_cell(text_of(value))


EXPORTER = _Csv()
