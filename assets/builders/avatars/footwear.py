"""Shoes: sections along the foot on a flat sole, with a collar round the ankle."""

from __future__ import annotations

import itertools
import math

import numpy as np

from assets.builders.avatars.draft import Draft
from assets.builders.avatars.fields import F8, step
from assets.builders.avatars.piece import Piece, joined
from assets.builders.avatars.skeleton import Skeleton

__all__ = ["make_shoes"]

_AROUND = 12
_SECTIONS = (
    # share of the length from the heel; half breadth, height of the top, shift outwards of a foot 270 mm long [m]
    (0.000, 0.018, 0.050, 0.000), (0.025, 0.029, 0.066, 0.000), (0.10, 0.0345, 0.080, 0.000),
    (0.28, 0.0370, 0.087, 0.000), (0.44, 0.0380, 0.071, 0.001), (0.55, 0.0420, 0.058, 0.003),
    (0.70, 0.0475, 0.046, 0.004),
    (0.85, 0.0435, 0.038, 0.000), (0.945, 0.031, 0.033, -0.006), (0.99, 0.014, 0.027, -0.009),
)  # fmt: skip
_SOLE = 0.020
"""Height of the sole [m]."""
_SOLE_SHADE, _UPPER_SHADE = np.array([0.42, 0.40, 0.38]), np.ones(3)


def make_shoes(bones: Skeleton, foot: float, ankle_girth: float) -> Piece:
    """A pair of shoes for feet of a length [m]."""
    return joined([_shoe(bones, foot, ankle_girth, side, word) for side, word in ((1, "left"), (-1, "right"))])


def _shoe(bones: Skeleton, foot: float, ankle_girth: float, side: int, word: str) -> Piece:
    draft, scale = Draft(len(bones.names)), foot / 0.270
    ankle, toes = bones.place(f"{word}Foot"), bones.place(f"{word}Toes")
    heel = ankle[2] - 0.064 * scale
    length = foot + 0.018
    turn = 2.0 * math.pi * (np.arange(_AROUND) + 0.5) / _AROUND
    shades: list[F8] = []
    rings = []
    for share, wide, high, shift in _SECTIONS:
        x = np.sign(np.cos(turn)) * np.abs(np.cos(turn)) ** 0.75 * wide * scale
        lift = 0.012 * float(step(0.80, 1.0, np.array([share]))[0]) + 0.006 * float(
            step(0.05, 0.0, np.array([share]))[0]
        )
        up = 0.5 + 0.5 * np.sign(np.sin(turn)) * np.abs(np.sin(turn)) ** 0.85
        y = lift + (high * scale - lift) * up
        sole = y < _SOLE + lift
        x = np.where(sole, x * 1.05 + 0.0012 * np.sign(x), x * (1.0 - 0.22 * step(0.035, 0.09, y)))
        z = np.full(_AROUND, heel + length * share)
        out = ankle[0] + side * (shift * scale + 0.085 * (z - ankle[2]))
        places = np.stack([out + x, y, z], axis=1)
        rings.append(draft.add(places, _carried(bones, word, places, toes)))
        shades += [_SOLE_SHADE if low else _UPPER_SHADE for low in sole]
    for number, (one, two) in enumerate(itertools.pairwise(rings)):
        draft.band(one, two, [i / _AROUND for i in range(_AROUND + 1)], (number / 6.0, (number + 1) / 6.0))
    for ring, back, flip in ((rings[0], -0.007, True), (rings[-1], 0.006, False)):
        middle = np.mean([draft.corners[i] for i in ring], axis=0)
        draft.lid(ring, middle + [0.0, -0.004, back], (0.5, 0.5), flip=flip)
        shades.append(_UPPER_SHADE)
    _collar(draft, bones, word, ankle, scale, ankle_girth)
    shades += [_UPPER_SHADE] * (len(draft.corners) - len(shades))
    return draft.finish("shoes", np.array(shades))


def _carried(bones: Skeleton, word: str, places: F8, toes: F8) -> F8:
    weights = np.zeros((len(places), len(bones.names)))
    bent = step(toes[2] - 0.022, toes[2] + 0.022, places[:, 2])
    weights[:, bones.index(f"{word}Foot")] = 1.0 - bent
    weights[:, bones.index(f"{word}Toes")] = bent
    return weights


def _collar(draft: Draft, bones: Skeleton, word: str, ankle: F8, scale: float, girth: float) -> None:
    """A padded ring about the ankle, closed below inside the shoe."""
    around = 10
    turn = 2.0 * math.pi * np.arange(around) / around
    radius = girth / (2.0 * math.pi)
    rings = []
    for height, grow in ((0.058, 1.14), (0.084, 1.25), (0.095, 1.22), (0.086, 0.98)):
        x = ankle[0] + radius * grow * np.cos(turn) * 0.92
        z = ankle[2] + 0.004 + radius * grow * np.sin(turn) * 1.18
        y = height * scale - 0.006 * np.sin(turn)  # lower ahead
        weights = np.zeros((around, len(bones.names)))
        weights[:, bones.index(f"{word}Foot")] = 1.0
        rings.append(draft.add(np.stack([x, y, z], axis=1), weights))
    for number, (one, two) in enumerate(itertools.pairwise(rings)):
        draft.band(one, two, [i / around for i in range(around + 1)], (number / 8.0, (number + 1) / 8.0), flip=True)
    draft.lid(rings[0], np.array([ankle[0], 0.058 * scale, ankle[2]]), (0.5, 0.5))
    draft.lid(rings[-1], np.array([ankle[0], 0.080 * scale, ankle[2]]), (0.5, 0.5), flip=True)
