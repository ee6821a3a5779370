"""Where a person's tracked head is over the floor of the room, and where it looks: what a task sees of a tracker."""

from __future__ import annotations

import math
from typing import NamedTuple

from mimics_app.contracts.arrays import F8

__all__ = ["HeadPlace"]


class HeadPlace(NamedTuple):
    """A tracked head in the room, whose screen is towards -z.

    Attributes:
        x, z: Its place over the floor: to the right, and away from the screen [m].
        yaw: Where it looks, about +y from -z: to the left is positive [rad].
    """

    x: float
    z: float
    yaw: float

    @classmethod
    def of(cls, pose: F8) -> HeadPlace:
        """Return what a pose room_from_head, float64 [4, 4], says; rounded, so that a journal keeps it as it was."""
        yaw = math.atan2(float(pose[0, 2]), float(pose[2, 2]))
        return cls(round(float(pose[0, 3]), 5), round(float(pose[2, 3]), 5), round(yaw, 5))
