"""Tapes of trackers: recording of every report as a line of JSON, and playback to the last bit."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import msgspec

from mimics_app.contracts.clock import SECOND_NS
from mimics_app.contracts.errors import Issue, SceneError
from mimics_app.contracts.ports.tracker_port import TrackerSample, TrackerSink
from mimics_app.contracts.system.regular_file import open_regular
from mimics_app.inputs.trackers.polled_tracker import PolledTracker

__all__ = ["TapeTracker", "TapeWriter", "read_tape"]

_LONGEST = 4096
"""Longest line of a tape [bytes]; a report has 200."""

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


def read_tape(file: Path) -> Iterator[TrackerSample]:
    """Yield the reports of a tape in their order; a last line that was cut off is left out.

    Raises:
        SceneError: The file is missing, or a line is not a report.
    """
    try:
        with open_regular(file) as stream:
            number = 0
            while line := stream.readline(_LONGEST + 1):
                number += 1
                if (sample := _report(line, file, number, last=not stream.peek(1))) is not None:
                    yield sample
    except OSError as error:
        raise SceneError(Issue(str(file), "", f"cannot be read: {error.strerror}")) from None


def _report(line: bytes, file: Path, number: int, last: bool) -> TrackerSample | None:
    """Return the report of a line, None for one that was cut off."""
    try:
        if len(line) > _LONGEST:
            raise msgspec.DecodeError(f"it has more than {_LONGEST} bytes")
        read = msgspec.json.decode(line, type=_Line)
    except (msgspec.DecodeError, ValueError) as error:  # ValueError: bytes that are no UTF-8
        if last and not line.endswith(b"\n"):
            return None
        raise SceneError(Issue(str(file), f"line {number}", f"is not a tracker report: {error}")) from None
    if not abs(math.hypot(*read.rotation) - 1.0) <= _UNIT:
        raise SceneError(Issue(str(file), f"line {number}", "its rotation is not a unit quaternion"))
    return TrackerSample(read.sensor, read.t_ns, read.position, read.rotation, read.device_ns)


class TapeTracker(PolledTracker):
    """Tracker that plays a tape in session time: a report is delivered with the frame after its own time.

    The whole tape is checked when the tracker is built, and read while it plays, so that it may be long.

    Args:
        name: Name in the scene.
        file: The tape.

    Raises:
        SceneError: See `read_tape`.
    """

    def __init__(self, name: str, file: Path) -> None:
        super().__init__(name)
        for _ in read_tape(file):
            pass
        self._samples = read_tape(file)
        self._next = next(self._samples, None)
        # A tape of a live session starts at its first report, one of the virtual clock at zero.
        self._first_ns = 0 if self._next is None or self._next.t_ns < SECOND_NS else self._next.t_ns
        self._begun_ns: int | None = None

    def _report(self, now_ns: int, sink: TrackerSink) -> None:
        if self._begun_ns is None:
            self._begun_ns = self._first_ns and self._first_ns - now_ns
        while (sample := self._next) is not None and sample.t_ns - self._begun_ns <= now_ns:
            moved = sample.t_ns - self._begun_ns
            sink(TrackerSample(sample.sensor, moved, sample.position, sample.rotation, sample.device_ns))
            try:
                self._next = next(self._samples, None)
            except SceneError as error:  # it was changed after it was checked
                self.problem, self._next = f"the tape ends here: {error}", None
