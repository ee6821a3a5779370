"""Trackers on a serial line: a thread that reads what there is, a parser, and what is believed of it."""

from __future__ import annotations

from typing import Protocol

from mimics_app.contracts.clock import Clock
from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.tracker_port import TrackerSample, TrackerSink
from mimics_app.inputs.trackers.ascension import FlockParser
from mimics_app.inputs.trackers.calibration import UNITS
from mimics_app.inputs.trackers.polhemus import FastrakParser
from mimics_app.inputs.trackers.threaded_tracker import ThreadedTracker

__all__ = ["SerialTracker", "fastrak", "flock_of_birds"]

_PATIENCE_S = 0.05
"""How long a read waits for the first byte."""


class _Parser(Protocol):
    rejected: int

    def feed(self, data: bytes, t_ns: int) -> list[TrackerSample]: ...


class SerialTracker(ThreadedTracker):
    """One device on a port; see `fastrak` and `flock_of_birds`.

    Args:
        name: As the scene calls it.
        port: Of the line, e.g. /dev/ttyUSB0.
        baud: [bit/s].
        parser: Of its records.
        begin: What is written to make it report continuously.
        end: What makes it stop.
        clock: The session's.
    """

    def __init__(
        self,
        name: str,
        port: str,
        baud: int,
        parser: _Parser,
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
                self._hand_on(data, sink)

    def _hand_on(self, data: bytes, sink: TrackerSink) -> None:
        for sample in self._parser.feed(data, self._clock.now_ns()):
            self._pass_on(sample, sink)
        self.rejected += self._parser.rejected - self._broken
        self._broken = self._parser.rejected


def fastrak(name: str, port: str, baud: int = 115200, clock: Clock | None = None) -> SerialTracker:
    """A Polhemus Fastrak, set to report in centimetres and text, continuously."""
    return SerialTracker(name, port, baud, FastrakParser(UNITS["cm"]), b"F\ru\rC\r", b"c\r", clock)


def flock_of_birds(name: str, port: str, baud: int = 115200, clock: Clock | None = None) -> SerialTracker:
    """An Ascension Flock of Birds of one bird, set to stream position and angles."""
    return SerialTracker(name, port, baud, FlockParser(), b"Y@", b"B", clock)
