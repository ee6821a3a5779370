"""A series on disk field by field, for formats that are written a whole field at a time."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.recording.series import Batch, Series

__all__ = ["Spool", "gridded", "spooled"]

_TIMES = ("t_s", "source_s")


class Spool:
    """Fields of a series in a temporary folder.

    Attributes:
        series: The series.
        rows: Number of its rows.
    """

    def __init__(self, series: Series, folder: Path, rows: int) -> None:
        self.series = series
        self.rows = rows
        self._folder = folder

    def times(self, name: str) -> F8:
        """Return `t_s` or `source_s` [s], shape [rows]."""
        return np.fromfile(self._folder / str(_TIMES.index(name)))

    def shape(self, name: str) -> tuple[int, ...]:
        """Return the shape of a field or of the times: [rows] or [rows, components]."""
        field = next((each for each in self.series.fields if each.name == name), None)
        return (self.rows, len(field.units)) if field is not None and field.vector else (self.rows,)

    def rows_of(self, name: str, begin: int, end: int) -> F8:
        """Return rows of a field or of the times, the first included, the last not."""
        names = [*_TIMES, *(field.name for field in self.series.fields)]
        shape = self.shape(name)
        width = shape[1] if len(shape) > 1 else 1
        values = np.fromfile(
            self._folder / str(names.index(name)), count=(end - begin) * width, offset=begin * width * 8
        )
        return values.reshape(end - begin, *shape[1:])

    def fields(self) -> Iterator[tuple[str, tuple[str, ...], F8]]:
        """Yield name, units and values of each field, shape [rows] or [rows, components]; one is in memory."""
        for number, field in enumerate(self.series.fields, start=len(_TIMES)):
            values = np.fromfile(self._folder / str(number))
            yield field.name, field.units, values.reshape(-1, len(field.units)) if field.vector else values


@contextmanager
def spooled(series: Series, folder: Path, batches: Iterable[Batch] | None = None) -> Iterator[Spool]:
    """Read a series into a temporary folder in `folder`, which is removed at the end.

    Args:
        series: The series.
        folder: A folder on the disk of the export.
        batches: Its batches; None: those of the series.
    """
    with TemporaryDirectory(dir=folder, prefix=".spool_") as scratch:
        rows = 0
        with ExitStack() as stack:
            count = len(_TIMES) + len(series.fields)
            files = [stack.enter_context((Path(scratch) / str(number)).open("wb")) for number in range(count)]
            for batch in series.batches() if batches is None else batches:
                rows += len(batch.t_s)
                files[0].write(batch.t_s.tobytes())
                files[1].write(batch.source_s.tobytes())
                begin = 0
                for field, file in zip(series.fields, files[len(_TIMES) :], strict=True):
                    file.write(batch.values[:, begin : begin + len(field.units)].tobytes())
                    begin += len(field.units)
        yield Spool(series, Path(scratch), rows)


def gridded(series: Series) -> Iterator[Batch]:
    """Yield the rows of a series at its nominal rate: gaps become rows of NaN, no row is moved before another."""
    begin_s, used = 0.0, -1
    for batch in series.batches():
        if used < 0:
            begin_s = float(batch.t_s[0])
        due = np.rint((batch.t_s - begin_s) * series.rate).astype(np.int64)
        rank = np.arange(len(due))
        due = np.maximum.accumulate(np.maximum(due, used + 1 + rank) - rank) + rank
        rows = int(due[-1]) - used
        values = np.full((rows, batch.values.shape[1]), np.nan)
        source_s = np.full(rows, np.nan)
        values[due - used - 1], source_s[due - used - 1] = batch.values, batch.source_s
        t_s = begin_s + np.arange(used + 1, used + 1 + rows) / series.rate
        used = int(due[-1])
        yield Batch(t_s, source_s, values)
