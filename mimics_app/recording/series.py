"""Series of numbers in a recording, read batch by batch: what exporters write.

Each row has two times. `source_s` is as its source counted: ticks of the loop times 1 ms, or the time stamp of a signal
on the clock of the run. `t_s` is corrected: seconds since the release of tick 0 on the clock of every `t_ns`, in which
the ticks that a stall dropped are counted.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import partial
from itertools import pairwise

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.clock import SECOND_NS, TICK_NS, TICKS_PER_SECOND
from mimics_app.recording.columns import present_columns, recorded_fields, rows_of, samples_of
from mimics_app.recording.report_values import mapping, number
from mimics_app.recording.run import Run
from mimics_app.recording.signals import SampledSignal, sampled_signals

__all__ = ["SIGNAL_UNITS", "Batch", "Field", "Series", "SeriesGap", "series_of"]

SIGNAL_UNITS = {"ecg": "mV", "emg": "mV", "gsr": "uS", "speed": "m/s", "power": "W", "leg_power": "W", "head": "rad/s"}
"""Unit of each signal; "" where it depends on the sensor."""

_ROWS = 8192
"""Rows of a batch of ticks but for the last, and the least number of samples in one of a signal."""
_MS_NS = 1e6
_MOST_JITTER = 0.5
"""Step between two blocks of a signal, in samples, beyond which there is a gap."""


SeriesGap = tuple[float, float, str]


@dataclass(frozen=True, slots=True)
class Field:
    """A scalar or a vector of a series.

    Attributes:
        name: Its name.
        units: Unit of each component, "1" for dimensionless numbers, "" where it is not known.
        vector: Whether its components are numbered, even where there is one.
    """

    name: str
    units: tuple[str, ...]
    vector: bool = False

    @property
    def columns(self) -> list[str]:
        """Name of each component: "hip_world[0]"."""
        return [f"{self.name}[{i}]" for i in range(len(self.units))] if self.vector else [self.name]


@dataclass(frozen=True, slots=True)
class Batch:
    """Successive rows of a series.

    Attributes:
        t_s: Corrected time of each row [s], shape [n].
        source_s: Time of each row as its source counted it [s], shape [n].
        values: The fields' components, shape [n, columns], NaN where a value is missing.
    """

    t_s: F8
    source_s: F8
    values: F8


@dataclass(frozen=True, slots=True)
class Series:
    """One series of a recording.

    Attributes:
        name: "haptic", or the name of a signal.
        rate: Nominal rate [Hz].
        fields: Its fields, in the order of the columns.
        batches: Reads it from the beginning; one batch at a time is in memory.
        gaps: Return its gaps: begin and end in corrected time [s], and the reason.
    """

    name: str
    rate: float
    fields: tuple[Field, ...]
    batches: Callable[[], Iterator[Batch]]
    gaps: Callable[[], list[SeriesGap]]

    @property
    def columns(self) -> list[str]:
        """Names of the columns of `Batch.values`."""
        return [name for field in self.fields for name in field.columns]

    @property
    def units(self) -> list[str]:
        """Units of the columns of `Batch.values`."""
        return [unit for field in self.fields for unit in field.units]


def series_of(run: Run) -> list[Series]:
    """Return the series of a recording: the ticks of the loop, and each signal."""
    return [_haptic(run), *(_signal(run, name, sampled) for name, sampled in sampled_signals(run.folder).items())]


def _haptic(run: Run) -> Series:
    """Return the recorded fields of the loop but for `t`, which is `source_s`."""
    recorded = recorded_fields(run.layout.extent)
    fields = [Field(each.name, each.units, each.vector) for each in recorded if each.name != "t"]
    return Series("haptic", float(TICKS_PER_SECOND), tuple(fields), partial(_ticks, run), partial(_tick_gaps, run))


def _tick_gaps(run: Run) -> list[SeriesGap]:
    """Return the missing ticks, in the time that ticks count."""
    period = TICK_NS / SECOND_NS
    return [
        ((gap.after_tick + 1) * period, (gap.after_tick + 1 + gap.ticks) * period, gap.why)
        for gap in run.gaps
        if gap.ticks > 0
    ]


def _ticks(run: Run) -> Iterator[Batch]:
    columns = present_columns(run.layout.extent)
    stop_s = number(mapping(run.session.get("safety")).get("late_stop_s"))
    stop_ns = np.inf if stop_s is None else stop_s * SECOND_NS
    dropped_before = 0.0
    for all_columns in _joined(map(rows_of, run.blocks())):
        records = samples_of(all_columns)
        late_ns = np.nan_to_num(records["lateness_ns"])
        dropped = np.where(late_ns > stop_ns, late_ns // _MS_NS, 0.0)
        before = dropped_before + np.cumsum(dropped) - dropped
        dropped_before += float(dropped.sum())
        rows = all_columns[:, columns]
        yield Batch((records["tick"] + before) * TICK_NS / SECOND_NS, rows[:, 0], rows[:, 1:])


def _joined(blocks: Iterable[F8]) -> Iterator[F8]:
    """Yield the rows of blocks, each of shape [n, columns], in batches of equal length."""
    waiting: list[F8] = []
    rows = 0
    for block in blocks:
        waiting.append(block)
        rows += len(block)
        while rows >= _ROWS:
            joined = np.concatenate(waiting)
            yield joined[:_ROWS]
            waiting, rows = [joined[_ROWS:]], rows - _ROWS
    if rows:
        yield np.concatenate(waiting)


def _signal(run: Run, name: str, sampled: SampledSignal) -> Series:
    fields = (Field(name, (SIGNAL_UNITS.get(name, ""),)),)
    read, gaps = partial(_samples, run.start_ns, sampled), partial(_signal_gaps, run.start_ns, sampled)
    return Series(name, sampled.spans[0][1], fields, read, gaps)


def _signal_gaps(start_ns: int, sampled: SampledSignal) -> list[SeriesGap]:
    found: list[SeriesGap] = []
    for (t_ns, rate, count), (next_ns, _, _) in pairwise(sampled.spans):
        end_ns = t_ns + count * SECOND_NS / rate
        if next_ns - end_ns > _MOST_JITTER * SECOND_NS / rate:
            found.append(((end_ns - start_ns) / SECOND_NS, (next_ns - start_ns) / SECOND_NS, "samples are missing"))
    return found


def _samples(start_ns: int, sampled: SampledSignal) -> Iterator[Batch]:
    rows = 0
    times, values = list[F8](), list[F8]()
    for t_ns, rate, block in sampled.blocks():
        times.append(t_ns / SECOND_NS + np.arange(len(block)) / rate)
        values.append(block)
        rows += len(block)
        if rows >= _ROWS:
            yield _samples_batch(start_ns, times, values)
            rows, times, values = 0, [], []
    if rows:
        yield _samples_batch(start_ns, times, values)


def _samples_batch(start_ns: int, times: list[F8], values: list[F8]) -> Batch:
    source_s = np.concatenate(times)
    return Batch(source_s - start_ns / SECOND_NS, source_s, np.concatenate(values)[:, None])
