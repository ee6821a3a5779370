"""Models that represent forces: a coil spring on its foot, a horseshoe magnet, an arrow."""

from __future__ import annotations

import math

import numpy as np

from assets.builders.market.sculpt import Colour, Sculpt, bar, capsule_bar, plain, rounded_box, turned
from mimics_app.world.content.meshes.primitives import cylinder

__all__ = ["arrow", "magnet", "magnet_tips", "rounded_cube", "spring", "spring_foot"]

STEEL: Colour = (0.60, 0.62, 0.66)
RED: Colour = (0.66, 0.045, 0.035)
_SPRING_LENGTH = 0.28
"""Length from the foot's lower side to the spring's upper end [m]."""


def spring() -> Sculpt:
    """A coil of eleven turns along +y, its upper end at `_SPRING_LENGTH`."""
    t = np.linspace(0.0, 1.0, 11 * 18 + 1)
    turn = 2.0 * math.pi * 11.0 * t
    ends = np.clip(np.minimum(t, 1.0 - t) / 0.04, 0.0, 1.0)
    radius = 0.020 * (0.35 + 0.65 * ends)
    helix = np.stack([radius * np.cos(turn), 0.012 + (_SPRING_LENGTH - 0.012) * t, -radius * np.sin(turn)], 1)
    return Sculpt().add(bar(helix, np.full(len(t), 0.0024), 8), plain(STEEL, 1, 0.75))


def spring_foot() -> Sculpt:
    """The round foot of the spring."""
    return Sculpt().add(
        cylinder(0.038, 0.012, top_radius=0.034, segments=40), plain((0.10, 0.24, 0.52), 2), at=(0, 0.006, 0)
    )


def _bow(low: float, high: float) -> Sculpt:
    """A part of the horseshoe from an angle to another, lying in the xy plane, its legs down [rad]."""
    angles = np.linspace(low, high, 28)
    bow = np.stack([0.022 * np.cos(angles), 0.022 * np.sin(angles), 0.0 * angles], 1)
    sculpt = Sculpt()
    sculpt.add(bar(bow, np.full(len(angles), 0.0085), 14), plain(RED, 3, 0.75))
    for side in (-1.0, 1.0):
        leg = np.array([[side * 0.022, y, 0.0] for y in (0.0, -0.008, -0.017)])
        sculpt.add(bar(leg, np.full(3, 0.0085), 14), plain(RED, 4, 0.75))
    return sculpt


def magnet() -> Sculpt:
    """A horseshoe, its legs down; the origin lies in its middle."""
    return _bow(0.0, math.pi)


def magnet_tips() -> Sculpt:
    """The bare ends of its legs."""
    sculpt = Sculpt()
    for side in (-1.0, 1.0):
        sculpt.add(cylinder(0.0086, 0.013, segments=28), plain(STEEL, 5, 0.8), at=(side * 0.022, -0.0235, 0.0))
    return sculpt


def arrow() -> Sculpt:
    """An arrow of unit length along +x about the origin, round, its shaft a twentieth of it thick."""
    sculpt = Sculpt()
    colour: Colour = (1.0, 1.0, 1.0)
    shaft = np.array([[x, 0.0, 0.0] for x in (-0.5, -0.2, 0.2)])
    sculpt.add(capsule_bar(shaft, 0.045, 14, 4), colour)
    sculpt.add(cylinder(0.125, 0.34, top_radius=0.001, segments=28), colour, at=(0.33, 0.0, 0.0), turn=turned(z=-90.0))
    return sculpt


def rounded_cube() -> Sculpt:
    """A cube of 70 mm, its edges rounded by 12 mm."""
    return Sculpt().add(rounded_box(0.07, 0.07, 0.07, 0.012, 4), (1.0, 1.0, 1.0))
