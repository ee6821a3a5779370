"""Levels of detail by how much of the picture a body covers, without flicker at the thresholds."""

from __future__ import annotations

import math

from mimics_app.contracts.arrays import F8, I4, U1
from mimics_app.contracts.kernel import kernel

__all__ = ["HYSTERESIS", "choose_levels", "show_levels"]


HYSTERESIS = 0.1
"""Share of a threshold by which a coverage has to be beyond it before the level changes."""


@kernel
def choose_levels(
    leads: I4, centres: F8, radii: F8, counts: I4, coverages: F8, eye: F8, window: float, smaller: float, chosen: I4
) -> None:
    """The level of each body in one view.

    Coverage is the area of the bounding sphere's disc over that of the picture, both at distance 1, at most 1; 1 with
    the eye inside the sphere. Of a picture of fewer pixels a level has to cover a larger share, for as many pixels to
    be the same; where the last level ends is a share whatever the pixels.

    Args:
        leads: An item of each body's finest level, whose sphere counts; -1: none; [b].
        centres: Of the items' spheres, world [m], [n, 3].
        radii: Of the same [m], [n].
        counts: Levels of each body, [b].
        coverages: Least coverage of each level, falling, [b, most].
        eye: World [m], [3].
        window: Area of the picture at distance 1.
        smaller: Factor on the coverages but each last one, for a picture of fewer pixels; >= 1.
        chosen: The level before, -1: none was; written: the level, or their count for too small; [b].
    """
    for body in range(leads.shape[0]):
        lead = leads[body]
        if lead < 0:
            continue
        away2 = 0.0
        for k in range(3):
            away2 += (centres[lead, k] - eye[k]) ** 2
        radius2 = radii[lead] ** 2
        covered = 1.0 if away2 <= radius2 else min(1.0, math.pi * radius2 / (away2 * window))
        level = 0
        while level < counts[body]:
            threshold = coverages[body, level] * (smaller if level < counts[body] - 1 else 1.0)
            if chosen[body] >= 0:
                threshold *= 1.0 - HYSTERESIS if level >= chosen[body] else 1.0 + HYSTERESIS
            if covered >= min(threshold, 1.0):
                break
            level += 1
        chosen[body] = level


@kernel
def show_levels(shown: U1, levels: U1, families: I4, chosen: I4, out: U1) -> None:
    """Show of each body the items of its level only.

    Args:
        shown: 1 where an item may be drawn, [n].
        levels: Level each item belongs to, [n].
        families: Number of each item's body, -1: it has only one level; [n].
        chosen: Level of each body, [b].
        out: Written, [n].
    """
    for i in range(shown.shape[0]):
        family = families[i]
        out[i] = shown[i] if family < 0 or chosen[family] == levels[i] else 0
