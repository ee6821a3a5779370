"""Garments cut from the cage: each its own closed surface over the body, hanging where the body recedes."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from assets.builders.avatars.cage import AROUND, LIMB_AROUND, Cage
from assets.builders.avatars.draft import Draft
from assets.builders.avatars.fields import F8, step
from assets.builders.avatars.flesh import Flesh
from assets.builders.avatars.piece import Piece
from assets.builders.avatars.sheet import I8, corner_normals, triangles_of

__all__ = ["TILE", "Tailor"]

TILE = 0.30
"""Width of the texture of cloth [m]."""
_FOLD = 2.0 * math.pi
_COLLAR = 0.32
"""Height of a collar, as a share of the neck's height."""
_APART = 0.003
"""Distance of trouser legs from the plane of symmetry [m]: crossed, they would fold when one is lifted."""
_TURNED = 0.006
"""Largest depth of the turned edge of a hem [m]."""


@dataclass(frozen=True)
class Tailor:
    """Cuts garments for one body.

    Attributes:
        cage: The skin's rings.
        flesh: Fields of the body.
        weights: Of the cage's vertices, [n, joints].
        normals: Of them, [n, 3].
    """

    cage: Cage
    flesh: Flesh
    weights: F8
    normals: F8

    @classmethod
    def of(cls, cage: Cage, flesh: Flesh, weights: F8) -> Tailor:
        """Return a tailor for a cage."""
        return cls(cage, flesh, weights, corner_normals(cage.places, triangles_of(cage.faces, cage.places)))

    def trunk_rings(self, rows: range, ease: Callable[[F8], F8], hang: float) -> dict[int, F8]:
        """Return rings around the trunk by row, from below, [32, 3]: off the skin, and hanging from wider rows above.

        Args:
            rows: Of the cage's trunk; inside armholes the points have no meaning.
            ease: Distance of the cloth from the skin [m] at rows (float).
            hang: Smallest radius of a ring, as a share of that of the one above; 0 clings to the body.
        """
        rings: dict[int, F8] = {}
        for row in rows:
            corners = self.cage.trunk[row]
            lift = ease(np.array([float(row)]))[0]
            rings[row] = self.cage.places[corners] + lift * self.normals[corners]
        for row in reversed(rows[:-1]):
            above = min(row + 1, 11)
            if row >= 11 or above not in rings:
                continue
            middle = rings[row].mean(axis=0)
            own, other = rings[row] - middle, rings[above] - rings[above].mean(axis=0)
            size, least = np.hypot(own[:, 0], own[:, 2]), hang * np.hypot(other[:, 0], other[:, 2])
            grow = np.maximum(size, least) / size
            rings[row] = middle + own * np.stack([grow, np.ones(AROUND), grow], axis=1)
        return rings

    def limb_rings(
        self, limb: str, side: int, rows: range, ease: Callable[[F8], F8], least: float = 0.0, drape: float = 0.0
    ) -> list[F8]:
        """Return rings around an arm or a leg by row, [20, 3].

        Args:
            limb: "arms" or "legs".
            side: 1: left, -1: right.
            rows: Of the cage's limb.
            ease: As for the trunk.
            least: Smallest radius of the cloth [m].
            drape: Height of the folds [m].
        """
        table = getattr(self.cage, limb)[side]
        turn = 2.0 * math.pi * np.arange(LIMB_AROUND) / LIMB_AROUND
        rings = []
        for row in rows:
            corners = table[row]
            places = self.cage.places[corners] + ease(np.array([float(row)]))[0] * self.normals[corners]
            middle = places.mean(axis=0)
            away = np.linalg.norm(places - middle, axis=1)
            wider = np.maximum(least / away, 1.0) if row > 1 else np.ones(LIMB_AROUND)
            wave = np.sin(3.0 * turn + 2.3 * row) + 0.6 * np.sin(5.0 * turn - 1.7 * row + side)
            wider = wider + (drape * wave / away if row > 2 else 0.0)
            rings.append(middle + (places - middle) * wider[:, None])
        return rings

    def top(
        self, material: str, *, hem: int, neck: int, sleeve: int, ease: float, hang: float, loose: float, drape: float
    ) -> Piece:
        """Return a shirt.

        Args:
            material: Name of the material.
            hem: Row of the trunk where it ends below.
            neck: Row where it ends above.
            sleeve: Row of the arm where the sleeves end.
            ease: Off the skin at the chest [m].
            hang: As for `trunk_rings`.
            loose: Off the skin at the ends of the sleeves [m].
            drape: Height of the folds [m].
        """
        cage, rows = self.cage, range(hem, neck + 1)
        draft = Draft(self.weights.shape[1])
        taper = lambda row: ease * (1.0 - 0.45 * step(15.0, 18.0, row)) + 0.004 * step(8.0, 3.0, row)  # noqa: E731
        rings = self.trunk_rings(rows, taper, hang)
        places = self.cage.places + ease * self.normals
        for row, ring in rings.items():
            held = cage.trunk[row] >= 0
            places[cage.trunk[row][held]] = _folded(
                ring, drape * float(step(12.0, 6.0, np.array([float(row)]))[0]), row
            )[held]
        for side in (1, -1):
            give = lambda row: ease + (loose - ease) * step(1.0, float(sleeve), row)  # noqa: E731
            for row, ring in zip(
                range(1, sleeve + 1), self.limb_rings("arms", side, range(1, sleeve + 1), give, 0.0, drape), strict=True
            ):
                places[cage.arms[side][row]] = ring
        own = _used(draft, self, places, _trunk_corners(cage, rows) + [cage.arms[s][1 : sleeve + 1] for s in (1, -1)])
        self._trunk_bands(draft, own, rows, places)
        for side in (1, -1):
            self._limb_bands(draft, own, cage.arms[side], range(0, sleeve + 1), places, flip=side < 0)
            rim = cage.arms[side][sleeve]
            inner, middle = _inwards(places[rim], cage.places[rim], self.cage.places[cage.arms[side][sleeve - 1]])
            draft.hem(own[rim], inner, middle, flip=side > 0)
        low = cage.trunk[hem]
        inner, middle = _inwards(places[low], cage.places[low], places[cage.trunk[hem + 1]])
        draft.hem(own[low], inner, middle)
        self._collar(draft, own, neck, places)
        return draft.finish(material, dim=self.flesh.whole, lift=ease)

    def _collar(self, draft: Draft, own: I8, neck: int, places: F8) -> None:
        """End a shirt at a row; at the root of the neck by an upright band with the weights of the skin."""
        cage, high = self.cage, self.cage.trunk[neck]
        rim, ring, skin = own[high], places[high], cage.places[high]
        if neck == len(cage.trunk) - 2:
            above = cage.trunk[neck + 1]
            up = _COLLAR * (cage.places[above] - skin)
            ring, skin = ring + up, skin + up
            band = draft.add(ring, (1.0 - _COLLAR) * self.weights[high] + _COLLAR * self.weights[above])
            tall = float(up[:, 1].mean()) / TILE
            draft.band(rim, band, [4.0 * i / AROUND for i in range(AROUND + 1)], (0.0, tall))
            rim = band
        inner, middle = _inwards(ring, skin, skin - [0.0, 0.012, 0.0])
        draft.hem(rim, inner, middle, flip=True)

    def bottom(self, material: str, *, waist: int, end: int, ease: float, least: float, drape: float) -> Piece:
        """Return trousers from a row of the trunk to a row of the legs, whose smallest radius is `least` [m]."""
        cage, rows = self.cage, range(0, waist + 1)
        draft = Draft(self.weights.shape[1])
        rings = self.trunk_rings(rows, lambda row: ease * (1.0 - 0.4 * step(3.0, float(waist), row)), 0.0)
        places = cage.places + ease * self.normals
        for row, ring in rings.items():
            places[cage.trunk[row]] = ring
        for side in (1, -1):
            give = lambda row: ease + 0.004 * step(2.0, float(end), row)  # noqa: E731
            wide = range(1, end + 1)
            rings_ = self.limb_rings("legs", side, wide, give, least, drape)
            for row, ring in zip(wide, rings_, strict=True):
                ring[:, 0] = side * np.maximum(side * ring[:, 0], _APART)
                places[cage.legs[side][row]] = ring
        crotch = cage.legs[1][0][AROUND // 2 + 1 :]
        lists = [cage.trunk[row] for row in rows] + [crotch] + [cage.legs[s][1 : end + 1] for s in (1, -1)]
        own = _used(draft, self, places, lists)
        self._trunk_bands(draft, own, rows, places)
        for side in (1, -1):
            self._limb_bands(draft, own, cage.legs[side], range(0, end + 1), places, flip=side > 0)
            rim = cage.legs[side][end]
            inner, middle = _inwards(places[rim], cage.places[rim], places[cage.legs[side][end - 1]])
            draft.hem(own[rim], inner, middle, flip=side < 0)
        high = cage.trunk[waist]
        inner, middle = _inwards(places[high], cage.places[high], places[cage.trunk[waist - 1]])
        draft.hem(own[high], inner, middle, flip=True)
        return draft.finish(material, dim=self.flesh.whole, lift=ease)

    def sleeve(
        self,
        material: str,
        limb: str,
        side: int,
        rows: range,
        ease: float,
        uv: Callable[[int, int], tuple[float, float]] | None = None,
    ) -> Piece:
        """Return a closed section of an arm or leg: bare skin (ease 0) or a sock."""
        table = getattr(self.cage, limb)[side]
        flip = (side < 0) == (limb == "arms")
        draft = Draft(self.weights.shape[1])
        places = self.cage.places + ease * self.normals
        own = _used(draft, self, places, [table[list(rows)]])
        if uv is None:
            self._limb_bands(draft, own, table, rows, places, flip=flip)
        else:
            for row in rows[:-1]:
                for k in range(LIMB_AROUND):
                    j = (k + 1) % LIMB_AROUND
                    ends = ((row, k), (row, k + 1), (row + 1, k + 1), (row + 1, k))
                    corners = (table[row][k], table[row][j], table[row + 1][j], table[row + 1][k])
                    draft.face([own[c] for c in corners], [uv(*end) for end in ends], flip=flip)
        for row, other in ((rows[0], False), (rows[-1], True)):
            draft.lid(own[table[row]], places[table[row]].mean(axis=0), (0.02, 0.98), flip=flip == other)
        return draft.finish(material, dim=self.flesh.whole, lift=ease)

    def _trunk_bands(self, draft: Draft, own: I8, rows: range, places: F8) -> None:
        trunk, known = self.cage.trunk, set(self.cage.faces)
        heights = {row: -float(places[trunk[row][AROUND // 2], 1]) / TILE for row in rows}
        for row in rows[:-1]:
            for column in range(AROUND):
                corners = [trunk[row, column], trunk[row, (column + 1) % AROUND]]
                corners += [trunk[row + 1, (column + 1) % AROUND], trunk[row + 1, column]]
                face = tuple(int(c) for c in corners)
                if min(face) < 0 or face not in known:
                    continue
                u = (column + AROUND // 2) % AROUND * 4.0 / AROUND
                low, high = heights[row], heights[row + 1]
                draft.face(
                    [own[c] for c in face], ((u, low), (u + 4.0 / AROUND, low), (u + 4.0 / AROUND, high), (u, high))
                )

    def _limb_bands(self, draft: Draft, own: I8, table: I8, rows: range, places: F8, *, flip: bool) -> None:
        v = 0.0
        u = [2.0 * k / LIMB_AROUND for k in range(LIMB_AROUND + 1)]
        for row in rows[:-1]:
            gap = float(np.linalg.norm(places[table[row + 1]].mean(axis=0) - places[table[row]].mean(axis=0))) / TILE
            draft.band(own[table[row]], own[table[row + 1]], u, (v, v + gap), flip=flip)
            v += gap


def _trunk_corners(cage: Cage, rows: range) -> list[I8]:
    return [cage.trunk[row][cage.trunk[row] >= 0] for row in rows]


def _used(draft: Draft, tailor: Tailor, places: F8, lists: list[I8]) -> I8:
    """Add the vertices of some rings of the cage to a draft; return the draft's indices by the cage's."""
    wanted = np.unique(np.concatenate([np.ravel(each) for each in lists]))
    own = np.full(len(places), -1, np.int64)
    own[wanted] = draft.add(places[wanted], tailor.weights[wanted])
    return own


def _inwards(rim: F8, skin: F8, before: F8) -> tuple[F8, F8]:
    """Return the ends of a hem's turned edge, a little inside the skin, and their centre."""
    middle = skin.mean(axis=0)
    towards = middle - skin
    far = np.linalg.norm(towards, axis=1, keepdims=True)
    inner = skin + towards / far * np.minimum(_TURNED, 0.3 * far)
    back = (before.mean(axis=0) - rim.mean(axis=0)) * 0.5
    return inner + back, middle + back


def _folded(ring: F8, height: float, row: int) -> F8:
    """Return a ring with soft folds."""
    if height <= 0.0:
        return ring
    turn = _FOLD * np.arange(len(ring)) / len(ring)
    wave = np.sin(6.0 * turn + 0.55 * row) + 0.7 * np.sin(11.0 * turn - 0.35 * row)
    middle = ring.mean(axis=0)
    away = ring - middle
    size = np.hypot(away[:, 0], away[:, 2])[:, None]
    result: F8 = ring + away * np.array([1.0, 0.0, 1.0]) / size * (height * wave)[:, None]
    return result
