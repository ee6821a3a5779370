"""A polyline on the ground by its length: place, heading and material of the ground."""

from __future__ import annotations

import math

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.world.components.walking import WalkingPath

__all__ = ["GroundPath"]

_BEHIND, _AHEAD = 0.4, 1.6
"""Points of the path whose chord is the heading of a walker [m]: somebody turns before a corner, not in it."""


class GroundPath:
    """A path of a scene.

    Args:
        path: The component.

    Attributes:
        length: Length from the first corner to the last, or once round [m].
    """

    def __init__(self, path: WalkingPath) -> None:
        corners = np.array([*path.points, path.points[0]] if path.closed else path.points, np.float64)
        self._corners, self._closed = corners, path.closed
        self._ends = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(corners, axis=0), axis=1))])
        self._grounds = path.grounds or ("",)
        self.length = float(self._ends[-1])

    def at(self, s: float) -> F8:
        """Return the point at a distance along the path [m], shape [3]; before and beyond it, its end."""
        s = self._within(s)
        return np.array([np.interp(s, self._ends, self._corners[:, axis]) for axis in range(3)])

    def heading(self, s: float) -> float:
        """Return the heading of a walker at a distance along the path [rad], about +y from +z."""
        if not self._closed:  # the chord keeps its length at both ends
            s = min(max(s, _BEHIND), self.length - _AHEAD)
        x, _, z = self.at(s + _AHEAD) - self.at(s - _BEHIND)
        return math.atan2(x, z)

    def ground(self, s: float) -> str:
        """Return the material of the ground at a distance along the path [m]."""
        leg = int(np.searchsorted(self._ends[1:-1], self._within(s), side="right"))
        return self._grounds[min(leg, len(self._grounds) - 1)]

    def _within(self, s: float) -> float:
        return s % self.length if self._closed else min(max(s, 0.0), self.length)
