"""A skirt: rings from the waist over the hips that widen downwards, carried by both legs."""

from __future__ import annotations

import itertools
import math

import numpy as np

from assets.builders.avatars.cage import AROUND
from assets.builders.avatars.cloth import TILE, Tailor
from assets.builders.avatars.draft import Draft
from assets.builders.avatars.fields import F8, step
from assets.builders.avatars.piece import Piece
from assets.builders.avatars.skeleton import Skeleton

__all__ = ["make_skirt"]

_HIP_ROW = 3
"""Row of the trunk from which the cloth falls freely."""
_ROWS = 8
_FLARE = 0.20
"""Additional width of the hem, as a share of the hips."""
_FOLDS = 9
_WAVE = 0.013
"""Height of the folds at the hem [m]."""


def make_skirt(tailor: Tailor, bones: Skeleton, *, waist: int, end: float, ease: float) -> Piece:
    """A skirt from a row of the trunk down to a height [m]."""
    draft = Draft(len(bones.names))
    cage = tailor.cage
    turn = 2.0 * math.pi * np.arange(AROUND) / AROUND
    rings = []
    for row in range(waist, _HIP_ROW - 1, -1):
        corners = cage.trunk[row]
        lift = ease * (0.5 if row > waist - 2 else 1.0)
        rings.append(draft.add(cage.places[corners] + lift * tailor.normals[corners], tailor.weights[corners]))
    hip = np.array([draft.corners[i] for i in rings[-1]])
    middle = hip.mean(axis=0)
    out = hip - middle
    size = np.hypot(out[:, 0], out[:, 2])[:, None]
    for share in np.linspace(1.0 / _ROWS, 1.0, _ROWS):
        wave = _WAVE * share**1.3 * np.cos(_FOLDS * turn)[:, None]
        wide = out * np.array([1.0, 0.0, 1.0]) * (1.0 + _FLARE * share + wave / size)
        places = middle + wide
        places[:, 1] = hip[:, 1] + (end - hip[:, 1]) * share
        rings.append(draft.add(places, _carried(bones, places, middle[1])))
    for one, two in itertools.pairwise(rings):
        high, low = (-float(draft.corners[ring[0]][1]) / TILE for ring in (one, two))
        draft.band(one, two, [4.0 * i / AROUND for i in range(AROUND + 1)], (high, low), flip=True)
    foot = np.array([draft.corners[i] for i in rings[-1]])
    skin = cage.places[cage.trunk[waist]]
    draft.hem(rings[0], skin + 0.10 * (skin.mean(axis=0) - skin), skin.mean(axis=0), flip=True)
    inside = foot + 0.04 * (foot.mean(axis=0) - foot) + [0.0, 0.02, 0.0]
    inner = np.array([draft.corners[i] for i in rings[-1 - _ROWS]])
    lining = draft.add(inside, np.array([draft.weights[i] for i in rings[-1]]))
    draft.band(lining, rings[-1], [0.02] * (AROUND + 1), (0.02, 0.02))
    draft.lid(lining, inner.mean(axis=0) - [0.0, 0.02, 0.0], (0.02, 0.02), flip=True)
    shades = np.ones((len(draft.corners), 3))
    wavy = np.array([draft.corners[i] for i in np.concatenate(rings)])
    shades[: len(wavy)] = (0.86 + 0.14 * np.cos(_FOLDS * np.tile(turn, len(rings))) * step(middle[1], end, wavy[:, 1]))[
        :, None
    ]
    shades[lining] = 0.3
    return draft.finish("bottom", shades)


def _carried(bones: Skeleton, places: F8, hip: float) -> F8:
    """Return weights: each leg moves its side, both the middle, and the hips a share of all."""
    weights = np.zeros((len(places), len(bones.names)))
    legs = 0.80 * step(hip + 0.02, hip - 0.22, places[:, 1])
    left = step(-0.12, 0.12, places[:, 0])
    weights[:, bones.index("hips")] = 1.0 - legs
    weights[:, bones.index("leftUpperLeg")] = legs * left
    weights[:, bones.index("rightUpperLeg")] = legs * (1.0 - left)
    return weights
