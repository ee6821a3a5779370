"""Emulated serial trackers: a pseudo terminal with the protocol and the line speed of the device."""

from __future__ import annotations

import os
import select
import threading
from collections.abc import Callable

from mimics_app.contracts.clock import MonotonicClock
from mimics_app.inputs.trackers.ascension import flock_record
from mimics_app.inputs.trackers.calibration import UNITS
from mimics_app.inputs.trackers.polhemus import fastrak_record
from mimics_app.inputs.trackers.scripted_person import PERSON_SENSORS, person_at

__all__ = ["EmulatedLine", "emulated_fastrak", "emulated_flock"]

_NS = 1_000_000_000
_BYTE_NS = 10 * _NS // 115_200
"""Time of a byte on the line [ns]: start, eight bits, stop."""
_PERIOD_NS = _NS // 120
"""Time between two reports [ns]."""

Records = Callable[[float], bytes]
"""Time [s] -> record reported at that time."""


class EmulatedLine:
    """A tracker at the other end of a pseudo terminal; its `port` is opened like a serial line.

    Args:
        records: Function that makes the records.
        start: Byte that starts continuous reports.
        stop: Byte that ends them.
        once: Byte that requests one report.

    Attributes:
        port: Name of the terminal's other end.
        sent: Records reported so far, with the time they were sent [ns].
    """

    def __init__(self, records: Records, start: bytes, stop: bytes, once: bytes) -> None:
        self._records, self._start, self._stop, self._once = records, start, stop, once
        self._clock = MonotonicClock()
        import termios
        import tty

        self._own, other = os.openpty()
        tty.setraw(other, termios.TCSANOW)
        self._other = other
        self.port = os.ttyname(other)
        self.sent: list[tuple[int, bytes]] = []
        self._running = False
        self._closing = threading.Event()
        self._thread = threading.Thread(target=self._serve, name="emulated tracker", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Stop the thread and close the terminal."""
        self._closing.set()
        self._thread.join()
        os.close(self._own)
        os.close(self._other)

    def _serve(self) -> None:
        due = self._clock.now_ns()
        while not self._closing.is_set():
            wait_s = min(0.02, max(0.0, (due - self._clock.now_ns()) / _NS)) if self._running else 0.02
            if select.select([self._own], [], [], wait_s)[0]:
                due = self._obey(os.read(self._own, 256), due)
            now = self._clock.now_ns()
            if self._running and now >= due:
                free_ns = self._report()
                due = max(due + _PERIOD_NS, free_ns)

    def _obey(self, said: bytes, due: int) -> int:
        for byte in said:
            command = bytes([byte])
            if command == self._start:
                self._running, due = True, self._clock.now_ns()
            elif command == self._stop:
                self._running = False
            elif command == self._once:
                self._report()
        return due

    def _report(self) -> int:
        """Write a report when the line has transmitted it; return the time at which the line is free again [ns]."""
        begun = self._clock.now_ns()
        data = self._records(begun / _NS)
        self._clock.sleep_until_ns(begun + len(data) * _BYTE_NS)
        now = self._clock.now_ns()
        self.sent.append((now, data))
        os.write(self._own, data)
        return now


def emulated_fastrak(*, stations: int = 1, seed: int = 1) -> EmulatedLine:
    """Emulate a Fastrak on a scripted person: station 1 the head, then chest and hands; centimetres."""

    def records(t_s: float) -> bytes:
        report = b""
        for station in range(1, stations + 1):
            position, angles = person_at(PERSON_SENSORS[station - 1], t_s, seed)
            report += fastrak_record(station, position, angles, UNITS["cm"])
        return report

    return EmulatedLine(records, b"C", b"c", b"P")


def emulated_flock(*, seed: int = 1) -> EmulatedLine:
    """Emulate a bird on a scripted person's right hand, within 0.9 m of the centre of its range."""

    def records(t_s: float) -> bytes:
        (x, y, z), angles = person_at("hand_right", t_s, seed)
        return flock_record((x, y - 1.0, z), angles)

    return EmulatedLine(records, b"@", b"B", b"?")
