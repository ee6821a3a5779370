"""Where a person looks at rest, estimated from the places of the joints."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from mimics_app.contracts.arrays import F8

__all__ = ["facing"]


_LEAST = 0.15
"""Share of a leg's length below which a distance between joints shows no direction."""

_SIDES = ("left", "right")


def facing(places: F8, slots: Mapping[str, int]) -> float | None:
    """Return the yaw in which a person looks [rad], 0: along +z, pi: along -z; None where no bone shows it.

    Toes lie before ankles. Without toes the left hip and shoulder lie to the left of the right ones.

    Args:
        places: Places of the joints at rest, +y up, [slots, 3].
        slots: Slots of the bones.
    """
    if not all(f"{side}{bone}" in slots for side in _SIDES for bone in ("UpperLeg", "Foot")):
        return None

    def middle(bone: str) -> F8:
        return np.asarray(0.5 * (places[slots[f"left{bone}"]] + places[slots[f"right{bone}"]]))

    leg = float(np.linalg.norm(middle("UpperLeg") - middle("Foot")))
    ways = []
    if all(f"{side}Toes" in slots for side in _SIDES):
        ways.append(middle("Toes") - middle("Foot"))
    for bone in ("UpperArm", "UpperLeg"):
        if all(f"{side}{bone}" in slots for side in _SIDES):
            across = places[slots[f"left{bone}"]] - places[slots[f"right{bone}"]]
            ways.append(np.cross(across, (0.0, 1.0, 0.0)))
    for way in ways:
        if math.hypot(way[0], way[2]) > _LEAST * leg:
            return math.atan2(way[0], way[2])
    return None
