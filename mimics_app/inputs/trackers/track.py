"""History of one sensor, with interpolation between two reports and prediction after the last one."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.ports.display_port import MAX_PREDICTION_NS
from mimics_app.contracts.ports.tracker_port import STALE_NS, TrackedPose, TrackerSample
from mimics_app.maths.poses import interpolate_pose, pose_from_parts

__all__ = ["Track"]

_KEPT = 1024
"""Length of the history: four seconds at 240 Hz."""

_LEAST_STEP_NS = 1_000_000
"""Shortest interval between two reports that gives a velocity [ns]: a late bus delivers bursts."""


class Track:
    """Ring buffer with one writer, the source's thread, and readers that never wait: the count follows the slot."""

    def __init__(self) -> None:
        self._slots: list[TrackerSample | None] = [None] * _KEPT
        self._count = 0

    @property
    def newest(self) -> TrackerSample | None:
        """The last report."""
        return self._slots[(self._count - 1) % _KEPT] if self._count else None

    def add(self, sample: TrackerSample) -> None:
        """Take a report; one that is not newer than the last is dropped."""
        last = self.newest
        if last is not None and sample.t_ns <= last.t_ns:
            return
        self._slots[self._count % _KEPT] = sample
        self._count += 1

    def pose(self, at_ns: int) -> TrackedPose | None:
        """Return the pose at a time.

        Between two reports it is interpolated. After the last one it is extrapolated at constant linear and angular
        velocity, for at most `MAX_PREDICTION_NS`; beyond, the pose remains there and is marked as capped.

        Args:
            at_ns: Session time [ns].

        Returns:
            None before the first report.
        """
        newest = self.newest
        if newest is None:
            return None
        age = at_ns - newest.t_ns
        before = self._before(at_ns if age <= 0 else newest.t_ns - _LEAST_STEP_NS)
        if age > 0:
            return self._ahead(before, newest, age)
        if before is None:
            return TrackedPose(_matrix(self._oldest()), age, False, False)
        after = self._after(before)
        share = (at_ns - before.t_ns) / (after.t_ns - before.t_ns) if after is not before else 0.0
        return TrackedPose(interpolate_pose(_matrix(before), _matrix(after), share), age, False, False)

    def _ahead(self, before: TrackerSample | None, newest: TrackerSample, age: int) -> TrackedPose:
        stale, capped = age > STALE_NS, age > MAX_PREDICTION_NS
        moving = before is not None and newest.t_ns - before.t_ns <= STALE_NS and not stale
        if before is None or not moving:
            return TrackedPose(_matrix(newest), age, stale, capped)
        share = 1.0 + min(age, MAX_PREDICTION_NS) / (newest.t_ns - before.t_ns)
        return TrackedPose(interpolate_pose(_matrix(before), _matrix(newest), share), age, stale, capped)

    def _before(self, at_ns: int) -> TrackerSample | None:
        """Return the last report at or before a time."""
        count = self._count
        for back in range(1, min(count, _KEPT - 1) + 1):
            sample = self._slots[(count - back) % _KEPT]
            if sample is not None and sample.t_ns <= at_ns:
                return sample
        return None

    def _after(self, before: TrackerSample) -> TrackerSample:
        """Return the report after a given one."""
        count = self._count
        following = before
        for back in range(1, min(count, _KEPT - 1) + 1):
            sample = self._slots[(count - back) % _KEPT]
            if sample is None or sample.t_ns <= before.t_ns:
                break
            following = sample
        return following

    def _oldest(self) -> TrackerSample:
        count = self._count
        sample = self._slots[(count - min(count, _KEPT - 1)) % _KEPT]
        assert sample is not None, "a track with a newest report has an oldest one"
        return sample


def _matrix(sample: TrackerSample) -> NDArray[np.float64]:
    return pose_from_parts(sample.position, sample.rotation)
