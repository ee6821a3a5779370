"""Plausibility of tracker reports: finite numbers, positions within range, steps that a person can make."""

from __future__ import annotations

import math

from mimics_app.contracts.ports.tracker_port import TrackerSample

__all__ = ["MOST_SENSORS", "BelievedSensors", "Plausibility"]

MOST_SENSORS = 256
"""Sensors of one tracker; a suit has 60."""
_LONGEST_NAME = 200
"""Longest name of a sensor [characters]."""

_REACH = 20.0
"""Largest distance from a tracker's origin [m]."""
_STEP_M = 0.30
"""Largest displacement between two reports [m]: 9 m/s at 30 Hz, which no hand reaches."""
_STEP_RAD = 1.0
"""Largest rotation between two reports [rad]."""
_FORGET_NS = 500_000_000
"""Time without a report after which steps are not limited [ns]."""


class Plausibility:
    """Filter of one sensor's reports.

    The first report, and one after a leap, is dropped unless the next agrees with it: a record made of line noise
    agrees with no other.

    Attributes:
        received_ns: Time of the newest report, plausible or not [ns].
    """

    def __init__(self) -> None:
        self.received_ns = 0
        self._last: TrackerSample | None = None
        self._waiting: TrackerSample | None = None

    def admits(self, sample: TrackerSample) -> bool:
        """Whether this report is plausible."""
        self.received_ns = sample.t_ns
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


class BelievedSensors:
    """Filters of all sensors of a tracker, at most `MOST_SENSORS`: one that has been silent for long makes room."""

    def __init__(self) -> None:
        self._filters: dict[str, Plausibility] = {}

    def __len__(self) -> int:
        return len(self._filters)

    def admits(self, sample: TrackerSample) -> bool:
        """Whether this report is plausible, and its sensor among those that are followed."""
        known = self._filters.get(sample.sensor)
        if known is None:
            if len(sample.sensor) > _LONGEST_NAME or not self._has_room(sample.t_ns):
                return False
            known = self._filters[sample.sensor] = Plausibility()
        return known.admits(sample)

    def _has_room(self, now_ns: int) -> bool:
        if len(self._filters) >= MOST_SENSORS:
            oldest = min(self._filters, key=lambda name: self._filters[name].received_ns)
            if now_ns - self._filters[oldest].received_ns > _FORGET_NS:
                del self._filters[oldest]
        return len(self._filters) < MOST_SENSORS


def _possible(sample: TrackerSample) -> bool:
    numbers = (*sample.position, *sample.rotation)
    return all(map(math.isfinite, numbers)) and math.hypot(*sample.position) <= _REACH


def _near(first: TrackerSample, second: TrackerSample) -> bool:
    if math.dist(first.position, second.position) > _STEP_M:
        return False
    cosine = abs(sum(a * b for a, b in zip(first.rotation, second.rotation, strict=True)))
    return 2.0 * math.acos(min(1.0, cosine)) <= _STEP_RAD
