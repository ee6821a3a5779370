"""Hair: a cap that follows the skull from the crown to the hairline, and locks over it that give it an outline."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, replace

import numpy as np

from mimics_app.builders.avatars.cage import reach
from mimics_app.builders.avatars.draft import Draft
from mimics_app.builders.avatars.face_map import directions
from mimics_app.builders.avatars.face_shape import Head
from mimics_app.builders.avatars.fields import F8, step
from mimics_app.builders.avatars.locks import LAID, Lock, add_lock
from mimics_app.builders.avatars.piece import Piece
from mimics_app.builders.avatars.sheet import I8
from mimics_app.builders.avatars.skeleton import Skeleton
from mimics_app.builders.avatars.weights import rigid
from mimics_app.builders.kit.chance import Chance

__all__ = ["hairline", "make_hair"]

_CROWN = 1.45
"""Elevation where the hair begins to part all ways [rad]."""
_BROW = 0.40
_PUFFS = 114
"""Heaps of curls there would be all round a ball."""
_PUFF = (0.015, 0.028)
"""Their radii [m]."""
_ROUND = 0.6
"""How much hair is shaded as the round mass that it is, and not by its single locks, 0 to 1."""
_INSIDE = 0.018
"""How far behind the painted hairline that of the cap lies [rad]: its edge is seen on painted hair."""


@dataclass(frozen=True)
class _Style:
    """How hair is worn, but for its locks.

    Attributes:
        thick: Of the cap on top and at the sides [m].
        fall: How far the hair hangs below the hairline behind and beside [m].
        sweep: Turn of the strands from the crown to their tips: to one side [rad].
        wild: How irregular, 0 to 1.
        fine: How much shorter and closer the strands are than on the picture.
        columns: Corners round the cap.
        shares: Of its rings.
    """

    thick: tuple[float, float]
    fall: float
    sweep: float
    wild: float
    fine: float = 1.0
    columns: int = 30
    shares: tuple[float, ...] = (0.08, 0.20, 0.34, 0.48, 0.62, 0.75, 0.88, 1.0)


_FEW = (0.10, 0.26, 0.44, 0.62, 0.80, 1.0)
_STYLES = {
    "short": _Style((0.012, 0.0045), 0.0, 0.55, 0.8, columns=22, shares=_FEW),
    "crop": _Style((0.0045, 0.0035), 0.0, 0.0, 0.3, 3.0),
    "bob": _Style((0.013, 0.011), 0.125, 0.25, 0.5, columns=24, shares=(*_FEW, 1.35, 1.7, 1.9)),
    "tail": _Style((0.010, 0.007), 0.0, 0.15, 0.3, columns=26, shares=_FEW),
    "curls": _Style((0.014, 0.008), 0.0, 0.1, 0.4, 3.0, columns=20, shares=_FEW),
}


def hairline(azimuth: F8) -> F8:
    """Elevation of the hairline at azimuths, either side [rad]."""
    knots = np.array([0.0, 0.35, 0.62, 0.86, 1.10, 1.24, 1.38, 1.50, 1.70, 1.95, 2.20, 2.60, math.pi])
    heights = np.array([0.76, 0.76, 0.71, 0.55, 0.38, 0.06, 0.06, 0.30, 0.34, 0.10, -0.35, -0.66, -0.72])
    line: F8 = np.interp(np.abs(azimuth), knots, heights)
    return line


def make_hair(head: Head, bones: Skeleton, style: str, seed: int) -> Piece:
    """The hair of a person in one of the styles "short", "crop", "bob", "tail" and "curls"."""
    worn = _STYLES[style]
    draft = Draft(len(bones.names))
    shades: list[F8] = []
    _cap(draft, shades, head, bones, worn, seed)
    chance = Chance(seed, "locks")
    for lock in LAID[style](chance) if style in LAID else ():
        azimuth, share, lift = lock.steps()
        line = _path(head, worn, azimuth, share, lift, brow=_BROW)
        shades += add_lock(draft, line, head.middle, lock, lambda places: _held(bones, places, head))
    if style == "tail":
        _tail(draft, shades, head, bones, chance)
    if style == "curls":
        _curls(draft, shades, head, bones, worn, chance)
        return draft.finish("hair", np.array(shades))
    return _rounded(draft.finish("hair", np.array(shades)), head)


def _rounded(piece: Piece, head: Head) -> Piece:
    """The same shaded as a round mass: blades that each shone by themselves would look like chips."""
    out = piece.places - head.middle
    out[:, 1] = np.maximum(out[:, 1], -0.02)
    out /= np.linalg.norm(out, axis=1, keepdims=True)
    facing = (piece.normals * out).sum(axis=1) > -0.3
    mixed = np.where(facing[:, None], (1.0 - _ROUND) * piece.normals + _ROUND * out, piece.normals)
    return replace(piece, normals=mixed / np.linalg.norm(mixed, axis=1, keepdims=True))


def _held(bones: Skeleton, places: F8, head: Head) -> F8:
    """The head carries hair; what hangs on the shoulders follows the neck a little."""
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
    """Places of hair at azimuths from the crown (0) by the hairline (1) to where it falls (2), [n, 3].

    Args:
        head: Under it.
        worn: How.
        azimuth: Of each [rad], [n]; below, share of the way, and height over the cap [m].
        share: [n].
        lift: [n].
        ragged: How much lower the hairline is [rad].
        brow: How far before the face it may hang below the hairline, at 2 [rad].
    """
    azimuth = np.remainder(azimuth + math.pi, 2.0 * math.pi) - math.pi
    line = hairline(azimuth) + _INSIDE + ragged
    front = step(1.15, 0.75, np.abs(azimuth))
    elevation = _CROWN + (line - _CROWN) * np.minimum(share, 1.0) - brow * front * np.maximum(share - 1.0, 0.0)
    turns = np.stack([azimuth, elevation], axis=1)
    thick = worn.thick[0] + (worn.thick[1] - worn.thick[0]) * step(0.9, 0.1, elevation)
    rooted = -0.12 + 1.12 * step(1.0, 0.60, share) if worn.fall == 0.0 else np.ones(len(share))
    thick = thick * np.where(worn.fall > 0.0, 1.0 - 1.08 * front * step(0.50, 1.0, share), rooted)
    places = _skull(head, turns, thick + lift)
    beyond = np.maximum(share - 1.0, 0.0)
    if worn.fall > 0.0:
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


def _cap(draft: Draft, shades: list[F8], head: Head, bones: Skeleton, worn: _Style, seed: int) -> None:
    count = worn.columns
    azimuth = -math.pi + 2.0 * math.pi * np.arange(count) / count
    rings, bump = [], Chance(seed, "cap")
    clumps, ragged = (np.array([bump.share() - 0.5 for _ in range(count)]) for _ in range(2))
    ragged = 0.045 * ragged
    for share in worn.shares:
        rough = np.array([bump.share() - 0.5 for _ in range(count)])
        rough = (0.0022 * rough + 0.0034 * clumps) * worn.wild
        rough = rough * (share < 0.95) * step(0.0, 0.3, np.array([share]))
        places = _path(head, worn, azimuth, np.full(count, share), rough, ragged)
        rings.append(draft.add(places, _held(bones, places, head)))
        shades += [np.full(3, 0.80 + 6.0 * float(r)) for r in rough]
    for number, (one, two) in enumerate(itertools.pairwise(rings)):
        _swept_band(draft, one, two, (worn.shares[number], worn.shares[number + 1]), worn)
    first = np.array([draft.corners[i] for i in rings[0]])
    draft.lid(rings[0], first.mean(axis=0) + [0.0, 0.006, 0.0], (4.0, 0.0))
    shades.append(np.full(3, 0.8))
    _underside(draft, shades, head, bones, worn, rings[-1])


def _underside(draft: Draft, shades: list[F8], head: Head, bones: Skeleton, worn: _Style, rim: I8) -> None:
    """Close the cap within the head, by corners of its own, or the rim would be shaded as if it hung over."""
    count = worn.columns
    azimuth = -math.pi + 2.0 * math.pi * np.arange(count) / count
    under = _skull(head, np.stack([azimuth, hairline(azimuth) - 0.01], axis=1), np.full(count, -0.004))
    u = [8.0 * i / count for i in range(count + 1)]
    tips = np.array([draft.corners[i] for i in rim])
    ring = draft.add(tips, np.array([draft.weights[i] for i in rim]))
    shades += [np.full(3, 0.4)] * count
    if worn.fall:
        inner = tips + (head.middle - [0.0, 0.10, 0.0] - tips) * [0.10, 0.0, 0.10] + [0.0, 0.004, 0.0]
        deep = draft.add(inner, _held(bones, inner, head))
        draft.band(ring, deep, u, (0.6, 0.62), flip=True)
        shades += [np.full(3, 0.35)] * count
        ring = deep
    last = draft.add(under, rigid(bones, "head", count))
    draft.band(ring, last, u, (0.62, 0.7), flip=True)
    shades += [np.full(3, 0.4)] * count
    draft.lid(last, head.middle + [0.0, 0.02, -0.01], (4.0, 0.7), flip=True)
    shades.append(np.full(3, 0.4))


def _swept_band(draft: Draft, one: I8, two: I8, share: tuple[float, float], worn: _Style) -> None:
    """Faces between two rings of the cap; strands go aside on their way from the crown."""
    count = worn.columns
    tiles, tall = 8.0 * worn.fine / count, 1.0 if worn.fine == 1.0 else 2.5 * worn.fine
    for i in range(count):
        j = (i + 1) % count
        ends = ((i, share[0]), (i + 1, share[0]), (i + 1, share[1]), (i, share[1]))
        uvs = [(k * tiles + worn.sweep * along, tall * along) for k, along in ends]
        draft.face((one[i], one[j], two[j], two[i]), uvs, flip=True)


def _tail(draft: Draft, shades: list[F8], head: Head, bones: Skeleton, chance: Chance) -> None:
    """Hair gathered behind: a knot and strands that hang from it."""
    root = head.mark(0.0, 30.0, -104.0)
    for number in range(9):
        turn = 2.0 * math.pi * number / 9.0
        spread = np.array([math.cos(turn), 0.35 * math.sin(turn), 0.7 * math.sin(turn)])
        drop = 0.15 + 0.05 * chance.share()
        along = np.linspace(0.0, 1.0, 6)[:, None]
        line = (
            root
            + spread * (0.007 + 0.016 * np.sin(math.pi * along * 0.9))
            + along**1.3 * np.array([0.0, -drop, -0.004])
        )
        line = line + np.sin(math.pi * along) * np.array([0.0, 0.0, -0.030])
        strand = Lock((0.0, 0.0), (0.0, 0.0), (0.0, 0.0, 0.0), 0.030, 0.8 + 0.3 * chance.share(), 5)
        shades += add_lock(draft, line, head.middle, strand, lambda places: _held(bones, places, head))


def _curls(draft: Draft, shades: list[F8], head: Head, bones: Skeleton, worn: _Style, chance: Chance) -> None:
    """Heaps of curls all over the cap, evenly spread over the head and none the size of another."""
    for number in range(_PUFFS):
        around = np.remainder(2.39996 * number + 0.35 * chance.share(), 2.0 * math.pi) - math.pi
        high = math.asin(1.0 - 2.0 * (number + 0.5) / _PUFFS)
        line = float(hairline(np.array([around]))[0])
        if high < line + 0.03:
            continue
        share = np.array([max(_CROWN - high, 0.0) / (_CROWN - line)])
        foot = _path(head, worn, np.array([around]), share, np.array([-0.002]))[0]
        wide = (_PUFF[0] + (_PUFF[1] - _PUFF[0]) * chance.share()) * (1.0 - 0.35 * float(step(0.75, 1.0, share)[0]))
        up = (foot - head.middle) / np.linalg.norm(foot - head.middle)
        _heap(draft, shades, bones, foot, up, wide, chance, number)


def _heap(
    draft: Draft, shades: list[F8], bones: Skeleton, foot: F8, up: F8, wide: float, chance: Chance, twist: float
) -> None:
    """A dome of five sides and a radius [m] that stands on a place, dark at its foot."""
    turn = 2.0 * math.pi * np.arange(5) / 5
    side = np.cross(up, [0.0, 0.0, 1.0]) if abs(up[2]) < 0.9 else np.cross(up, [0.0, 1.0, 0.0])
    side /= np.linalg.norm(side)
    ahead = np.cross(side, up)
    rings = []
    for radius, high, more, tone in ((1.0, -0.25, 0.0, 0.38), (0.82, 0.45, 0.63, 0.85)):
        bend = turn + more + twist
        loose = np.array([0.85 + 0.3 * chance.share() for _ in range(5)])[:, None]
        flat = np.cos(bend)[:, None] * side + np.sin(bend)[:, None] * ahead
        rings.append(draft.add(foot + wide * (loose * radius * flat + high * up), rigid(bones, "head", 5)))
        shades += [np.full(3, tone)] * 5
    draft.band(rings[0], rings[1], [0.5 * i for i in range(6)], (0.0, 0.7), flip=True)
    draft.lid(rings[1], foot + 0.80 * wide * up, (1.2, 1.2), flip=True)
    draft.lid(rings[0], foot - 0.30 * wide * up, (0.0, 0.0))
    shades += [np.full(3, 1.05), np.full(3, 0.3)]
