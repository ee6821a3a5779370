"""No tracker is connected: no pose, rather than a made-up one."""

from __future__ import annotations

from typing import Protocol

__all__ = ["NoTracking", "TrackedPose", "TrackingSource"]

TrackedPose = tuple[float, float, float, float, float, float, float]
"""Position xyz [m] and orientation quaternion xyzw, world frame."""


class TrackingSource(Protocol):
    """One tracker."""

    def pose(self, sensor: str, now_ns: int) -> TrackedPose | None:
        """The newest pose of a sensor, or None where it has not been seen."""
        ...


class NoTracking:
    """A `TrackingSource` that sees nothing."""

    def pose(self, sensor: str, now_ns: int) -> TrackedPose | None:
        """None: no sensor is seen."""
        return None
