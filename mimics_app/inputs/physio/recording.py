"""Files of body signals: CSV, EDF and WFDB, each read as signals on a regular time grid.

Missing samples are NaN; nothing is interpolated.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mimics_app.contracts.clock import SECOND_NS
from mimics_app.contracts.errors import Issue, SceneError, UsageError, first_line
from mimics_app.contracts.input_port import SignalSource
from mimics_app.contracts.messages import Experience, SignalBlock
from mimics_app.inputs.physio.csv_file import CsvFile
from mimics_app.inputs.physio.edf_file import read_edf_channels
from mimics_app.inputs.physio.stored_samples import Samples, SamplesInFile
from mimics_app.inputs.physio.time_grid import HIGHEST_RATE, LONGEST_S, find_grid, on_grid
from mimics_app.inputs.physio.wfdb_header import check_wfdb_header

__all__ = ["FileSource", "Recorded", "columns_of", "read_signal_file", "unit_factor"]

_NAMES = (
    ("ecg", r"ecg|ekg|^ml?i+$|^v[1-6]$|^av[rlf]$|^i{1,3}$|lead"),
    ("gsr", r"gsr|eda|scl?\b|conduct|skin"),
    ("emg", r"emg|muscle"),
    ("resp", r"resp|rsp|breath|thorax|abdom"),
)
_UNIT = re.compile(r"(|milli|micro|nano|[mun])(v|volts?|s|siemens)")
_PREFIXES = {"": 1.0, "m": 1e-3, "milli": 1e-3, "u": 1e-6, "micro": 1e-6, "n": 1e-9, "nano": 1e-9}
_PER_BASE = {"ecg": ("v", 1e3), "emg": ("v", 1e3), "gsr": ("s", 1e6)}
"""First letter of the units of a signal, and its own units per volt or siemens."""
_TIMES = ("t_s", "time_s", "time", "t", "seconds")


@dataclass(frozen=True, slots=True)
class Recorded:
    """One signal of a file.

    Attributes:
        name: "ecg", "gsr", "emg" or "resp".
        rate: Sampling rate [Hz].
        start_s: Time of the first sample as stated in the file [s].
        values: Samples in the unit of the signal, n of them, NaN where missing; long ones are read in parts.
    """

    name: str
    rate: float
    start_s: float
    values: Samples


def _name_of_channel(label: str) -> str:
    """Return the body signal that a channel label stands for, "" for none."""
    plain = label.strip().lower()
    return next((name for name, pattern in _NAMES if re.search(pattern, plain)), "")


def columns_of(labels: Iterable[str]) -> dict[str, int]:
    """Return the number of the first channel of each body signal, by the labels of the channels."""
    columns: dict[str, int] = {}
    for i, label in enumerate(labels):
        name = _name_of_channel(label)
        if name:
            columns.setdefault(name, i)
    return columns


def unit_factor(name: str, unit: str) -> float:
    """Return the factor from a stated unit to that of a body signal, e.g. 1e-3 for "uV" and "ecg".

    1 where the unit is empty or not one of voltage or conductance: the values are then taken as they are.
    """
    base, per_base = _PER_BASE.get(name, ("", 1.0))
    match = _UNIT.fullmatch(unit.strip().lower().replace("\u00b5", "u").replace("\u03bc", "u"))
    return per_base * _PREFIXES[match[1]] if match and match[2][0] == base else 1.0


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
        raise SceneError(Issue(str(path), "", "it has no body signal", "name columns t_s, ecg, gsr, emg, resp"))
    return list(signals.values())


def reader_of(path: Path) -> Callable[[Path], list[Recorded]]:
    """Return the reader of an existing file, by the extension of its name.

    Raises:
        SceneError: The file is missing, or its format is not one of body signals.
    """
    if not path.exists():
        raise SceneError(Issue(str(path), "", "there is no such file"))
    suffixes = [suffix.lower() for suffix in path.suffixes]
    if ".csv" in suffixes[-2:]:
        return _read_csv
    readers = {".edf": _read_edf, ".bdf": _read_edf, ".hea": _read_wfdb, ".dat": _read_wfdb}
    if suffixes and suffixes[-1] in readers:
        return readers[suffixes[-1]]
    raise SceneError(Issue(str(path), "", "no format of body signals", "give .csv, .edf, .bdf, .hea"))


def _read_csv(path: Path) -> list[Recorded]:
    """Read a table with named columns; `t_s` is the time of each row [s]."""
    file = CsvFile(path)
    columns: dict[str, int] = {}
    for number, label in enumerate(file.labels):
        columns.setdefault(label.strip().lower(), number)
    time = next((columns[name] for name in _TIMES if name in columns), None)
    if time is None:
        raise SceneError(Issue(str(path), "", "no column holds the time", "add a column t_s in seconds"))
    grid = find_grid(path, (times for (times,) in file.batches([time])))
    signals = []
    for label, column in columns.items():
        if (name := _name_of_channel(label)) and column != time:
            rows = ((times, values) for times, values in file.batches([time, column]))
            signals.append(Recorded(name, grid.rate, grid.start_s, on_grid(grid, rows)))
    return signals


def _read_edf(path: Path) -> list[Recorded]:
    def factor(label: str, unit: str) -> float:
        name = _name_of_channel(label)
        return unit_factor(name, unit) if name else 0.0

    channels = read_edf_channels(path, factor)
    return [Recorded(_name_of_channel(each.label), each.rate, 0.0, each.values) for each in channels]


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
    names = [_name_of_channel(label) for label in record.sig_name]
    factors = [unit_factor(name, unit) for name, unit in zip(names, record.units, strict=True)]
    return [
        Recorded(name, float(record.fs), 0.0, factors[i] * np.asarray(record.p_signal[:, i], float))
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

    def feel(self, experience: Experience) -> None:
        """Do nothing: a recorded body does not react to the movement."""

    def close(self) -> None:
        """Close the files of signals that are read while they play."""
        for signal in self._signals:
            if isinstance(signal.values, SamplesInFile):
                signal.values.close()
