"""Channels of an EDF or BDF file, read in parts; see https://www.edfplus.info for the format.

A file is a header of fixed fields and, after it, records of equal size: of each signal in turn so many samples of two
bytes (EDF) or three (BDF). Nothing is read but the header until the samples are asked for.
"""

from __future__ import annotations

import io
import math
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.errors import Issue, SceneError
from mimics_app.contracts.system.regular_file import open_regular
from mimics_app.inputs.physio.stored_samples import Samples, SamplesInFile, kept

__all__ = ["EdfChannel", "read_edf_channels"]

_HEAD = 256
"""Length of the header, and of what it holds of each signal [bytes]."""
_FIELDS = {"label": 16, "transducer": 80, "unit": 8, "low": 8, "high": 8, "digital_low": 8, "digital_high": 8}
_FIELDS |= {"filter": 80, "count": 8, "reserved": 32}
"""Fields of a signal and their lengths: of each field those of all signals follow each other."""
_MOST_SIGNALS = 1000
_MOST_IN_A_RECORD = 1 << 24
"""Largest record of a file [bytes]; the format recommends at most 61,440."""


@dataclass(frozen=True, slots=True)
class EdfChannel:
    """One channel of a file.

    Attributes:
        label: Its label, without the spaces that fill it.
        rate: Sampling rate [Hz].
        values: Samples, in the file's unit times the factor.
    """

    label: str
    rate: float
    values: Samples


@dataclass(frozen=True, slots=True)
class _Layout:
    """Places of the samples in a file: first byte of the records, their number and size, bytes of a sample."""

    first: int
    records: int
    size: int
    width: int


class _EdfSamples(SamplesInFile):
    """Samples of one channel, scaled where they are read.

    Args:
        stream: The file, that of all channels.
        layout: Layout of its records.
        place: First byte of the channel in a record.
        each: Its samples in a record.
        gain: Signal per digital step.
        zero: Signal at the digital 0.
    """

    def __init__(
        self, stream: io.BufferedReader, layout: _Layout, place: int, each: int, gain: float, zero: float
    ) -> None:
        super().__init__(stream, layout.records * each)
        self._layout, self._place, self._each, self._gain, self._zero = layout, place, each, gain, zero

    def __getitem__(self, part: slice, /) -> NDArray[np.float64]:
        first, last, _ = part.indices(len(self))
        if last <= first:
            return np.zeros(0)
        begin, end = first // self._each, -(-last // self._each)
        raw = b"".join(self._record(number) for number in range(begin, end))
        digital = _integers(raw, self._layout.width)[first - begin * self._each : last - begin * self._each]
        return np.asarray(digital * self._gain + self._zero, np.float64)

    def _record(self, number: int) -> bytes:
        size = self._each * self._layout.width
        self._file.seek(self._layout.first + number * self._layout.size + self._place)
        data = self._file.read(size)
        if len(data) < size:
            raise OSError("the file became shorter while it was read")
        return data

    def __del__(self) -> None:
        """Leave the file to the other channels."""


def read_edf_channels(path: Path, factor: Callable[[str, str], float]) -> list[EdfChannel]:
    """Read channels of an EDF, EDF+C, BDF or BDF+C file.

    Args:
        path: The file.
        factor: Factor by which the samples of a label and a unit are multiplied; 0: the channel is not wanted.

    Raises:
        SceneError: The file cannot be read, is cut off, or has gaps between its records (EDF+D).
    """
    try:
        with ExitStack() as stack:
            stream = stack.enter_context(open_regular(path))
            channels = _channels(stream, path, factor)
            if any(isinstance(each.values, SamplesInFile) for each in channels):
                stack.pop_all()  # the file stays open while it is played
            return channels
    except (OSError, ValueError) as error:
        raise SceneError(
            Issue(str(path), "", f"it cannot be read: {getattr(error, 'strerror', '') or error}")
        ) from error


def _channels(stream: io.BufferedReader, path: Path, factor: Callable[[str, str], float]) -> list[EdfChannel]:
    size = stream.seek(0, io.SEEK_END)
    stream.seek(0)
    head = stream.read(_HEAD)
    width = {b"0       ": 2, b"\xffBIOSEMI": 3}.get(head[:8])
    if width is None:
        raise ValueError("not an EDF or BDF file")
    if head[192:197] in (b"EDF+D", b"BDF+D"):
        fix = "export it as EDF+C, without gaps"
        raise SceneError(Issue(str(path), "", "there are gaps between its records (EDF+D)", fix))
    records, seconds = _number(head[236:244], "number of records"), _number(head[244:252], "duration of a record")
    signals = _number(head[252:256], "number of signals")
    if not 0.0 < seconds < math.inf:
        raise ValueError(f"its records last {seconds:g} s")
    if not 1 <= signals <= _MOST_SIGNALS:
        raise ValueError(f"it states {signals:g} signals")
    fields = _fields(stream.read(_HEAD * int(signals)), int(signals))
    counts = [_number(text, "number of samples in a record") for text in fields["count"]]
    if not all(0 <= count == int(count) for count in counts) or sum(counts) * width > _MOST_IN_A_RECORD:
        raise ValueError(f"its records are stated to have {sum(counts):g} samples")
    layout = _Layout(_HEAD * (1 + int(signals)), int(records), int(sum(counts)) * width, width)
    if _number(head[184:192], "length of the header") != layout.first:
        raise ValueError(f"its header has {layout.first} bytes, and another length is stated")
    if layout.size == 0 or layout.records < 1 or layout.first + layout.records * layout.size != size:
        raise ValueError(f"{records:g} records of {layout.size} bytes are stated, the file has {size} bytes")
    places = np.cumsum([0, *(int(count) * width for count in counts)])
    found = []
    for n, (label, unit) in enumerate(zip(fields["label"], fields["unit"], strict=True)):
        if counts[n] and (by := factor(_words(label), _words(unit))):
            gain, zero = _scale(fields, n)
            samples = _EdfSamples(stream, layout, int(places[n]), int(counts[n]), by * gain, by * zero)
            found.append(EdfChannel(_words(label), counts[n] / seconds, kept(samples)))
    return found


def _fields(data: bytes, signals: int) -> dict[str, list[bytes]]:
    found, at = {}, 0
    for name, length in _FIELDS.items():
        found[name] = [data[at + n * length : at + (n + 1) * length] for n in range(signals)]
        at += signals * length
    if len(data) < at:
        raise ValueError("its header is cut off")
    return found


def _scale(fields: dict[str, list[bytes]], n: int) -> tuple[float, float]:
    """Return the signal per digital step, and at the digital 0."""
    low, high, digital_low, digital_high = (
        _number(fields[name][n], name.replace("_", " ")) for name in ("low", "high", "digital_low", "digital_high")
    )
    if digital_low == digital_high or low == high:
        raise ValueError(f'the range of "{_words(fields["label"][n])}" is empty')
    gain = (high - low) / (digital_high - digital_low)
    return gain, low - gain * digital_low


def _number(text: bytes, what: str) -> float:
    """Return a number of the header.

    Raises:
        ValueError: It is none, or not finite.
    """
    try:
        number = float(text.decode("ascii"))
    except ValueError:
        number = math.nan
    if not math.isfinite(number):
        raise ValueError(f"its {what} is not a number: {_words(text)!r}")
    return number


def _words(text: bytes) -> str:
    return text.decode("latin-1").strip()


def _integers(raw: bytes, width: int) -> NDArray[np.int32]:
    """Return little-endian integers of two or three bytes."""
    if width == 2:
        return np.frombuffer(raw, "<i2").astype(np.int32)
    filled = np.zeros((len(raw) // 3, 4), np.uint8)
    filled[:, 1:] = np.frombuffer(raw, np.uint8).reshape(-1, 3)
    return filled.view("<i4")[:, 0] >> 8
