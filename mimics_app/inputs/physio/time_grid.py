"""The regular time grid of a recording whose rows each state their time."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.errors import Issue, SceneError
from mimics_app.inputs.physio.stored_samples import KEPT_BYTES, Samples, StoredSamples, kept

__all__ = ["HIGHEST_RATE", "LONGEST_S", "TimeGrid", "find_grid", "on_grid"]

LONGEST_S = 7 * 24 * 3600.0
"""Longest recording [s]."""
HIGHEST_RATE = 20_000.0
"""Highest sampling rate [Hz]."""
_MOST_SAMPLES = 1 << 31
"""Longest grid: 25 days at 1 kHz."""
_SPARSE = 100
"""Places of a grid per row beyond which a file claims more than it holds."""
_SMALL = 10_000_000
"""Places of a grid that a file may have with any number of rows."""
_FIRST_ROWS = 1 << 20
"""Rows from which the usual step is taken."""


@dataclass(frozen=True, slots=True)
class TimeGrid:
    """A grid: time of its first place [s], places per second, number of places."""

    start_s: float
    rate: float
    count: int

    def places(self, times: F8) -> np.ndarray:
        """Return the place of each time."""
        return np.round((times - self.start_s) * self.rate).astype(np.int64)


def find_grid(path: Path, batches: Iterator[F8]) -> TimeGrid:
    """Return the grid of the rows of a file, given their times in batches.

    Raises:
        SceneError: Times run backwards, are too few, or state a grid that the rows do not fill.
    """
    with np.errstate(over="ignore"):  # of times without measure, which are refused below
        return _found(path, batches)


def _found(path: Path, batches: Iterator[F8]) -> TimeGrid:
    first: list[F8] = []
    steps = _Steps()
    start = last = np.nan
    rows = seen = 0
    for batch in batches:
        times = batch[np.isfinite(batch)]
        if not len(times):
            continue
        if rows == 0:
            start = last = times[0]
        step = np.diff(times, prepend=last)[0 if rows else 1 :]
        if not (step >= 0.0).all():
            row = rows + int(np.argmax(step < 0.0)) + (0 if rows else 1)
            raise SceneError(Issue(str(path), "", f"time runs backwards in row {row}", "sort the rows by time"))
        rows, last = rows + len(times), times[-1]
        if seen < _FIRST_ROWS:
            first.append(step)
            seen += len(step)
            if seen >= _FIRST_ROWS:
                steps.begin(np.concatenate(first))
        else:
            steps.add(step)
    if rows < 2:
        raise SceneError(Issue(str(path), "", "fewer than two rows have a time"))
    if seen < _FIRST_ROWS:
        steps.begin(np.concatenate(first))
    return _checked(path, float(start), float(last), rows, steps)


class _Steps:
    """The usual step between rows, and the mean of those near it: printed times are rounded."""

    def __init__(self) -> None:
        self.usual = self._sum = 0.0
        self._count = 0

    def begin(self, steps: F8) -> None:
        """Take the first steps, from which the usual one is found."""
        self.usual = float(np.median(steps[steps > 0.0])) if (steps > 0.0).any() else 0.0
        self.add(steps)

    def add(self, steps: F8) -> None:
        """Take further steps."""
        regular = steps[np.abs(steps - self.usual) < 0.3 * self.usual]
        self._sum, self._count = self._sum + float(regular.sum()), self._count + len(regular)

    @property
    def mean(self) -> float:
        return self._sum / self._count if self._count else self.usual


def _checked(path: Path, start: float, last: float, rows: int, steps: _Steps) -> TimeGrid:
    if steps.usual <= 0.0 or last - start > LONGEST_S:
        raise SceneError(Issue(str(path), "", "its rows have all the same time, or last more than a week"))
    rate = 1.0 / steps.mean
    places = (last - start) * rate
    if not rate <= HIGHEST_RATE or places >= _MOST_SAMPLES:
        what = f"its rows are {steps.usual:g} s apart over {last - start:g} s"
        raise SceneError(Issue(str(path), "", what, f"at most {HIGHEST_RATE:g} Hz, and {_MOST_SAMPLES} samples"))
    if places > max(_SMALL, _SPARSE * rows):
        what = f"its {rows} rows, {steps.usual:g} s apart, are spread over {last - start:g} s"
        raise SceneError(Issue(str(path), "", what, "cut out the time without rows, or state the times at their rate"))
    rate = _plain_rate(rate)
    return TimeGrid(start, rate, round((last - start) * rate) + 1)


def on_grid(grid: TimeGrid, batches: Iterator[tuple[F8, F8]]) -> Samples:
    """Return values on a grid: NaN without a row, of several rows of one place the first.

    Args:
        grid: Grid of the times.
        batches: Times and values, in batches of rows.
    """
    with ExitStack() as stack:
        file = stack.enter_context(tempfile.SpooledTemporaryFile(KEPT_BYTES))
        written = 0
        for times, values in batches:
            known = np.isfinite(times)
            places = grid.places(times[known]) - written
            if not len(places) or places[-1] < 0:
                continue
            new = places >= 0  # another row of the last place of the batch before is left out
            part = np.full(int(places[-1]) + 1, np.nan)
            part[places[new][::-1]] = values[known][new][::-1]
            file.write(part.tobytes())
            written += len(part)
        samples = kept(StoredSamples(file, written))
        if isinstance(samples, StoredSamples):
            stack.pop_all()  # the file is the samples'
        return samples


def _plain_rate(rate: float) -> float:
    """Return the nominal rate: whole hertz where the estimate agrees with it to 0.02 %."""
    whole = round(rate)
    return float(whole) if whole and abs(rate / whole - 1.0) < 2e-4 else rate
