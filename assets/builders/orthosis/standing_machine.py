"""What stands still: treadmill, frame with the body-weight support, rails, and the bracket at the pelvis."""

from __future__ import annotations

import itertools

from assets.builders.kit.sketch import Point, Sketch
from assets.builders.orthosis.machine_part import ALUMINIUM, ANTHRACITE, BLACK, BLUE, CHROME, WHITE, MachinePart
from assets.builders.orthosis.orthosis_measures import (
    BAR_ASIDE,
    BELT_HEIGHT,
    DRIVE_ASIDE,
    GRIP,
    HIP_DRIVE_PIVOT,
    HIP_HEIGHT,
    SPREADER,
)

__all__ = ["compose_belt", "compose_frame", "compose_pelvis", "compose_treadmill"]

_BEHIND, _AHEAD = -0.95, 1.00
"""Ends of the belt [m]."""
_BELT, _DECK = 0.275, 0.445
"""Half the width of the belt and of the treadmill [m]."""
_MARK = 0.65
"""Length of a repetition of the belt's picture [m]."""
_REAR, _POST = -0.86, 0.50
"""Depth and distance from the middle of the posts [m]."""
_ARCH = 2.34
"""Height of the arch [m]."""
_RAIL = GRIP[1] - 0.035
"""Height of the rails, below the palms [m]."""


def compose_belt() -> Sketch:
    """Return the belt's upper side, and the turns over its rollers."""
    sketch, radius = Sketch(), 0.035
    profile = [(_BEHIND - 0.03, BELT_HEIGHT - radius), (_BEHIND - 0.02, BELT_HEIGHT - 0.010), (_BEHIND, BELT_HEIGHT)]
    profile += [(_AHEAD, BELT_HEIGHT), (_AHEAD + 0.02, BELT_HEIGHT - 0.010), (_AHEAD + 0.03, BELT_HEIGHT - radius)]
    for (z0, y0), (z1, y1) in itertools.pairwise(profile):
        corners: list[Point] = [(-_BELT, y0, z0), (-_BELT, y1, z1), (_BELT, y1, z1), (_BELT, y0, z0)]
        sketch.fan("belt", corners, [((x + _BELT) / (2 * _BELT), z / _MARK) for x, _, z in corners])
    return sketch


def compose_treadmill() -> MachinePart:
    """Return the deck with side rails, end caps, and the column with its panel in front."""
    part, length = MachinePart(), _AHEAD - _BEHIND
    middle = 0.5 * (_AHEAD + _BEHIND)
    part.box("paint", ANTHRACITE, (0.0, 0.032, middle), (2 * _DECK - 0.04, 0.060, length + 0.06), 0.010)
    for side in (1.0, -1.0):
        x = side * 0.5 * (_BELT + _DECK + 0.004)
        part.box("paint", WHITE, (x, 0.052, middle), (_DECK - _BELT - 0.004, 0.100, length + 0.10), 0.012)
        part.box("plastic", BLACK, (x, 0.103, middle), (0.105, 0.006, length - 0.10), 0.002)
        part.box("paint", BLUE, (side * (_DECK + 0.001), 0.058, middle), (0.004, 0.018, length - 0.04), 0.0015)
        for z in (_BEHIND + 0.08, _AHEAD - 0.08):
            part.disc("plastic", BLACK, (x, 0.0, z), (x, 0.012, z), 0.035)
    for z in (_BEHIND - 0.045, _AHEAD + 0.045):
        part.box("paint", ANTHRACITE, (0.0, 0.035, z), (2 * _DECK - 0.03, 0.062, 0.040), 0.010)
    _add_column(part)
    return part


def _add_column(part: MachinePart) -> None:
    """Add the column in front of the person with a screen for what the legs do."""
    z = _AHEAD + 0.13
    part.box("paint", ANTHRACITE, (0.0, 0.020, z), (0.42, 0.040, 0.22), 0.010)
    part.beam("paint", WHITE, (0.0, 0.03, z), (0.0, 1.14, z + 0.03), (0.110, 0.060), 0.014)
    part.beam("paint", BLUE, (0.0, 0.30, z - 0.026), (0.0, 1.02, z - 0.006), (0.018, 0.006), 0.002)
    part.beam("plastic", BLACK, (0.0, 1.15, z + 0.035), (0.0, 1.44, z - 0.030), (0.480, 0.026), 0.008)
    part.beam("screen", (0.05, 0.17, 0.24), (0.0, 1.165, z + 0.0165), (0.0, 1.425, z - 0.042), (0.452, 0.004), 0.001)
    bars = (0.42, 0.78, 0.55, 0.66, 0.36, 0.72, 0.50)
    for k, share in enumerate(bars):
        low, high = 1.19, 1.19 + 0.20 * share
        x = 0.18 - 0.06 * k
        colour = (0.10, 0.55, 0.62) if k % 2 else (0.60, 0.66, 0.70)
        at = [(x, y, z + 0.0145 - (y - 1.165) * 0.225) for y in (low, high)]
        part.beam("screen", colour, at[0], at[1], (0.030, 0.004), 0.001)


def compose_frame() -> MachinePart:
    """Return posts, the arch with its pulleys, rope and spreader, and the rails for the hands."""
    part = MachinePart()
    part.beam("paint", WHITE, (-_POST - 0.05, 0.05, _REAR), (_POST + 0.05, 0.05, _REAR), (0.09, 0.09), 0.014)
    corner = _ARCH - 0.16
    for side in (1.0, -1.0):
        x = side * _POST
        part.beam("paint", WHITE, (x, 0.0, _REAR), (x, corner + 0.03, _REAR), (0.085, 0.110), 0.018)
        part.beam("paint", WHITE, (x, corner, _REAR), (side * 0.30, _ARCH, _REAR + 0.14), (0.075, 0.085), 0.018)
        part.beam(
            "paint", WHITE, (side * 0.31, _ARCH, _REAR + 0.11), (side * 0.055, _ARCH, 0.06), (0.060, 0.075), 0.016
        )
        part.beam("paint", BLUE, (x * 1.087, 0.50, _REAR), (x * 1.087, 1.75, _REAR), (0.006, 0.028), 0.002)
        part.beam("paint", WHITE, (x, 0.045, _REAR - 0.10), (x, 0.045, _REAR + 0.42), (0.080, 0.080), 0.014)
        _add_rail(part, side)
    part.box("plastic", ANTHRACITE, (0.0, _ARCH, 0.03), (0.17, 0.10, 0.16), 0.020)
    part.beam("paint", WHITE, (-_POST, 1.62, _REAR), (_POST, 1.62, _REAR), (0.075, 0.075), 0.014)
    part.box("paint", ANTHRACITE, (0.0, 1.42, _REAR - 0.02), (0.34, 0.46, 0.20), 0.022)
    part.box("plastic", BLUE, (0.0, 1.58, _REAR + 0.083), (0.26, 0.03, 0.006), 0.002)
    _add_hoist(part)
    return part


def _add_hoist(part: MachinePart) -> None:
    """Add the rope from the winch over two pulleys down to the spreader, and its hooks."""
    rear = (0.0, _ARCH - 0.075, _REAR + 0.20)
    part.pipe("fabric", BLACK, [(0.0, 1.64, _REAR + 0.03), (0.0, _ARCH - 0.06, _REAR + 0.19)], 0.0055, 8)
    part.pipe("fabric", BLACK, [(0.0, _ARCH - 0.045, _REAR + 0.21), (0.0, _ARCH - 0.045, 0.0)], 0.0055, 8)
    part.pipe("fabric", BLACK, [(0.0, _ARCH - 0.05, 0.03), (0.0, SPREADER[1] + 0.07, 0.0)], 0.0055, 8)
    for _, y, z in (rear, (0.0, _ARCH - 0.075, 0.0)):
        part.disc("metal", ALUMINIUM, (-0.012, y, z), (0.012, y, z), 0.034)
        part.disc("plastic", BLACK, (-0.015, y, z), (0.015, y, z), 0.012)
    part.beam("paint", WHITE, (0.31, _ARCH, _REAR + 0.14), (-0.31, _ARCH, _REAR + 0.14), (0.060, 0.060), 0.014)
    x, y, z = SPREADER
    part.pipe("metal", ALUMINIUM, [(-x, y, z), (-0.75 * x, y + 0.045, z), (0.75 * x, y + 0.045, z), (x, y, z)], 0.013)
    part.box("plastic", ANTHRACITE, (0.0, y + 0.058, z), (0.07, 0.06, 0.04), 0.012)
    for side in (1.0, -1.0):
        part.disc("plastic", BLUE, (side * x - 0.012, y, z), (side * x + 0.012, y, z), 0.022)


def _add_rail(part: MachinePart, side: float) -> None:
    """Add a rail for a hand, with its posts on the treadmill and a grip."""
    x, post = side * GRIP[0], side * (_DECK - 0.03)
    line: list[Point] = [(post, 0.10, -0.62), (post, 0.90, -0.62), (x, _RAIL, -0.40), (x, _RAIL, 0.46)]
    line += [(post, 0.86, 0.68), (post, 0.10, 0.68)]
    part.pipe("metal", ALUMINIUM, line, 0.019, 12)
    part.pipe("plastic", BLACK, [(x, _RAIL, 0.02), (x, _RAIL, 0.40)], 0.024, 12)
    for z in (-0.62, 0.68):
        part.disc("plastic", ANTHRACITE, (post, 0.098, z), (post, 0.128, z), 0.036, 0.028)


def compose_pelvis() -> MachinePart:
    """Return the bracket that carries both hips: pad, beam, arms to the hip axes, and the links to the frame."""
    part, y = MachinePart(), HIP_HEIGHT
    back = HIP_DRIVE_PIVOT[2]
    part.beam("paint", WHITE, (-0.30, y, back), (0.30, y, back), (0.070, 0.080), 0.014)
    part.box("plastic", ANTHRACITE, (0.0, y, back + 0.075), (0.12, 0.10, 0.080), 0.012)
    part.box("fabric", BLUE, (0.0, y + 0.005, back + 0.135), (0.25, 0.17, 0.046), 0.020)
    for side in (1.0, -1.0):
        x, out = side * (BAR_ASIDE - 0.034), side * DRIVE_ASIDE
        part.beam("paint", WHITE, (x, y, back), (x, y, 0.0), (0.018, 0.060), 0.006)
        part.disc("metal", ALUMINIUM, (x - 0.010, y, 0.0), (x + 0.010, y, 0.0), 0.042)
        part.disc("metal", CHROME, (side * 0.19, y, back), (out + side * 0.022, y, back), 0.012)
        part.box("plastic", ANTHRACITE, (side * 0.285, y, back - 0.008), (0.020, 0.075, 0.092), 0.008)
        for height in (-0.055, 0.055):
            part.beam(
                "metal",
                ALUMINIUM,
                (side * 0.15, y + height, back - 0.02),
                (side * 0.15, y + height, _REAR),
                (0.03, 0.03),
            )
    part.beam("paint", WHITE, (-_POST, y, _REAR), (_POST, y, _REAR), (0.085, 0.170), 0.016)
    return part
