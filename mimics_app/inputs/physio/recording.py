"""Files of body signals: CSV, EDF and WFDB, each read as signals on a regular time grid.

Missing samples are NaN; nothing is interpolated.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.clock import SECOND_NS
from mimics_app.contracts.errors import Issue, SceneError, UsageError, first_line
from mimics_app.contracts.input_port import SignalSource
from mimics_app.contracts.messages import Experience, SignalBlock
from mimics_app.inputs.physio.edf_file import read_edf_channels

__all__ = ["FileSource", "Recorded", "columns_of", "read_signal_file", "unit_factor"]

_LONGEST_S = 7 * 24 * 3600.0
"""Longest recording [s]."""
_HIGHEST_RATE = 20_000.0
"""Highest sampling rate [Hz]."""
_MOST_SAMPLES = 1 << 28
"""Longest grid: 74 h at 1 kHz, 2 GiB."""

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
        values: Samples in the unit of the signal, shape [n]; NaN where missing.
    """

    name: str
    rate: float
    start_s: float
    values: NDArray[np.float64]


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
    import pyarrow as pa
    from pyarrow import csv

    try:
        options = csv.ConvertOptions(null_values=["", "nan", "NaN", "NA", "null"])
        table = csv.read_csv(path, convert_options=options)
    except (pa.ArrowException, OSError) as error:
        raise SceneError(Issue(str(path), "", f"it cannot be read: {first_line(error)}")) from error
    columns: dict[str, NDArray[np.float64]] = {}
    for i, label in enumerate(table.column_names):
        try:
            columns.setdefault(label.strip().lower(), table.column(i).cast(pa.float64()).to_numpy())
        except (pa.ArrowException, ValueError) as error:
            if _name_of_channel(label) or label.strip().lower() in _TIMES:
                raise SceneError(Issue(str(path), f"/{label}", "the column holds more than numbers")) from error
    times = next((columns[name] for name in _TIMES if name in columns), None)
    if times is None:
        raise SceneError(Issue(str(path), "", "no column holds the time", "add a column t_s in seconds"))
    signals = [(_name_of_channel(label), values) for label, values in columns.items()]
    return [_on_grid(path, name, times, values) for name, values in signals if name]


def _on_grid(path: Path, name: str, times: NDArray[np.float64], values: NDArray[np.float64]) -> Recorded:
    """Place rows on the regular grid of their times: NaN without a row, of several rows of one place the first."""
    keep = np.isfinite(times)
    times, values = times[keep], values[keep]
    if len(times) < 2:
        raise SceneError(Issue(str(path), "", "fewer than two rows have a time"))
    steps = np.diff(times)
    if not (steps >= 0.0).all():
        row = int(np.argmax(steps < 0.0)) + 1
        raise SceneError(Issue(str(path), "", f"time runs backwards in row {row}", "sort the rows by time"))
    usual = float(np.median(steps[steps > 0.0])) if (steps > 0.0).any() else 0.0
    if usual <= 0.0 or times[-1] - times[0] > _LONGEST_S:
        raise SceneError(Issue(str(path), "", "its rows have all the same time, or last more than a week"))
    regular = steps[np.abs(steps - usual) < 0.3 * usual]  # printed times are rounded: their mean is not
    rate = 1.0 / (float(np.mean(regular)) if len(regular) else usual)
    if not rate <= _HIGHEST_RATE or (times[-1] - times[0]) * rate >= _MOST_SAMPLES:
        what = f"its rows are {usual:g} s apart over {times[-1] - times[0]:g} s"
        raise SceneError(Issue(str(path), "", what, f"at most {_HIGHEST_RATE:g} Hz, and {_MOST_SAMPLES} samples"))
    rate = _plain_rate(rate)
    places = np.round((times - times[0]) * rate).astype(np.int64)
    grid = np.full(int(places[-1]) + 1, np.nan)
    grid[places[::-1]] = values[::-1]
    return Recorded(name, rate, float(times[0]), grid)


def _plain_rate(rate: float) -> float:
    """Return the nominal rate: whole hertz where the estimate agrees with it to 0.02 %."""
    whole = round(rate)
    return float(whole) if whole and abs(rate / whole - 1.0) < 2e-4 else rate


def _read_edf(path: Path) -> list[Recorded]:
    signals = []
    for channel in read_edf_channels(path, lambda label: bool(_name_of_channel(label))):
        name = _name_of_channel(channel.label)
        signals.append(Recorded(name, channel.rate, 0.0, unit_factor(name, channel.unit) * channel.values))
    return signals


def _read_wfdb(path: Path) -> list[Recorded]:
    try:
        import wfdb
    except ImportError as error:
        raise UsageError("WFDB is read by wfdb, which is not installed", 'pip install "mimics_app[signals]"') from error
    try:
        record = wfdb.rdrecord(str(path.with_suffix("")))
    except (OSError, ValueError, KeyError, IndexError) as error:
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
        """Nothing is open."""
