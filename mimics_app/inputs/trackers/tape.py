"""Tapes of trackers: recording of every report as a line of JSON, and playback to the last bit."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import msgspec

from mimics_app.contracts.clock import SECOND_NS
from mimics_app.contracts.errors import Issue, SceneError
from mimics_app.contracts.tracker_port import TrackerSample, TrackerSink
from mimics_app.inputs.trackers.polled_tracker import PolledTracker

__all__ = ["TapeTracker", "TapeWriter", "read_tape"]

_LARGEST = 512 << 20
"""Largest tape that is read [bytes]: some ten hours of one person at 120 Hz."""

_UNIT = 0.1
"""Largest deviation of a quaternion's length from 1."""


class _Line(msgspec.Struct, forbid_unknown_fields=True):
    sensor: str
    t_ns: int
    position: tuple[float, float, float]
    rotation: tuple[float, float, float, float]
    device_ns: int | None = None


class TapeWriter:
    """Recorder of reports. Numbers are written so that they are read back to the last bit.

    A disk that takes no more ends the tape, and neither the tracker nor the session.

    Args:
        file: The tape; an existing one is overwritten.

    Attributes:
        problem: Why no more reports are written, "" while they are.
    """

    def __init__(self, file: Path) -> None:
        self.problem = ""
        self._path, self._file = file, file.open("wb")

    def take(self, sample: TrackerSample) -> None:
        """Write a report."""
        if self.problem:
            return
        line = _Line(sample.sensor, sample.t_ns, sample.position, sample.rotation, sample.device_ns)
        with self._noting_trouble():
            self._file.write(msgspec.json.encode(line) + b"\n")

    def close(self) -> None:
        """Close the file."""
        with self._noting_trouble():
            self._file.close()

    @contextmanager
    def _noting_trouble(self) -> Iterator[None]:
        try:
            yield
        except OSError as error:
            self.problem = f"{self._path.name} ends here: {error.strerror}"


def read_tape(file: Path) -> list[TrackerSample]:
    """Read the reports of a tape in their order; a last line that was cut off is left out.

    Raises:
        SceneError: The file is missing, or a line is not a report.
    """
    try:
        if file.stat().st_size > _LARGEST:
            raise SceneError(Issue(str(file), "", f"has more than {_LARGEST >> 20} MB"))
        lines = file.read_bytes().splitlines(keepends=True)
    except OSError as error:
        raise SceneError(Issue(str(file), "", f"cannot be read: {error.strerror}")) from None
    samples = []
    for number, line in enumerate(lines, start=1):
        try:
            read = msgspec.json.decode(line, type=_Line)
        except (msgspec.DecodeError, json.JSONDecodeError) as error:
            if number == len(lines) and not line.endswith(b"\n"):
                break
            raise SceneError(Issue(str(file), f"line {number}", f"is no report of a tracker: {error}")) from None
        if not abs(math.hypot(*read.rotation) - 1.0) <= _UNIT:
            raise SceneError(Issue(str(file), f"line {number}", "its rotation is no unit quaternion"))
        samples.append(TrackerSample(read.sensor, read.t_ns, read.position, read.rotation, read.device_ns))
    return samples


class TapeTracker(PolledTracker):
    """Tracker that plays a tape in session time: a report is delivered with the frame after its own time.

    Args:
        name: Name in the scene.
        file: The tape.

    Raises:
        SceneError: See `read_tape`.
    """

    def __init__(self, name: str, file: Path) -> None:
        super().__init__(name)
        self._samples = read_tape(file)
        self._next = 0
        self._begun_ns: int | None = None

    def _report(self, now_ns: int, sink: TrackerSink) -> None:
        if not self._samples:
            return
        if self._begun_ns is None:
            # A tape of a live session starts at its first report, one of the virtual clock at zero.
            first = self._samples[0].t_ns
            self._begun_ns = 0 if first < SECOND_NS else first - now_ns
        while self._next < len(self._samples) and self._samples[self._next].t_ns - self._begun_ns <= now_ns:
            sample = self._samples[self._next]
            moved = sample.t_ns - self._begun_ns
            sink(TrackerSample(sample.sensor, moved, sample.position, sample.rotation, sample.device_ns))
            self._next += 1
