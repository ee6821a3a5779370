"""Steering of who walks in a gait orthosis by the hips: whose left leg swings further ahead than the right turns right.

On a curve the outer leg takes the longer step. The hips are compared by their mean angles over a stride, so that the
swing of a step does not turn anybody; a small difference counts as none, since nobody walks quite evenly.
"""

from __future__ import annotations

import math

from mimics_app.contracts.messages.leg_motion import LegMotion

__all__ = ["HipSteering"]

_EVEN, _FULL = math.radians(2.0), math.radians(8.0)
"""Differences of the mean hip angles up to which nobody turns, and from which they turn fully [rad]."""


class HipSteering:
    """Watches both hips.

    Attributes:
        aside: To the right, -1 to 1; 0 before the first whole stride.
    """

    def __init__(self) -> None:
        self.aside = 0.0
        self._strikes: int | None = None
        self._sum = self._seconds = 0.0
        self._whole = False

    def read(self, legs: LegMotion, seconds: float) -> float:
        """Take the legs after a time step [s]; return `aside`, which changes with each heel strike of the left foot."""
        self._sum += seconds * (legs.hip_left - legs.hip_right)
        self._seconds += seconds
        strikes = legs.strikes[0] if legs.strikes else None
        if strikes != self._strikes:
            if self._whole and self._seconds > 0.0:
                further = self._sum / self._seconds
                self.aside = math.copysign(min(max(abs(further) - _EVEN, 0.0) / (_FULL - _EVEN), 1.0), further)
            self._whole = self._strikes is not None  # the first reading tells how often they have struck before
            self._strikes, self._sum, self._seconds = strikes, 0.0, 0.0
        return self.aside
