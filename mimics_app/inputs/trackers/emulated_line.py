"""Serial trackers that are not there: a pseudo terminal that answers like one and is no faster than its line."""

from __future__ import annotations

import os
import random
import select
import threading
from collections.abc import Callable

from mimics_app.contracts.clock import Clock, MonotonicClock
from mimics_app.inputs.trackers.ascension import flock_record
from mimics_app.inputs.trackers.calibration import UNITS
from mimics_app.inputs.trackers.polhemus import fastrak_record
from mimics_app.inputs.trackers.scripted_person import PERSON_SENSORS, person_at

__all__ = ["EmulatedLine", "emulated_fastrak", "emulated_flock"]

_BITS = 10
"""On the line for a byte: start, eight, stop."""
_NS = 1_000_000_000

Records = Callable[[float], bytes]
"""Time [s] -> what is reported then."""


class EmulatedLine:
    """A tracker at the other end of a pseudo terminal; its `port` is opened like a serial line.

    Args:
        records: What it reports.
        start: Byte that makes it report continuously.
        stop: Byte that ends that.
        once: Byte that requests one report.
        baud: [bit/s]; a record goes out no faster than the line would carry it.
        rate: Reports a second.
        lose: Share of bytes that are lost on the way.
        seed: Of which.

    Attributes:
        port: Name of the terminal's other end.
        sent: What was reported so far, whole records by the time they left [ns].
    """

    def __init__(
        self,
        records: Records,
        start: bytes,
        stop: bytes,
        once: bytes,
        *,
        baud: int = 115200,
        rate: float = 120.0,
        lose: float = 0.0,
        seed: int = 1,
        clock: Clock | None = None,
    ) -> None:
        self._records, self._start, self._stop, self._once = records, start, stop, once
        self._byte_ns = _BITS * _NS // baud
        self._period_ns = round(_NS / rate)
        self._lose, self._chance = lose, random.Random(seed)
        self._clock = clock or MonotonicClock()
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
        """End, and take the terminal away."""
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
                due = max(due + self._period_ns, free_ns)

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
        """Write a report when the line has carried it; returns when it is free again [ns]."""
        begun = self._clock.now_ns()
        data = self._records(begun / _NS)
        self._clock.sleep_until_ns(begun + len(data) * self._byte_ns)
        now = self._clock.now_ns()
        self.sent.append((now, data))
        left = bytes(byte for byte in data if self._chance.random() >= self._lose) if self._lose else data
        os.write(self._own, left)
        return now


def emulated_fastrak(
    *, stations: int = 1, baud: int = 115200, rate: float = 120.0, lose: float = 0.0, seed: int = 1
) -> EmulatedLine:
    """A Fastrak on a scripted person: station 1 the head, then chest and hands; centimetres."""

    def records(t_s: float) -> bytes:
        report = b""
        for station in range(1, stations + 1):
            position, angles = person_at(PERSON_SENSORS[station - 1], t_s, seed)
            report += fastrak_record(station, position, angles, UNITS["cm"])
        return report

    return EmulatedLine(records, b"C", b"c", b"P", baud=baud, rate=rate, lose=lose, seed=seed)


def emulated_flock(*, baud: int = 115200, rate: float = 120.0, lose: float = 0.0, seed: int = 1) -> EmulatedLine:
    """A bird on a scripted person's right hand, 0.9 m around the middle of its reach."""

    def records(t_s: float) -> bytes:
        (x, y, z), angles = person_at("hand_right", t_s, seed)
        return flock_record((x, y - 1.0, z), angles)

    return EmulatedLine(records, b"@", b"B", b"?", baud=baud, rate=rate, lose=lose, seed=seed)
