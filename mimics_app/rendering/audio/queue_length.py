"""Length of the queue ahead of a live device, adapted to the delays that occur.

A queue outlasts a stall of the machine that is shorter than itself. How long stalls are differs by a factor of ten
between machines and between minutes, so the length follows what is left in the queue at each refill: after an underrun
or a near-miss it grows by as many steps as were missing, and after a time in which less would have sufficed it drops
half of the spare ones. It begins at the upper limit, as nothing is known of the machine yet and the start of a
session is its busiest time, and drops all spare ones at the end of that, down to what earlier sessions needed
(`queue_need.py`).
"""

from __future__ import annotations

import math

from mimics_app.contracts.ports.audio_port import QueueReport

__all__ = ["CALM_S", "OBSERVED_S", "SETTLING_S", "QueueLength"]

SETTLING_S = 5.0
"""Time at the longest length, counted in frames that the device took, without a near-miss, at the start [s]."""

CALM_S = 120.0
"""Time without a near-miss, in either length, before the queue is shortened [s]."""

OBSERVED_S = 30.0
"""Time of observation after the start from which on the need of a session is known [s]."""

_MOST_KEPT = 200
"""Changes and underruns kept for the report; later ones are counted only."""


class QueueLength:
    """Target length of a queue [frames].

    Args:
        shortest: Lower limit [frames].
        longest: Upper limit, from the latency allowed, and the length at the start [frames].
        step: Frames per change, one block.
        margin: A reading of no more than this is a near-miss [frames].
        rate: Frames per second.

    Attributes:
        frames: Present length.
        underruns: Readings at which the queue was empty: audible gaps.
        near_misses: Readings at which no more than `margin` was left.
    """

    def __init__(self, shortest: int, longest: int, step: int, margin: int, rate: int) -> None:
        self.underruns = 0
        self.near_misses = 0
        self._shortest, self._longest = shortest, max(shortest, longest)
        self._step, self._margin, self._rate = step, margin, rate
        self.frames = self._longest_used = self._least = self._least_ever = self._longest
        self._stable = False
        self._since = self._stable_at = self._position = self._needed = 0
        self._changes: list[tuple[float, float]] = []
        self._empty: list[tuple[int, float]] = []

    def limit(self, longest: int, position: int) -> None:
        """Set the upper limit [frames]; a longer queue is shortened, and observed anew.

        Args:
            longest: Upper limit [frames].
            position: Frames mixed so far.
        """
        self._longest = max(self._shortest, longest)
        if self.frames > self._longest:
            self._change(0, position)

    def read(self, left: int, position: int, now_ns: int, *, ran_empty: bool, steady: bool) -> None:
        """Take what is left in the queue before a refill, and change the length where that is due.

        Args:
            left: Frames left; negative: the device has played so much silence.
            position: Frames mixed so far, the time of the reading on the device's scale.
            now_ns: Session time of the reading [ns].
            ran_empty: Whether the device found the queue empty.
            steady: Whether only an underrun may lengthen the queue now: samples of a playing sound are still computed,
                and would come too late for a mixer that works further ahead. A near-miss is then answered later.
        """
        self._least, self._least_ever, self._position = min(self._least, left), min(self._least_ever, left), position
        if self._stable:
            self._needed = max(self._needed, self.frames - left + self._margin)
        if ran_empty:
            self.underruns += 1
            if self.underruns <= _MOST_KEPT:
                self._empty.append((now_ns, self._ms(self.frames)))
            self._change(self._missing(left), position)
            return
        self.near_misses += left <= self._margin
        if steady:
            return
        if self._least <= self._margin:
            self._change(self._missing(self._least), position)
        elif position - self._since >= (CALM_S if self._stable else SETTLING_S) * self._rate:
            spare = (self._least - self._margin - 1) // self._step
            self._change(-((spare + 1) // 2 if self._stable else spare), position)
            if not self._stable:
                self._stable, self._stable_at = True, position

    def report(self) -> QueueReport:
        """Return the lengths and what happened, all but `latency_ms`."""
        report: QueueReport = {
            "ms": self._ms(self.frames),
            "longest_ms": self._ms(self._longest_used),
            "least_left_ms": self._ms(self._least_ever),
            "near_misses": self.near_misses,
            "changes": list(self._changes),
            "empty": list(self._empty),
        }
        if self._stable and self._position - self._stable_at >= OBSERVED_S * self._rate:
            report["needed_ms"] = self._ms(min(self._needed, self._longest))
        return report

    def _missing(self, left: int) -> int:
        """Return the steps by which a longer queue would have kept its margin, at least one."""
        return max(1, math.ceil((self._margin - left) / self._step))

    def _change(self, steps: int, position: int) -> None:
        """Change the length within its limits, and begin a new time of observation."""
        before = self.frames
        self.frames = min(max(before + steps * self._step, self._shortest), self._longest)
        self._longest_used = max(self._longest_used, self.frames)
        self._least, self._since = self.frames, position
        if self.frames != before and len(self._changes) < _MOST_KEPT:
            self._changes.append((round(position / self._rate, 3), self._ms(self.frames)))

    def _ms(self, frames: int) -> float:
        return round(frames / self._rate * 1e3, 3)
