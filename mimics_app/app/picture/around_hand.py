"""Views of the operator that every scene has: from other sides of the hand than the person's."""

from __future__ import annotations

import math

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.maths.mat import look_at

__all__ = ["AROUND", "around"]

AROUND: dict[str, tuple[float, float | None]] = {
    "from the left": (-75.0, None),
    "from the right": (75.0, None),
    "from above": (0.0, 80.0),
}
"""Turn from the person's eye to the right, and height over the horizon, None: that of the eye [degrees]."""

_LEAST_REACH = 0.1
"""[m]"""


def around(view: str, world_from_eye: F8, hand: F8) -> F8:
    """Return the camera of a view of `AROUND`: at the eye's distance from the hand, which is in its centre.

    Args:
        view: Name of the view.
        world_from_eye: Pose of the person's camera, float64 [4, 4].
        hand: Position of the hand, world [m], float64 [3].
    """
    turn, rise = AROUND[view]
    away = world_from_eye[:3, 3] - hand
    reach = max(float(np.linalg.norm(away)), _LEAST_REACH)
    heading = math.atan2(away[0], away[2]) + math.radians(turn)
    height = math.asin(min(1.0, max(-1.0, away[1] / reach))) if rise is None else math.radians(rise)
    place = [math.cos(height) * math.sin(heading), math.sin(height), math.cos(height) * math.cos(heading)]
    return look_at(hand + reach * np.array(place), hand)
