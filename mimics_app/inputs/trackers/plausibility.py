"""Reports that cannot be: numbers that are none, places out of reach, leaps that nobody makes."""

from __future__ import annotations

import math

from mimics_app.contracts.tracker_port import TrackerSample

__all__ = ["Plausibility"]

_REACH = 20.0
"""Farthest from a tracker's origin that is believed [m]."""
_STEP_M = 0.30
"""Most that a sensor moves between two reports [m]: 9 m/s at 30 Hz, which no hand does."""
_STEP_RAD = 1.0
"""Most that it turns between two reports [rad]."""
_FORGET_NS = 500_000_000
"""After so long without a report [ns] it may be anywhere again."""


class Plausibility:
    """Lets a sensor's reports through one by one.

    The first report, and one after a leap, is held back until the next agrees with it: what line noise makes of a
    record's form agrees with nothing.
    """

    def __init__(self) -> None:
        self._last: TrackerSample | None = None
        self._waiting: TrackerSample | None = None

    def admits(self, sample: TrackerSample) -> bool:
        """Whether this report is to be believed."""
        if not _possible(sample):
            self._waiting = None
            return False
        last = self._last
        known = last is not None and sample.t_ns - last.t_ns <= _FORGET_NS
        if (last is not None and known and _near(last, sample)) or (
            self._waiting is not None and _near(self._waiting, sample)
        ):
            self._last, self._waiting = sample, None
            return True
        self._waiting = sample
        return False


def _possible(sample: TrackerSample) -> bool:
    numbers = (*sample.position, *sample.rotation)
    return all(map(math.isfinite, numbers)) and math.hypot(*sample.position) <= _REACH


def _near(first: TrackerSample, second: TrackerSample) -> bool:
    if math.dist(first.position, second.position) > _STEP_M:
        return False
    cosine = abs(sum(a * b for a, b in zip(first.rotation, second.rotation, strict=True)))
    return 2.0 * math.acos(min(1.0, cosine)) <= _STEP_RAD
