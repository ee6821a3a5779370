"""Clocks of all stages; no other module of the package reads the time of the operating system."""

from __future__ import annotations

import time
from datetime import UTC, datetime
from typing import Protocol

__all__ = [
    "FRAMES_PER_SECOND",
    "FRAME_NS",
    "LONGEST_FRAME_NS",
    "SECOND_NS",
    "TICKS_PER_SECOND",
    "TICK_NS",
    "Clock",
    "MonotonicClock",
    "Stopwatch",
    "VirtualClock",
    "process_seconds",
    "ticks_until_frame",
    "wall_time",
]

SECOND_NS = 1_000_000_000

TICKS_PER_SECOND = 1000
TICK_NS = SECOND_NS // TICKS_PER_SECOND

FRAMES_PER_SECOND = 60
"""Frame rate of the picture, of the stages called once per frame, and of films [Hz]."""

FRAME_NS = SECOND_NS // FRAMES_PER_SECOND
"""Shortest period of live frames [ns], a sixtieth of a second rounded down."""


LONGEST_FRAME_NS = 17 * TICK_NS
"""Longest period of frames on the virtual clock, of 16 and 17 ticks [ns]."""


class Stopwatch(Protocol):
    """A time that can only be read: session time, or processor time."""

    def now_ns(self) -> int:
        """Return nanoseconds on a scale that never runs backwards."""
        ...


class Clock(Stopwatch, Protocol):
    """Session time that never runs backwards."""

    def sleep_until_ns(self, deadline_ns: int) -> None:
        """Sleep until the deadline; return at once if it has passed."""
        ...


class MonotonicClock:
    """Real time: CLOCK_MONOTONIC, the same scale as the haptic loop and the audio process."""

    def now_ns(self) -> int:
        """Return nanoseconds since a fixed time of this machine."""
        return time.monotonic_ns()

    def sleep_until_ns(self, deadline_ns: int) -> None:
        """Sleep to the deadline [ns]."""
        remaining = deadline_ns - time.monotonic_ns()
        if remaining > 0:
            time.sleep(remaining * 1e-9)


class VirtualClock:
    """Time that advances only by sleeping: deterministic, and as fast as the work."""

    def __init__(self) -> None:
        self._now_ns = 0

    def now_ns(self) -> int:
        """Return the nanoseconds slept so far."""
        return self._now_ns

    def sleep_until_ns(self, deadline_ns: int) -> None:
        """Advance to the deadline [ns]."""
        self._now_ns = max(self._now_ns, deadline_ns)


def process_seconds() -> float:
    """Return the processor time of this process so far, over all threads [s]."""
    return time.process_time()


def ticks_until_frame(frame: int) -> int:
    """Return the ticks due before a frame begins: 17, 16, 17 per frame at 60 Hz, without accumulated rounding."""
    return round(frame * TICKS_PER_SECOND / FRAMES_PER_SECOND)


def wall_time() -> datetime:
    """Return the calendar time (UTC), for names and headers of files only."""
    return datetime.now(UTC)
