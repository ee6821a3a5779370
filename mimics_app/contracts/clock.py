"""The one clock every stage is given. Nothing else in the package asks the operating system for the time."""

from __future__ import annotations

import time
from datetime import UTC, datetime
from typing import Protocol

__all__ = [
    "FRAMES_PER_SECOND",
    "FRAME_NS",
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
"""Of the picture, and of the stages that are called once a frame; a film has as many."""

FRAME_NS = SECOND_NS // FRAMES_PER_SECOND
"""Shortest distance of two live frames, less than a nanosecond short of a sixtieth of a second."""


class Stopwatch(Protocol):
    """What can be read and not waited on: session time, or what a process has computed for."""

    def now_ns(self) -> int:
        """Nanoseconds on its own scale, which never runs backwards."""
        ...


class Clock(Stopwatch, Protocol):
    """Session time that never runs backwards."""

    def sleep_until_ns(self, deadline_ns: int) -> None:
        """Return at the deadline, or at once when it has passed."""
        ...


class MonotonicClock:
    """Real time: CLOCK_MONOTONIC, the same scale as the haptic loop and the audio process."""

    def now_ns(self) -> int:
        """Nanoseconds since some fixed moment of this machine."""
        return time.monotonic_ns()

    def sleep_until_ns(self, deadline_ns: int) -> None:
        """Sleep to the deadline [ns]."""
        remaining = deadline_ns - time.monotonic_ns()
        if remaining > 0:
            time.sleep(remaining * 1e-9)


class VirtualClock:
    """Time that moves only when somebody sleeps on it: deterministic and as fast as the work."""

    def __init__(self) -> None:
        self._now_ns = 0

    def now_ns(self) -> int:
        """Nanoseconds slept so far."""
        return self._now_ns

    def sleep_until_ns(self, deadline_ns: int) -> None:
        """Make it be the deadline [ns]."""
        self._now_ns = max(self._now_ns, deadline_ns)


def process_seconds() -> float:
    """Processor time this process has used so far, all its threads together [s]."""
    return time.process_time()


def ticks_until_frame(frame: int) -> int:
    """Ticks due before frame `frame` begins: 17/17/16 a frame at 60 Hz in a fixed pattern, no float accumulator."""
    return round(frame * TICKS_PER_SECOND / FRAMES_PER_SECOND)


def wall_time() -> datetime:
    """Calendar time (UTC), for names and headers of files only."""
    return datetime.now(UTC)
