"""Hair: a cap that follows the skull from the crown to the hairline, and locks over it that give it an outline."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from assets.builders.avatars.cage import reach
from assets.builders.avatars.draft import Draft
from assets.builders.avatars.face_map import directions
from assets.builders.avatars.face_shape import Head
from assets.builders.avatars.fields import F8, step
from assets.builders.avatars.locks import LAID, Lock, add_lock
from assets.builders.avatars.person import Looks
from assets.builders.avatars.piece import Piece
from assets.builders.avatars.sheet import I8
from assets.builders.avatars.skeleton import Skeleton
from assets.builders.avatars.weights import rigid
from assets.builders.avatars.wisps import make_wisps
from assets.builders.kit.rng import Rng
from assets.builders.market.sculpt import noise

__all__ = ["hairline", "make_hair", "make_hair_wisps"]

_CROWN = 1.45
"""Elevation of the whorl, from which the strands part in all directions [rad]."""
_BROW = 0.40
_ROUND = 0.75
"""Share of the head's round shape in the normals of hair, 0 to 1: the rest is that of the single locks."""
_INSIDE = 0.018
"""Distance of the cap's edge behind the painted hairline [rad]: the edge is seen on painted hair."""
_RECESS, _PEAK = 0.13, 0.025
"""How far the hairline lies back over the temples and forward in the middle of the forehead at a recess of 1 [rad]."""
_RIM, _LIGHT_RIM = 0.4, 0.85
"""Shade of the inside of the edge of dark and of light hair: between light hairs there is no dark seam."""
_OCCIPUT = 0.05
"""Elevation where the back of the head stands out farthest [rad]."""
_KNOT = (0.0, 30.0, -94.0)
"""Place of the knot of hair drawn back, as `Head.mark` [mm]."""

Course = Literal["crown", "knot", "none"]
"""Course of the strands: from the whorl outwards, from the hairline to the knot, or none (curls and cropped hair)."""


@dataclass(frozen=True)
class _Style:
    """Shape of the cap of hair, without its locks.

    Attributes:
        thick: Of the cap on top and at the sides [m].
        edge: Share of the path from the whorl to the hairline where the cap begins to thin out towards its edge.
        fall: Length of the hair below the hairline, behind and beside [m].
        sweep: Angle of the strands to one side between the whorl and their tips [rad].
        lumps: Height of random lumps [m].
        course: Of the strands on the texture.
        tile: Width of the texture on the cap where there is no course [m].
        columns: Vertices of a ring of the cap.
        recess: Of the hairline, as in `Looks`.
        shares: Of the cap's rings.
    """

    thick: tuple[float, float]
    edge: float = 0.60
    fall: float = 0.0
    sweep: float = 0.0
    lumps: float = 0.0
    course: Course = "crown"
    tile: float = 0.05
    columns: int = 30
    recess: float = 0.0
    shares: tuple[float, ...] = (0.10, 0.26, 0.44, 0.62, 0.80, 1.0)


_EVEN = (0.09, 0.19, 0.30, 0.41, 0.52, 0.63, 0.74, 0.85, 0.94, 1.0)
_STYLES = {
    "short": _Style((0.015, 0.0045), 0.70, 0.0, 0.55, 0.0015, columns=26),
    "crop": _Style((0.0060, 0.0042), 0.74, course="none", tile=0.034, columns=38, shares=_EVEN),
    "bob": _Style((0.013, 0.011), 0.60, 0.125, 0.25, 0.0008, columns=28,
                  shares=(0.10, 0.26, 0.44, 0.62, 0.80, 1.0, 1.35, 1.7, 1.9)),
    "tail": _Style((0.0095, 0.0065), 0.50, course="knot", columns=40, shares=(0.10, 0.25, 0.40, 0.55, 0.70, 0.86, 1.0)),
    "curls": _Style((0.029, 0.019), 0.48, lumps=0.0180, course="none", tile=0.062, columns=42,
                    shares=(*_EVEN[:-2], 0.93, 0.98, 1.0)),
}  # fmt: skip


def hairline(azimuth: F8, recess: float) -> F8:
    """Return the elevation of the hairline at azimuths, equal on both sides [rad].

    Args:
        azimuth: [rad].
        recess: Of the hairline over the temples, as in `Looks`.
    """
    away = np.abs(azimuth)
    knots = np.array([0.0, 0.35, 0.62, 0.84, 1.00, 1.10, 1.17, 1.24, 1.37, 1.43, 1.52, 1.70, 1.95, 2.20, 2.60, math.pi])
    heights = np.array(
        [0.76, 0.77, 0.71, 0.58, 0.46, 0.36, 0.16, 0.05, 0.05, 0.12, 0.31, 0.34, 0.10, -0.35, -0.66, -0.70]
    )
    line: F8 = np.interp(away, knots, heights)
    temple, peak = np.exp(-(((away - 0.44) / 0.20) ** 2)), np.exp(-((away / 0.13) ** 2))
    return line + recess * (_RECESS * temple - _PEAK * peak)


def make_hair(head: Head, bones: Skeleton, looks: Looks, seed: int) -> Piece:
    """Return the hair of a person in one of the styles "short", "crop", "bob", "tail" and "curls"."""
    style = looks.style
    worn = replace(_STYLES[style], recess=looks.recess)
    draft = Draft(len(bones.names))
    shades: list[F8] = []
    light = float(np.clip((np.mean(looks.hair) - 80.0) / 80.0, 0.0, 1.0))
    _cap(draft, shades, head, bones, worn, seed, _RIM + light * (_LIGHT_RIM - _RIM))
    rng = Rng(seed, "locks")
    for lock in LAID[style](rng) if style in LAID else ():
        azimuth, share, lift = lock.steps()
        line = _path(head, worn, azimuth, share, lift, brow=_BROW)
        shades += add_lock(draft, line, head.middle, lock, lambda places: _held(bones, places, head))
    if style == "tail":
        _tail(draft, shades, head, bones, rng)
    return _rounded(draft.finish("hair", np.array(shades)), head)


def make_hair_wisps(head: Head, bones: Skeleton, looks: Looks, seed: int) -> Piece:
    """Return the strips that soften the hairline and the outline of a person's hair."""
    worn = replace(_STYLES[looks.style], recess=looks.recess)

    def path(azimuth: F8, share: F8, lift: F8, up: F8) -> F8:
        return _path(head, worn, azimuth, share, lift, up)

    return make_wisps(looks.style, path, lambda at: _held(bones, at, head), head.middle, len(bones.names), seed)


def _rounded(piece: Piece, head: Head) -> Piece:
    """Return hair with normals mixed with those of a round mass: locks shaded by themselves would look like chips."""
    out = piece.places - head.middle
    out[:, 1] = np.maximum(out[:, 1], -0.02)
    out /= np.linalg.norm(out, axis=1, keepdims=True)
    facing = (piece.normals * out).sum(axis=1) > -0.75
    mixed = np.where(facing[:, None], (1.0 - _ROUND) * piece.normals + _ROUND * out, piece.normals)
    return replace(piece, normals=mixed / np.linalg.norm(mixed, axis=1, keepdims=True))


def _held(bones: Skeleton, places: F8, head: Head) -> F8:
    """Return weights: hair follows the head, and where it hangs on the shoulders the neck a little."""
    weights = np.zeros((len(places), len(bones.names)))
    low = 0.45 * step(head.middle[1] - 0.06, head.middle[1] - 0.16, places[:, 1])
    weights[:, bones.index("head")] = 1.0 - low
    weights[:, bones.index("neck")] = low
    return weights


def _skull(head: Head, turns: F8, lift: F8) -> F8:
    places = reach(head.field, head.middle, directions(turns), 0.2)
    offset = places - head.middle
    away = np.linalg.norm(offset, axis=1, keepdims=True)
    lifted: F8 = head.middle + offset * (1.0 + lift[:, None] / away)
    return lifted


def _path(
    head: Head, worn: _Style, azimuth: F8, share: F8, lift: F8, ragged: F8 | float = 0.0, brow: float = 0.0
) -> F8:
    """Return points of hair on paths from the crown (0) by the hairline (1) to the ends of long hair (2), [n, 3].

    Args:
        head: Shape of the head.
        worn: Style of the hair.
        azimuth: Of each path [rad], [n].
        share: Along each path, 0 to 2, [n].
        lift: Height over the cap [m], [n].
        ragged: Shift of the hairline downwards [rad].
        brow: Largest elevation that hair before the face hangs below the hairline, at 2 [rad].
    """
    azimuth = np.remainder(azimuth + math.pi, 2.0 * math.pi) - math.pi
    line = hairline(azimuth, worn.recess) + _INSIDE + ragged
    front = step(1.15, 0.75, np.abs(azimuth))
    elevation = _CROWN + (line - _CROWN) * np.minimum(share, 1.0) - brow * front * np.maximum(share - 1.0, 0.0)
    turns = np.stack([azimuth, elevation], axis=1)
    thick = worn.thick[0] + (worn.thick[1] - worn.thick[0]) * step(0.9, 0.1, elevation)
    rooted = -0.12 + 1.12 * step(1.0, worn.edge, share) if worn.fall == 0.0 else np.ones(len(share))
    thick = thick * np.where(worn.fall > 0.0, 1.0 - 1.08 * front * step(0.50, 1.0, share), rooted)
    places = _skull(head, turns, thick + lift)
    beyond = np.maximum(share - 1.0, 0.0)
    if worn.fall > 0.0:
        # behind, long hair hangs from where the head is widest and does not follow it in to the nape
        widest = _skull(head, np.stack([azimuth, np.maximum(elevation, _OCCIPUT)], axis=1), thick + lift) - head.middle
        own, hung = (np.hypot(*(each[:, [0, 2]]).T) for each in (places - head.middle, widest))
        grow = 1.0 + step(1.0, 1.5, np.abs(azimuth)) * np.maximum(0.985 * hung / own - 1.0, 0.0)
        places = head.middle + (places - head.middle) * np.stack([grow, np.ones(len(grow)), grow], axis=1)
        falling = step(0.80, 1.25, np.abs(azimuth))
        deep = worn.fall * falling - 0.45 * (head.middle[1] - 0.02 - places[:, 1]).clip(0.0)
        down = beyond * np.maximum(deep, 0.0)
        out = places - head.middle
        level = np.hypot(out[:, 0], out[:, 2])
        puff = 0.012 * np.sin(math.pi * np.minimum(beyond, 1.0)) - 0.008 * beyond
        least = 0.080 + 0.012 * (np.abs(azimuth) > 1.2)
        grow = falling * np.where(beyond > 0.0, np.maximum(least - level, 0.0) * step(0.0, 0.6, beyond) + puff, 0.0)
        places = places + np.stack([out[:, 0] / level * grow, -down, out[:, 2] / level * grow], axis=1)
    return places


def _lump(azimuth: F8, share: float) -> F8:
    """Return the height of the tufts of a cap at directions from the whorl, -0.5 to 0.5, [n]."""
    at = np.stack([share * np.sin(azimuth), share * np.cos(azimuth), np.full(len(azimuth), share * share)], axis=1)
    return np.asarray(0.65 * noise(at, 0.34, 61) + 0.35 * noise(at, 0.15, 62) - 0.5)


def _cap(draft: Draft, shades: list[F8], head: Head, bones: Skeleton, worn: _Style, seed: int, rim: float) -> None:
    count = worn.columns
    azimuth = -math.pi + 2.0 * math.pi * np.arange(count) / count
    rings, bump = [], Rng(seed, "cap")
    ragged = 0.045 * np.array([bump.share() - 0.5 for _ in range(count)])
    for share in worn.shares:
        rough = worn.lumps * _lump(azimuth, share)
        rough = rough * step(1.0, 0.90, np.array([share])) * step(0.0, 0.3, np.array([share]))
        places = _path(head, worn, azimuth, np.full(count, share), rough, ragged)
        rings.append(draft.add(places, _held(bones, places, head)))
        shades += [np.full(3, 0.85 + 18.0 * float(r)) for r in rough]
    laid = _texture_of(head, worn)
    for number, (one, two) in enumerate(itertools.pairwise(rings)):
        for i in range(count):
            j = (i + 1) % count
            corners = (one[i], one[j], two[j], two[i])
            where = ((i, worn.shares[number]), (i + 1, worn.shares[number]),
                     (i + 1, worn.shares[number + 1]), (i, worn.shares[number + 1]))  # fmt: skip
            draft.face(corners, laid(np.array([draft.corners[c] for c in corners]), where), flip=True)
    top = _skull(head, np.array([[0.0, 0.5 * math.pi]]), np.array([worn.thick[0]]))[0]
    if worn.course == "crown":
        draft.lid(rings[0], top, (4.0, 0.0))
    else:
        _crown(draft, rings[0], top, laid)
    shades.append(np.full(3, 0.85))
    _underside(draft, shades, head, bones, worn, rings[-1], rim)


Uvs = list[tuple[float, float]]
_Laying = Callable[[F8, tuple[tuple[int, float], ...]], Uvs]
"""Gives texture coordinates of a face: of its places [k, 3], and of each the column and the share of the path."""


def _crown(draft: Draft, ring: I8, top: F8, laid: _Laying) -> None:
    """Close the cap on top by faces that carry the texture on."""
    middle = int(draft.add(top[None], np.mean([draft.weights[i] for i in ring], axis=0)[None])[0])
    for i in range(len(ring)):
        corners = (int(ring[i]), int(ring[(i + 1) % len(ring)]), middle)
        draft.face(corners, laid(np.array([draft.corners[c] for c in corners]), ()))


def _texture_of(head: Head, worn: _Style) -> _Laying:
    """Return the function that lays the texture of hair on faces of the cap."""
    knot = head.mark(*_KNOT) - head.middle
    pole = knot / np.linalg.norm(knot)
    side = np.cross(pole, [1.0, 0.0, 0.0])
    side /= np.linalg.norm(side)
    other = np.cross(pole, side)

    def from_crown(_: F8, where: tuple[tuple[int, float], ...]) -> Uvs:
        return [(8.0 * column / worn.columns + worn.sweep * share, share) for column, share in where]

    def to_knot(places: F8, _: tuple[tuple[int, float], ...]) -> Uvs:
        out = (places - head.middle) / np.linalg.norm(places - head.middle, axis=1, keepdims=True)
        turn = np.arctan2(out @ other, out @ side)
        turn = turn[0] + np.remainder(turn - turn[0] + math.pi, 2.0 * math.pi) - math.pi
        return [(9.0 * float(t) / (2.0 * math.pi), float(a)) for t, a in zip(turn, np.arccos(out @ pole), strict=True)]

    def from_three_sides(places: F8, _: tuple[tuple[int, float], ...]) -> Uvs:
        facing = np.abs(np.cross(places[1] - places[0], places[2] - places[0]))
        axes = [axis for axis in range(3) if axis != int(np.argmax(facing))]
        return [(float(u), float(v)) for u, v in places[:, axes] / worn.tile]

    return {"crown": from_crown, "knot": to_knot, "none": from_three_sides}[worn.course]


def _underside(draft: Draft, shades: list[F8], head: Head, bones: Skeleton, worn: _Style, rim: I8, dark: float) -> None:
    """Close the cap inside the head, by vertices of its own: they would bend the normals of the rim."""
    count = worn.columns
    azimuth = -math.pi + 2.0 * math.pi * np.arange(count) / count
    under = _skull(head, np.stack([azimuth, hairline(azimuth, worn.recess) - 0.01], axis=1), np.full(count, -0.004))
    u = [8.0 * i / count for i in range(count + 1)]
    tips = np.array([draft.corners[i] for i in rim])
    ring = draft.add(tips, np.array([draft.weights[i] for i in rim]))
    shades += [np.full(3, dark)] * count
    if worn.fall:
        inner = tips + (head.middle - [0.0, 0.10, 0.0] - tips) * [0.10, 0.0, 0.10] + [0.0, 0.004, 0.0]
        deep = draft.add(inner, _held(bones, inner, head))
        draft.band(ring, deep, u, (0.6, 0.62), flip=True)
        shades += [np.full(3, 0.35)] * count
        ring = deep
    last = draft.add(under, rigid(bones, "head", count))
    draft.band(ring, last, u, (0.62, 0.7), flip=True)
    shades += [np.full(3, dark)] * count
    draft.lid(last, head.middle + [0.0, 0.02, -0.01], (4.0, 0.7), flip=True)
    shades.append(np.full(3, 0.4))


def _tail(draft: Draft, shades: list[F8], head: Head, bones: Skeleton, rng: Rng) -> None:
    """Hair gathered behind: a tube from the knot downwards, and loose strands at its end."""
    root = head.mark(*_KNOT)
    count, rows = 10, 9
    turn = 2.0 * math.pi * np.arange(count) / count
    rings = []
    for number in range(rows):
        t = number / (rows - 1)
        middle = root + _hang(t)
        along = _hang(t + 0.02) - _hang(t - 0.02)
        along /= np.linalg.norm(along)
        back = np.cross([1.0, 0.0, 0.0], along)
        wide = float(np.interp(t, [0.0, 0.07, 0.14, 0.42, 0.75, 1.0], [0.016, 0.0165, 0.013, 0.024, 0.019, 0.007]))
        flat = np.cos(turn)[:, None] * [1.0, 0.0, 0.0] + 0.72 * np.sin(turn)[:, None] * back
        places = middle + wide * flat
        rings.append(draft.add(places, _held(bones, places, head)))
        shades += [np.full(3, 0.45 if 0 < number < 2 else 0.92)] * count
    u = [2.0 * i / count for i in range(count + 1)]
    for number, (one, two) in enumerate(itertools.pairwise(rings)):
        draft.band(one, two, u, (0.25 * number, 0.25 * number + 0.25), flip=True)
    draft.lid(rings[0], root, (0.0, 0.0))
    draft.lid(rings[-1], root + _hang(1.06), (1.0, 2.2), flip=True)
    shades += [np.full(3, 0.6), np.full(3, 0.9)]
    for number in range(5):
        angle = 2.0 * math.pi * number / 5.0
        spread = np.array([0.016 * math.cos(angle), 0.0, 0.012 * math.sin(angle)])
        along = np.linspace(0.0, 1.0, 4)
        line = root + np.array([_hang(0.62 + (0.42 + 0.10 * rng.share()) * t) for t in along])
        line = line + spread * (1.0 - 0.55 * along[:, None])
        strand = Lock((0.0, 0.0), (0.0, 0.0), (0.0, 0.0, 0.0), 0.017, 0.85 + 0.2 * rng.share(), 3)
        shades += add_lock(draft, line, root + _hang(0.7), strand, lambda places: _held(bones, places, head))


def _hang(t: float) -> F8:
    """Middle of a tail from its knot, at a share of its length [m]."""
    high = 0.012 * math.sin(math.pi * min(t, 1.0) * 1.4) - 0.205 * t * abs(t) ** 0.25
    return np.array([0.0, high, -0.040 * math.sin(2.2 * t)])
