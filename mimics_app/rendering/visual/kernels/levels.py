"""Levels of detail by the share of the picture a body covers, with hysteresis."""

from __future__ import annotations

import math

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import B1, F8, I4, U1

__all__ = ["choose_for_texels", "choose_levels", "pick_levels", "show_levels"]


_HYSTERESIS = 0.1
"""Relative distance from a threshold at which the level changes."""


@kernel
def choose_levels(
    leads: I4, centres: F8, radii: F8, counts: I4, coverages: F8, eye: F8, window: float, smaller: float, chosen: I4
) -> None:
    """Choose the level of each body in one view.

    Coverage is the area of the bounding sphere's disc over that of the picture, both at distance 1, at most 1; 1 with
    the camera inside the sphere. In a picture of fewer pixels a level needs a larger coverage, so that its error in
    pixels is the same; the coverage at which the last level vanishes does not depend on the pixels.

    Args:
        leads: Item of each body's finest level, whose sphere is used; -1: none; [b].
        centres: Centres of the items' spheres, world [m], [n, 3].
        radii: Their radii [m], [n].
        counts: Number of levels of each body, [b].
        coverages: Minimum coverage of each level, descending, [b, levels].
        eye: Position of the camera, world [m], [3].
        window: Area of the picture at distance 1.
        smaller: Factor on all coverages but the last of each body, for a picture of fewer pixels; >= 1.
        chosen: Previous level, -1: none; written: the level, or the number of levels where too small; [b].
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
                threshold *= 1.0 - _HYSTERESIS if level >= chosen[body] else 1.0 + _HYSTERESIS
            if covered >= min(threshold, 1.0):
                break
            level += 1
        chosen[body] = level


@kernel
def choose_for_texels(leads: I4, radii: F8, counts: I4, coverages: F8, window: float, chosen: I4) -> None:
    """Choose the coarsest level of each body that suffices for a picture without perspective.

    Args:
        leads: Item of each body's finest level, whose sphere is used; -1: none; [b].
        radii: Radii of the items' spheres [m], [n].
        counts: Number of levels of each body, [b].
        coverages: Minimum coverage of each level, descending, [b, levels].
        window: Area of the picture [m^2].
        chosen: Written: the level, [b].
    """
    for body in range(leads.shape[0]):
        radius = radii[leads[body]] if leads[body] >= 0 else 0.0
        covered = math.pi * radius**2 / window
        level = 0
        while level < counts[body] - 1 and covered < coverages[body, level]:
            level += 1
        chosen[body] = level


@kernel
def pick_levels(finest: I4, shown: U1, casting: B1, families: I4, bodies: U1, out: I4) -> int:
    """Write those items that cast, are shown, and are of the same bodies as some items, or are such an item.

    Args:
        finest: Numbers of these items, ascending, [k].
        shown: 1 where an item is of the chosen level and may be drawn, [n].
        casting: True where an item casts shadows, [n].
        families: Number of each item's body, -1: a body without levels; [n].
        bodies: Scratch, [b].
        out: Written, ascending, [>= n].

    Returns:
        How many items were written.
    """
    bodies[:] = 0
    for item in finest:
        if families[item] >= 0:
            bodies[families[item]] = 1
    count, place = 0, 0
    for item in range(shown.shape[0]):
        while place < finest.shape[0] and finest[place] < item:
            place += 1
        listed = place < finest.shape[0] and finest[place] == item
        wanted = listed or (families[item] >= 0 and bodies[families[item]])
        if wanted and shown[item] and casting[item]:
            out[count] = item
            count += 1
    return count


@kernel
def show_levels(shown: U1, levels: U1, families: I4, chosen: I4, out: U1) -> None:
    """Write 1 for the items of each body's chosen level that may be drawn, 0 for the others.

    Args:
        shown: 1 where an item may be drawn, [n].
        levels: Level each item belongs to, [n].
        families: Number of each item's body, -1: a body without levels; [n].
        chosen: Level of each body, [b].
        out: Written, [n].
    """
    for i in range(shown.shape[0]):
        family = families[i]
        out[i] = shown[i] if family < 0 or chosen[family] == levels[i] else 0
