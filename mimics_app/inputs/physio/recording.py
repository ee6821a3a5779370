"""Files of body signals: CSV, EDF and WFDB, each read as signals on a regular time grid.

Missing samples are NaN; nothing is interpolated.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mimics_app.contracts.clock import SECOND_NS
from mimics_app.contracts.errors import Issue, SceneError, UsageError, first_line, short_text
from mimics_app.contracts.messages.stage_messages import Experience, SignalBlock
from mimics_app.contracts.ports.input_port import SignalSource
from mimics_app.contracts.system.read_budget import afford
from mimics_app.contracts.system.regular_file import open_regular, read_regular
from mimics_app.inputs.physio.channel_names import (
    NAMES_HINT,
    columns_of,
    say_columns,
    signal_of,
    split_unit,
    unit_factor,
)
from mimics_app.inputs.physio.csv_file import CsvFile
from mimics_app.inputs.physio.edf_file import read_edf_channels
from mimics_app.inputs.physio.integrity import Faults
from mimics_app.inputs.physio.stored_samples import Samples, SamplesInFile
from mimics_app.inputs.physio.time_grid import HIGHEST_RATE, LONGEST_S, find_grid, on_grid

__all__ = ["FileSource", "Recorded", "check_wfdb_header", "read_signal_file"]

_SECONDS = ("t_s", "time_s", "time", "t", "seconds", "timestamp", "zeit", "zeit_s")
_MILLISECONDS = ("t_ms", "time_ms", "timestamp_ms", "milliseconds", "zeit_ms")
"""Names of the column of the time of each row, the first that is there."""
_PER_SECOND = {"": 1.0, "s": 1.0, "sec": 1.0, "seconds": 1.0, "ms": 1e-3}
"""Seconds of the units that may follow its name in brackets."""


@dataclass(frozen=True, slots=True)
class Recorded:
    """One signal of a file.

    Attributes:
        name: "ecg", "gsr", "emg" or "resp".
        rate: Sampling rate [Hz].
        start_s: Time of the first sample as stated in the file [s].
        values: Samples in the unit of the signal, n of them, NaN where missing; long ones are read in parts.
        label: Name of its channel in the file.
        dropped: Number of samples left out: their rows have no time, or that of an earlier one.
        notes: Which columns were read, and which were not.
    """

    name: str
    rate: float
    start_s: float
    values: Samples
    label: str = ""
    dropped: int = 0
    notes: tuple[str, ...] = ()


def read_signal_file(path: Path) -> list[Recorded]:
    """Read the body signals of a file; of several channels of one signal, the first.

    Raises:
        SceneError: The file is missing, cannot be read, or has no body signal.
        UsageError: The library that reads its format is not installed.
    """
    signals: dict[str, Recorded] = {}
    for signal in reader_of(path)(path):
        if signal.name and len(signal.values):
            if not (signal.rate <= HIGHEST_RATE and len(signal.values) <= LONGEST_S * signal.rate):
                what = f"its {signal.name} has {len(signal.values)} samples at {signal.rate:g} Hz"
                fix = f"at most {HIGHEST_RATE:g} Hz, and a week"
                raise SceneError(Issue(str(path), "", what, fix))
            signals.setdefault(signal.name, signal)
    if not signals:
        raise SceneError(Issue(str(path), "", "it has no body signal", NAMES_HINT))
    return list(signals.values())


def reader_of(path: Path) -> Callable[[Path], list[Recorded]]:
    """Return the reader of an existing file, by the extension of its name.

    Raises:
        SceneError: The file is missing, or its format is not one of body signals.
    """
    if not path.exists():
        raise SceneError(Issue(str(path), "", "no such file"))
    suffixes = [suffix.lower() for suffix in path.suffixes]
    if ".csv" in suffixes[-2:]:
        return _read_csv
    readers = {".edf": _read_edf, ".bdf": _read_edf, ".hea": _read_wfdb, ".dat": _read_wfdb}
    if suffixes and suffixes[-1] in readers:
        return readers[suffixes[-1]]
    raise SceneError(Issue(str(path), "", "unsupported file format for body signals", "give .csv, .edf, .bdf, .hea"))


def _read_csv(path: Path) -> list[Recorded]:
    """Read a table with named columns, one of them the time of each row."""
    file = CsvFile(path)
    time, unit_s = _time_column(path, file.labels)
    columns = columns_of("" if number == time else label for number, label in enumerate(file.labels))
    if not columns:
        what = "none of its columns is a body signal: " + ", ".join(f'"{label}"' for label in file.labels)
        raise SceneError(Issue(str(path), "", what, NAMES_HINT))
    grid = find_grid(path, (unit_s * times for (times,) in file.batches([time])))
    notes, signals = say_columns(file.labels, columns, (time,)), []
    for name, column in columns.items():
        factor = unit_factor(name, split_unit(file.labels[column])[1])
        rows = ((unit_s * times, factor * values) for times, values in file.batches([time, column]))
        samples, dropped = on_grid(grid, rows)
        signals.append(Recorded(name, grid.rate, grid.start_s, samples, file.labels[column], dropped, notes))
    return signals


def _time_column(path: Path, labels: Sequence[str]) -> tuple[int, float]:
    """Return the column of the time, and the seconds of its unit.

    Raises:
        SceneError: There is none.
    """
    plain: dict[str, tuple[int, float]] = {}
    for number, label in enumerate(labels):
        name, unit = split_unit(label)
        if (unit := unit.lower()) in _PER_SECOND:
            plain.setdefault(re.sub(r"[^a-z0-9]+", "_", name.lower()), (number, _PER_SECOND[unit]))
    for names, seconds in ((_SECONDS, 1.0), (_MILLISECONDS, 1e-3)):
        for name in names:
            if name in plain:
                return plain[name][0], min(seconds, plain[name][1])
    fix = "add a column t_s in seconds, or t_ms in milliseconds"
    raise SceneError(Issue(str(path), "", "no column holds the time", fix))


def _read_edf(path: Path) -> list[Recorded]:
    def factor(label: str, unit: str) -> float:
        name = signal_of(label)
        return unit_factor(name, unit) if name else 0.0

    channels = read_edf_channels(path, factor)
    return [Recorded(signal_of(each.label), each.rate, 0.0, each.values, each.label) for each in channels]


def _read_wfdb(path: Path) -> list[Recorded]:
    try:
        import wfdb
    except ImportError as error:
        raise UsageError("WFDB is read by wfdb, which is not installed", 'pip install "mimics_app[signals]"') from error
    check_wfdb_header(path.with_suffix(".hea"))
    try:
        record = wfdb.rdrecord(str(path.with_suffix("")))
    except Exception as error:  # the library may raise anything on damaged files
        raise SceneError(Issue(str(path), "", f"it cannot be read: {first_line(error)}")) from error
    names = [signal_of(label) for label in record.sig_name]
    factors = [unit_factor(name, unit) for name, unit in zip(names, record.units, strict=True)]
    return [
        Recorded(name, float(record.fs), 0.0, factors[i] * np.asarray(record.p_signal[:, i], float), record.sig_name[i])
        for i, name in enumerate(names)
    ]


class FileSource(SignalSource):
    """Playback of a file in session time; after its end there are no more samples.

    Args:
        signals: The signals of the file.
    """

    def __init__(self, signals: list[Recorded]) -> None:
        self._signals = signals
        self._first_s = min(signal.start_s for signal in signals)
        self._taken = dict.fromkeys((signal.name for signal in signals), 0)
        self._start_ns: int | None = None

    @property
    def start_s(self) -> float:
        """Time of the first sample as stated in the file [s]."""
        return self._first_s

    @property
    def seconds(self) -> float:
        """Length of the longest signal [s]."""
        return max(each.start_s - self._first_s + len(each.values) / each.rate for each in self._signals)

    @property
    def rates(self) -> Mapping[str, float]:
        """Rate of each signal [Hz]."""
        return {signal.name: signal.rate for signal in self._signals}

    @property
    def faults(self) -> Mapping[str, Faults]:
        """Samples of each signal that were left out."""
        return {each.name: Faults(dropped=each.dropped) for each in self._signals if each.dropped}

    @property
    def notes(self) -> tuple[str, ...]:
        """Which columns were read, and which were not."""
        named = tuple(f'{each.name} is "{short_text(each.label)}"' for each in self._signals if each.label)
        return next((each.notes for each in self._signals if each.notes), named)

    def read(self, now_ns: int) -> tuple[SignalBlock, ...]:
        """Return the samples due since the last read."""
        if self._start_ns is None:
            self._start_ns = now_ns
        blocks = []
        for signal in self._signals:
            begin_ns = self._start_ns + round((signal.start_s - self._first_s) * SECOND_NS)
            due = min(int((now_ns - begin_ns) * signal.rate / SECOND_NS), len(signal.values))
            taken = self._taken[signal.name]
            if due > taken:
                t_ns = begin_ns + round(taken / signal.rate * SECOND_NS)
                blocks.append(SignalBlock(signal.name, signal.rate, t_ns, signal.values[taken:due]))
                self._taken[signal.name] = due
        return tuple(blocks)

    def take_experience(self, experience: Experience) -> None:
        """Do nothing: a recorded body does not react to the movement."""

    def close(self) -> None:
        """Close the files of signals that are read while they play."""
        for signal in self._signals:
            if isinstance(signal.values, SamplesInFile):
                signal.values.close()


_LONGEST = 1 << 20
_MOST_NESTED = 2
"""Headers within headers: a record of segments, and each of these."""


def check_wfdb_header(path: Path, depth: int = 1) -> None:
    """Check a header before the library follows it.

    Raises:
        SceneError: It cannot be read, claims more than is read at once, or names a file that is not in its folder.
    """
    try:
        text = read_regular(path, _LONGEST).decode("latin-1")
    except OSError as error:
        raise SceneError(Issue(str(path), "", f"cannot be read: {error.strerror}")) from error
    lines = [line.split() for line in text.splitlines() if line.strip() and not line.startswith("#")]
    if not lines or len(lines[0]) < 2:
        raise SceneError(Issue(str(path), "", "not a WFDB header"))
    name, signals, *rest = lines[0]
    try:
        samples = int(rest[1]) if len(rest) > 1 else 0
        afford(str(path), "", 8 * max(int(signals), 1) * max(samples, 0), "cut the record")
    except ValueError:
        raise SceneError(Issue(str(path), "", "the WFDB header lacks the numbers of signals and samples")) from None
    for words in lines[1:]:
        if "/" in name and words[0] != "~":
            _check_segment(path, words[0], depth)
        elif "/" not in name:
            _check_beside(path, words[0])


def _check_segment(path: Path, segment: str, depth: int) -> None:
    _check_beside(path, f"{segment}.hea")
    if depth >= _MOST_NESTED:
        raise SceneError(Issue(str(path), "", "WFDB segments that contain segments are not supported"))
    check_wfdb_header(path.with_name(f"{segment}.hea"), depth + 1)


def _check_beside(path: Path, name: str) -> None:
    if Path(name).name != name or name in (".", ".."):
        raise SceneError(Issue(str(path), "", f'"{name}" is not in its folder', "copy the files into one folder"))
    try:
        open_regular(path.with_name(name)).close()
    except OSError as error:
        raise SceneError(Issue(str(path), "", f'"{name}" cannot be read: {error.strerror}')) from error
