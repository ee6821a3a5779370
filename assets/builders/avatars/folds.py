"""Weights of joints smoothed where a bent limb would turn triangles inside out.

Each part is bent as far as people bend, by linear blending and by dual quaternions. Where a triangle then faces
against the body under it, its vertices take over a share of the weights of their neighbours, until no triangle does.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from assets.builders.avatars.fields import F8
from assets.builders.avatars.piece import Piece
from assets.builders.avatars.postures import SIDES, Pose, X, Y, Z
from assets.builders.avatars.sheet import I8, near_means
from assets.builders.avatars.skeleton import Skeleton
from assets.builders.avatars.weights import strongest
from mimics_app.contracts.arrays import B1
from mimics_app.maths.quat import from_matrix

if TYPE_CHECKING:
    from scipy import sparse

__all__ = ["BENDS", "smooth_folds"]


_BENT = math.radians(120.0)
_ROUNDS, _PATIENCE = 60, 10
"""Largest number of rounds, and number after which smoothing reaches one ring farther from a fold."""
_SHARE = 0.5
"""Share of the mean of its neighbours that a vertex takes over in a round."""
_NEAR = 8.0
"""A vertex is smoothed fully if at least one in this number of its neighbours is at a fold."""
_INFLUENCES = 4
"""Largest number of joints of a vertex, as in the files."""
_LEAST = 1e-7
"""Twice the area of the smallest triangle that counts [m^2]."""
_BELOW = 1e-4
"""Distance of the two points on both sides of a triangle that give the outward direction of the bent body [m]."""


def _elbow(bones: Skeleton, side: int) -> Pose:
    s, c, h = math.sqrt(0.5), math.cos(_BENT), math.sin(_BENT)
    return Pose(bones).arm(side, (side * s, -s, 0.0), (side * s * c, -s * c, h))


def _raised(bones: Skeleton, side: int, collar: float, direction: tuple[float, float, float]) -> Pose:
    x, y, z = direction
    pose = Pose(bones).turn(_of(side, "Shoulder"), (Z, side * collar))
    return pose.arm(side, (side * x, y, z), (side * x, y, 0.1))


def _of(side: int, bone: str) -> str:
    return dict(SIDES)[side] + bone


BENDS: Mapping[str, Callable[[Skeleton, int], Pose]] = {
    "elbow 120": _elbow,
    "knee 120": lambda bones, side: Pose(bones).leg(side, 30.0, 120.0, 0.0),
    "hip 90": lambda bones, side: Pose(bones).leg(side, 90.0, 90.0, 0.0),
    "shoulder 90": lambda bones, side: _raised(bones, side, 14.0, (1.0, 0.0, 0.02)),
    "shoulder 170": lambda bones, side: _raised(bones, side, 35.0, (0.17, 1.0, 0.02)),
    "neck": lambda bones, side: Pose(bones).turn("neck", (Y, side * 25.0)).turn("head", (Y, side * 35.0)),
    "wrist": lambda bones, side: Pose(bones).turn(_of(side, "Hand"), (X, 60.0)),
    "wrist back": lambda bones, side: Pose(bones).turn(_of(side, "Hand"), (X, -60.0)),
}
"""How far people bend, by name and side (1: left, -1: right)."""


class _Bend:
    """A pose of the joints, applied to vertices at rest."""

    def __init__(self, pose: Pose) -> None:
        self._turns, places = pose.places()
        self._moves = places - np.einsum("jab,jb->ja", self._turns, pose.bones.places)
        self._real = np.empty((len(self._turns), 4))
        for joint, turn in enumerate(self._turns):
            from_matrix(np.ascontiguousarray(turn), self._real[joint])
        v, w, moves = self._real[:, :3], self._real[:, 3:], self._moves
        across = w * moves + np.cross(moves, v)
        self._dual = 0.5 * np.concatenate([across, -(moves * v).sum(axis=1, keepdims=True)], axis=1)

    def linear(self, places: F8, weights: F8) -> F8:
        """Return the vertices by linear blend skinning."""
        mixed = (weights @ self._turns.reshape(-1, 9)).reshape(-1, 3, 3)
        return np.asarray(np.einsum("nab,nb->na", mixed, places) + weights @ self._moves)

    def dual(self, places: F8, weights: F8) -> F8:
        """Return the vertices by dual quaternions (Kavan et al. 2008), signs as that of the strongest joint."""
        lead = self._real[np.argmax(weights, axis=1)]
        signed = weights * np.where(lead @ self._real.T < 0.0, -1.0, 1.0)
        r, d = signed @ self._real, signed @ self._dual
        size = np.linalg.norm(r, axis=1, keepdims=True)
        r, d = r / size, d / size
        v, w = r[:, :3], r[:, 3:]
        turned = places + 2.0 * np.cross(v, np.cross(v, places) + w * places)
        return np.asarray(turned + 2.0 * (w * d[:, :3] - d[:, 3:] * v + np.cross(v, d[:, :3])))

    def inside_out(self, piece: Piece, triangles: I8) -> B1:
        """Return which triangles face inwards in this pose, by either kind of skinning."""
        own, t = np.unique(triangles, return_inverse=True)
        t = t.reshape(-1, 3)
        places, weights = piece.places[own], piece.weights[own]
        rest = _faces(places[t])
        size = np.linalg.norm(rest, axis=1)
        unit = rest / np.maximum(size, 1e-15)[:, None]
        middle, mean = places[t].mean(axis=1), weights[t].mean(axis=1)
        outwards = self.dual(middle + _BELOW * unit, mean) - self.dual(middle - _BELOW * unit, mean)
        wrong = np.zeros(len(t), np.bool_)
        for skin in (self.linear, self.dual):
            wrong |= (_faces(skin(places, weights)[t]) * outwards).sum(axis=1) < 0.0
        return np.asarray(wrong & (size > _LEAST))


def _faces(corners: F8) -> F8:
    """Return normals of triangles [n, 3, 3], of twice their area in length."""
    return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])


def smooth_folds(piece: Piece, bones: Skeleton) -> Piece:
    """Return the part with weights that turn no triangle inside out in any of `BENDS`, or as few as possible."""
    bends = [_Bend(bend(bones, side)) for bend in BENDS.values() for side, _ in SIDES]
    same, triangles = _welded(piece)
    first = np.unique(same, return_index=True)[1]
    piece = replace(piece, weights=strongest(piece.weights, _INFLUENCES))
    spread = near_means(piece.places[first], triangles)
    wrong = np.array([bend.inside_out(piece, piece.triangles) for bend in bends])
    best, least = piece, int(wrong.sum())
    for number in range(_ROUNDS):
        if least == 0:
            break
        pull = _about(spread, triangles[wrong.any(axis=0)], 1 + number // _PATIENCE)
        weights = piece.weights[first]
        mixed = weights + _SHARE * pull[:, None] * (spread @ weights - weights)
        piece = replace(piece, weights=strongest(mixed, _INFLUENCES)[same])
        moved = (pull > 0.0)[triangles].any(axis=1)
        wrong[:, moved] = [bend.inside_out(piece, piece.triangles[moved]) for bend in bends]
        if (count := int(wrong.sum())) < least:
            best, least = piece, count
    return best


def _about(spread: sparse.csr_array, folded: I8, rings: int) -> F8:
    """Return the amount of smoothing per vertex: 1 at folded triangles, less in some rings about them."""
    pull = np.zeros(spread.shape[0])
    pull[folded] = 1.0
    for _ in range(rings):
        pull = np.maximum(pull, np.minimum(spread @ pull * _NEAR, 1.0))
    return pull


def _welded(piece: Piece) -> tuple[I8, I8]:
    """Return the position of each vertex as an index, as vertices are doubled at seams, [n], and triangles of these."""
    _, same = np.unique(np.round(piece.places, 7), axis=0, return_inverse=True)
    return same.ravel(), same.ravel()[piece.triangles]
