"""What moves with a leg: bars with cuffs at thigh and shank, the foot lifter, and the linear drives."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from assets.builders.kit.sketch import Point
from assets.builders.orthosis.machine_part import ALUMINIUM, ANTHRACITE, BLACK, BLUE, CHROME, WHITE, MachinePart, ring
from assets.builders.orthosis.orthosis_measures import (
    BAR_ASIDE,
    DRIVE_ASIDE,
    HIP,
    HIP_DRIVE_LEVER,
    KNEE,
    KNEE_DRIVE_LEVER,
    KNEE_DRIVE_PIVOT,
    SCALE,
)

__all__ = ["compose_drive", "compose_foot", "compose_rod", "compose_shank", "compose_thigh"]

_BARE_THIGH = (0.063, 0.066, 0.069, 0.070, 0.069, 0.066, 0.064, 0.064, 0.064, 0.065, 0.065, 0.063)
_SHORTS = (0.103, 0.104, 0.105, 0.105, 0.104, 0.097, 0.088, 0.097, 0.102, 0.103, 0.104, 0.103)
_CALF = (0.063, 0.063, 0.065, 0.065, 0.064, 0.063, 0.062, 0.065, 0.068, 0.069, 0.068, 0.065)
_ANKLE = (0.046, 0.044, 0.044, 0.045, 0.044, 0.044, 0.046, 0.049, 0.053, 0.054, 0.053, 0.049)
"""Radii of the person's left leg, dressed, at even angles from outside to front, unscaled [m]."""
_GAP = 0.007
"""Distance of a cuff from what it lies on [m]: skin moves below it."""


def compose_thigh(side: float) -> MachinePart:
    """Return bar, hub, lever, bracket and cuffs of a thigh; origin: the hip."""
    part, aside = MachinePart(side, 1.0 / SCALE), BAR_ASIDE - HIP[0]
    _add_hub(part, (aside, 0.0, 0.0), 0.046)
    part.beam("paint", WHITE, (aside, -0.03, 0.0), (aside, -0.27, KNEE[2]), (0.030, 0.050))
    part.beam("metal", ALUMINIUM, (aside, -0.25, KNEE[2]), (aside, KNEE[1] + 0.02, KNEE[2]), (0.022, 0.036))
    part.box("plastic", ANTHRACITE, (aside, -0.27, KNEE[2]), (0.038, 0.035, 0.058))
    part.disc("metal", CHROME, (aside + 0.018, -0.27, KNEE[2]), (aside + 0.034, -0.27, KNEE[2]), 0.012)
    _add_lever(part, (aside, 0.0, 0.0), HIP_DRIVE_LEVER)
    _add_lever(part, (aside, KNEE_DRIVE_PIVOT[1], KNEE[2]), KNEE_DRIVE_PIVOT)
    _add_cuff(part, aside, (0.0, (0.74 - 0.9306) * SCALE, 0.0), 0.075, _SHORTS, (-125.0, 118.0))
    _add_cuff(part, aside, (-0.001, (0.595 - 0.9306) * SCALE, 0.0), 0.055, _BARE_THIGH, (-180.0, 180.0))
    return part


def compose_shank(side: float) -> MachinePart:
    """Return bar, hub, lever and cuffs of a shank, and the straps of the foot lifter; origin: the knee."""
    part, aside = MachinePart(side, 1.0 / SCALE), BAR_ASIDE - HIP[0] - KNEE[0]
    _add_hub(part, (aside, 0.0, 0.0), 0.038)
    part.beam("paint", WHITE, (aside, -0.03, 0.0), (aside, -0.21, -0.006), (0.028, 0.044))
    part.beam("metal", ALUMINIUM, (aside, -0.19, -0.006), (aside, -0.33, -0.010), (0.020, 0.032))
    part.box("plastic", ANTHRACITE, (aside, -0.21, -0.006), (0.035, 0.032, 0.051))
    part.disc("metal", CHROME, (aside + 0.016, -0.21, -0.006), (aside + 0.030, -0.21, -0.006), 0.011)
    part.disc("plastic", BLACK, (aside, -0.326, -0.010), (aside, -0.342, -0.010), 0.014)
    _add_lever(part, (aside, 0.0, 0.0), KNEE_DRIVE_LEVER)
    centre = -0.0009 * SCALE, -0.013 * SCALE
    _add_cuff(part, aside, (centre[0], (0.39 - 0.5076) * SCALE, centre[1]), 0.055, _CALF, (-180.0, 180.0))
    _add_cuff(part, aside, (centre[0], (0.22 - 0.5076) * SCALE, centre[1]), 0.050, _ANKLE, (-180.0, 180.0))
    _add_lifter(part, aside)
    return part


def compose_foot(side: float) -> MachinePart:
    """Return the strap over the forefoot that the foot lifter pulls at; origin: the ankle."""
    part = MachinePart(side, 1.0 / SCALE)
    angles = np.radians(np.linspace(-8.0, 188.0, 18))
    rows = []
    for z in (0.116, 0.146):
        at = 0.0135 * SCALE, (0.003 - 0.0846) * SCALE, (z - 0.036) * SCALE
        wide, high = (0.054, 0.057 + 0.35 * (0.131 - z)) if z < 0.13 else (0.056, 0.054)
        rows.append(
            np.stack(
                [at[0] + wide * SCALE * np.cos(angles), at[1] + high * SCALE * np.sin(angles), np.full(18, at[2])], 1
            )
        )
    part.band("fabric", BLACK, rows)
    return part


def compose_drive(length: float) -> MachinePart:
    """Return the housing of a drive of a length [m]; origin: its pivot, the rod comes out along -z."""
    part = MachinePart()
    _add_eye(part, 0.017)
    part.disc("plastic", ANTHRACITE, (0.0, 0.0, 0.006), (0.0, 0.0, -0.070), 0.029, 0.031)
    part.disc("paint", BLUE, (0.0, 0.0, -0.070), (0.0, 0.0, -0.078), 0.0315)
    part.disc("paint", WHITE, (0.0, 0.0, -0.078), (0.0, 0.0, 0.014 - length), 0.024)
    part.disc("metal", ALUMINIUM, (0.0, 0.0, 0.014 - length), (0.0, 0.0, -length), 0.026, 0.018)
    return part


def compose_rod(length: float) -> MachinePart:
    """Return the rod of a drive of a length [m]; origin: where it holds the lever, its housing lies along -z."""
    part = MachinePart()
    _add_eye(part, 0.015)
    part.disc("metal", ALUMINIUM, (0.0, 0.0, 0.0), (0.0, 0.0, -0.030), 0.014)
    part.disc("metal", CHROME, (0.0, 0.0, -0.030), (0.0, 0.0, -length), 0.0095)
    return part


def _add_eye(part: MachinePart, radius: float) -> None:
    part.disc("metal", ALUMINIUM, (-0.011, 0.0, 0.0), (0.011, 0.0, 0.0), radius)
    part.disc("metal", CHROME, (-0.016, 0.0, 0.0), (0.016, 0.0, 0.0), 0.007)


def _add_hub(part: MachinePart, at: Point, radius: float) -> None:
    """Add the bearing of a joint, its axis along x."""
    x, y, z = at
    part.disc("metal", ALUMINIUM, (x - 0.024, y, z), (x + 0.012, y, z), radius)
    part.disc("plastic", ANTHRACITE, (x + 0.012, y, z), (x + 0.022, y, z), radius, 0.88 * radius)
    part.disc("paint", BLUE, (x + 0.022, y, z), (x + 0.024, y, z), 0.55 * radius)


def _add_lever(part: MachinePart, root: Point, tip: Point) -> None:
    """Add a plate from the bar to where a drive holds it, and the pin there."""
    reach = DRIVE_ASIDE - BAR_ASIDE - 0.022
    first, last = (root[0] + reach, root[1], root[2]), (root[0] + reach, tip[1], tip[2])
    part.beam("metal", ALUMINIUM, first, last, (0.010, 0.030), 0.004)
    part.disc("metal", ALUMINIUM, (last[0] - 0.005, tip[1], tip[2]), (last[0] + 0.005, tip[1], tip[2]), 0.019)
    part.disc("metal", CHROME, (root[0], root[1], root[2]), (first[0] + 0.006, root[1], root[2]), 0.013)


def _add_cuff(
    part: MachinePart, aside: float, centre: Point, height: float, leg: Sequence[float], reach: tuple[float, float]
) -> None:
    """Add a shell behind and beside a leg, straps before it with a buckle, and the bracket to the bar.

    Args:
        part: Takes them.
        aside: Of the bar, from the joint [m].
        centre: Middle of the leg there, from the joint [m].
        height: [m].
        leg: Radii of the leg [m].
        reach: Angles at which shell and strap end, from outside to front [degrees].
    """
    x, y, z = centre
    angles = {"shell": (max(reach[0], -165.0), 32.0), "strap": (28.0, min(reach[1], 180.0))}
    if reach[1] - reach[0] >= 360.0:
        angles["strap"] = (28.0, 200.0)
    for what, (first, last) in angles.items():
        turns = np.radians(np.linspace(last, first, 17))
        thick = 0.009 if what == "shell" else 0.005
        half = 0.5 * height if what == "shell" else 0.27 * height
        radii = [SCALE * r + _GAP + thick for r in leg]
        lines = [ring((x, y + h, z), radii, turns) for h in (-half, -0.6 * half, 0.6 * half, half)]
        finish, colour = ("plastic", ANTHRACITE) if what == "shell" else ("fabric", BLACK)
        part.band(finish, colour, lines)
        if what == "shell":
            pad = [ring((x, y + h, z), [r - 0.004 for r in radii], turns) for h in (-1.12 * half, 1.12 * half)]
            part.band("fabric", BLUE, pad)
    front = math.radians(62.0)
    radius = SCALE * float(np.interp(front, np.linspace(0.0, 2.0 * math.pi, 13), [*leg, leg[0]])) + _GAP + 0.008
    at = (x + radius * math.cos(front), y, z + radius * math.sin(front))
    part.box("plastic", BLUE, at, (0.030, 0.52 * height, 0.016), 0.005)
    outside = x + SCALE * leg[0] + _GAP + 0.006
    part.beam("metal", ALUMINIUM, (outside, y, z), (aside - 0.004, y, z), (0.022, 0.030), 0.004)
    part.box("plastic", ANTHRACITE, (aside, y, z), (0.036, 0.044, 0.062))


def _add_lifter(part: MachinePart, aside: float) -> None:
    """Add the bow before the shank, and elastic straps from it to the forefoot, which is at a right angle."""
    y, front = -0.275, 0.088
    bow: list[Point] = [(aside, y, -0.008), (aside, y, front - 0.02), (aside - 0.03, y, front)]
    bow += [(-0.050, y, front)]
    part.pipe("metal", ALUMINIUM, bow, 0.007)
    for x, end in ((0.045, 0.052), (-0.040, -0.024)):
        part.disc("plastic", BLUE, (x - 0.011, y, front), (x + 0.011, y, front), 0.012)
        part.pipe("fabric", BLACK, [(x, y - 0.008, front), (end, -0.466, 0.098)], 0.0045, 8)
