"""A finished part of a person: triangles of one material with vertex attributes, weights of joints and morphs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from assets.builders.avatars.fields import F8
from assets.builders.avatars.sheet import I8

__all__ = ["Piece", "joined"]


@dataclass(frozen=True)
class Piece:
    """Vertices and triangles of one material.

    Attributes:
        material: Name of the material.
        places: At rest, body frame [m], [n, 3].
        normals: Unit, [n, 3].
        uvs: Texture coordinates, (0, 0) at the top left, [n, 2].
        triangles: [m, 3].
        weights: Of every joint, each row adds up to 1, [n, joints].
        shades: Linear factors on the colour, [n, 3].
        moves: Displacement of each vertex by each morph at weight 1 [m], [n, 3].
        near: Whether only the finest level of detail has it.
    """

    material: str
    places: F8
    normals: F8
    uvs: F8
    triangles: I8
    weights: F8
    shades: F8
    moves: dict[str, F8] = field(default_factory=dict)
    near: bool = False

    def moved(self, name: str, steps: F8) -> Piece:
        """Return a copy with one more morph."""
        return replace(self, moves=self.moves | {name: steps})


def joined(pieces: Sequence[Piece]) -> Piece:
    """Join pieces of one material; a morph that a piece lacks does not move it."""
    starts = np.cumsum([0] + [len(piece.places) for piece in pieces])
    names = {name: None for piece in pieces for name in piece.moves}
    return Piece(
        pieces[0].material,
        np.concatenate([piece.places for piece in pieces]),
        np.concatenate([piece.normals for piece in pieces]),
        np.concatenate([piece.uvs for piece in pieces]),
        np.concatenate([piece.triangles + start for piece, start in zip(pieces, starts, strict=False)]),
        np.concatenate([piece.weights for piece in pieces]),
        np.concatenate([piece.shades for piece in pieces]),
        {
            name: np.concatenate([piece.moves.get(name, np.zeros_like(piece.places)) for piece in pieces])
            for name in names
        },
    )
