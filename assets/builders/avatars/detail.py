"""Levels of detail of the people's parts, each with vertices of its own: skinning costs little far away."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from assets.builders.avatars.piece import Piece
from assets.builders.avatars.weights import strongest
from mimics_app.world.files.simplify.decimation import decimate

__all__ = ["LEVELS", "Level", "coarser", "coverages"]

_PICTURE = 1920.0 * 1080.0
"""Area of the picture that levels are meant for [px]."""
_DECIMALS = 6
"""Places are simplified as rounded to a micrometre: their last digits differ between processors, and so would decide
which of two edges that lose equally much goes first."""
_PIXELS = 2.0
"""Largest error of a level in the picture [px], of the vertex that is farthest from it."""


@dataclass(frozen=True)
class Level:
    """A level of detail.

    Attributes:
        share: Of the triangles of the finest level.
        influences: Largest number of joints of a vertex.
        moves: Whether it has morphs.
    """

    share: float
    influences: int
    moves: bool


LEVELS = (Level(0.42, 4, True), Level(0.13, 2, False), Level(0.045, 1, False))
"""From fine to coarse, without the finest."""


def coarser(piece: Piece, level: Level) -> tuple[Piece, float]:
    """Return a part with fewer triangles, and the largest distance of a vertex of the part from it [m]."""
    count = max(4, round(level.share * len(piece.triangles)))
    made = decimate(np.round(piece.places, _DECIMALS), piece.triangles.ravel(), count)
    kept, triangles = np.unique(made.indices, return_inverse=True)
    weights = strongest(piece.weights[kept], level.influences)
    return replace(
        piece,
        places=piece.places[kept],
        normals=piece.normals[kept],
        triangles=triangles.reshape(-1, 3),
        weights=weights,
        uvs=piece.uvs[kept],
        shades=piece.shades[kept],
        moves={name: steps[kept] for name, steps in piece.moves.items()} if level.moves else {},
    ), made.error


def coverages(pieces: Sequence[Piece], errors: Sequence[float]) -> list[float]:
    """Return the smallest share of the picture's area at which each level is shown, the finest first.

    Args:
        pieces: The finest level.
        errors: Of the coarser levels [m], rising.
    """
    places = np.concatenate([piece.places for piece in pieces])
    radius = float(np.linalg.norm(places - 0.5 * (places.min(axis=0) + places.max(axis=0)), axis=1).max())
    # A sphere covers c of the picture where its radius is sqrt(c A / pi) pixels; an error is the same share of both.
    least = [min(1.0, math.pi * (_PIXELS * radius / max(error, 1e-6)) ** 2 / _PICTURE) for error in errors]
    return [round(value * (1.0 - 1e-4) ** k, 9) for k, value in enumerate(least)] + [0.0]
