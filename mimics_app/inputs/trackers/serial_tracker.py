"""Trackers on a serial line: a thread that reads, and a parser per device."""

from __future__ import annotations

from typing import Protocol

from mimics_app.contracts.clock import Clock
from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.ports.tracker_port import TrackerSample, TrackerSink
from mimics_app.inputs.trackers.ascension import FlockParser
from mimics_app.inputs.trackers.calibration import UNITS
from mimics_app.inputs.trackers.polhemus import FastrakParser
from mimics_app.inputs.trackers.threaded_tracker import ThreadedTracker

__all__ = ["RecordParser", "SerialTracker", "fastrak", "flock_of_birds"]

_PATIENCE_S = 0.05
"""Time-out of a read [s]."""


class RecordParser(Protocol):
    """Parser of the records of a device.

    Attributes:
        rejected: Number of records that could not be read.
    """

    rejected: int

    def feed(self, data: bytes, t_ns: int) -> list[TrackerSample]:
        """Take bytes that arrived at a time [ns] and return the complete reports."""
        ...


class SerialTracker(ThreadedTracker):
    """One device on a serial port; see `fastrak` and `flock_of_birds`.

    Args:
        name: Name in the scene.
        port: Serial port, e.g. /dev/ttyUSB0.
        baud: Line speed [bit/s].
        parser: Parser of its records.
        begin: Command that starts continuous reports.
        end: Command that stops them.
        clock: The session's clock.
    """

    def __init__(
        self,
        name: str,
        port: str,
        baud: int,
        parser: RecordParser,
        begin: bytes,
        end: bytes,
        clock: Clock | None = None,
    ) -> None:
        super().__init__(name, clock)
        self._port, self._baud, self._parser = port, baud, parser
        self._begin, self._end = begin, end
        self._broken = 0

    def _open(self) -> None:
        import serial

        try:
            self._line = serial.Serial(self._port, self._baud, timeout=_PATIENCE_S)
            self._line.write(self._begin)
        except (OSError, ValueError) as error:
            what = f"the tracker {self.name} on {self._port} cannot be opened: {error}"
            raise DeviceError(what, "mimics devices lists the serial ports") from None

    def _close(self) -> None:
        try:
            self._line.write(self._end)
            self._line.close()
        except OSError:
            self.problem = self.problem or "the line was gone before the stop command could be sent"

    def _read(self, sink: TrackerSink) -> None:
        while not self._stopping.is_set():
            try:
                data = self._line.read(max(1, self._line.in_waiting))
            except (OSError, TypeError) as error:  # TypeError: pyserial, where the port was closed meanwhile
                self.problem = f"the line is gone: {error}"
                return
            if data:
                self._parse(data, sink)

    def _parse(self, data: bytes, sink: TrackerSink) -> None:
        for sample in self._parser.feed(data, self._clock.now_ns()):
            self._deliver(sample, sink)
        self.rejected += self._parser.rejected - self._broken
        self._broken = self._parser.rejected


def fastrak(name: str, port: str, baud: int = 115200, clock: Clock | None = None) -> SerialTracker:
    """Return a Polhemus Fastrak, set to continuous reports in centimetres and text."""
    return SerialTracker(name, port, baud, FastrakParser(UNITS["cm"]), b"F\ru\rC\r", b"c\r", clock)


def flock_of_birds(name: str, port: str, baud: int = 115200, clock: Clock | None = None) -> SerialTracker:
    """Return an Ascension Flock of Birds with one bird, set to stream position and angles."""
    return SerialTracker(name, port, baud, FlockParser(), b"Y@", b"B", clock)
