"""Hair: a cap that follows the skull from the crown to the hairline, and locks of their own over it."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np

from mimics_app.builders.avatars.cage import reach
from mimics_app.builders.avatars.draft import Draft
from mimics_app.builders.avatars.face_map import directions
from mimics_app.builders.avatars.face_shape import Head
from mimics_app.builders.avatars.fields import F8, step
from mimics_app.builders.avatars.piece import Piece
from mimics_app.builders.avatars.sheet import I8
from mimics_app.builders.avatars.skeleton import Skeleton
from mimics_app.builders.kit.chance import Chance

__all__ = ["hairline", "make_hair"]

_COLUMNS = 30
_CROWN = 1.45
"""Elevation where the hair begins to part all ways [rad]."""
_INSIDE = 0.018
"""How far behind the painted hairline that of the cap lies [rad]: its edge is seen on painted hair."""


@dataclass(frozen=True)
class _Style:
    """How hair is worn.

    Attributes:
        thick: Of the cap on top and at the sides [m].
        fall: How far the hair hangs below the hairline behind and beside [m].
        locks: How many.
        lock: Length, breadth [m].
        sweep: Turn of the locks from the crown to their tips: to one side [rad].
        wild: How irregular, 0 to 1.
        fine: How much shorter and closer the locks are than on the picture.
    """

    thick: tuple[float, float]
    fall: float
    locks: int
    lock: tuple[float, float]
    sweep: float
    wild: float
    fine: float = 1.0


_STYLES = {
    "short": _Style((0.019, 0.0055), 0.0, 13, (0.060, 0.020), 0.55, 0.8),
    "crop": _Style((0.0045, 0.0035), 0.0, 0, (0.02, 0.01), 0.0, 0.3, 3.0),
    "bob": _Style((0.016, 0.013), 0.125, 10, (0.17, 0.026), 0.25, 0.5),
    "tail": _Style((0.010, 0.007), 0.0, 8, (0.12, 0.018), 0.15, 0.3),
}


def hairline(azimuth: F8) -> F8:
    """Elevation of the hairline at azimuths, either side [rad]."""
    knots = np.array([0.0, 0.35, 0.62, 0.86, 1.10, 1.24, 1.38, 1.50, 1.70, 1.95, 2.20, 2.60, math.pi])
    heights = np.array([0.76, 0.76, 0.71, 0.55, 0.38, 0.06, 0.06, 0.30, 0.34, 0.10, -0.35, -0.66, -0.72])
    line: F8 = np.interp(np.abs(azimuth), knots, heights)
    return line


def make_hair(head: Head, bones: Skeleton, style: str, seed: int) -> Piece:
    """The hair of a person in one of the styles "short", "crop", "bob" and "tail"."""
    worn = _STYLES[style]
    draft = Draft(len(bones.names))
    shades: list[F8] = []
    _cap(draft, shades, head, bones, worn, seed)
    chance = Chance(seed, "locks")
    for number in range(worn.locks):
        _lock(draft, shades, head, bones, worn, style, chance, number)
    if style == "tail":
        _tail(draft, shades, head, bones, chance)
    return draft.finish("hair", np.array(shades))


def _held(bones: Skeleton, places: F8, head: Head, hang: F8) -> F8:
    """The head carries hair; what hangs on the shoulders follows the neck a little."""
    weights = np.zeros((len(places), len(bones.names)))
    low = 0.45 * hang * step(head.middle[1] - 0.06, head.middle[1] - 0.16, places[:, 1])
    weights[:, bones.index("head")] = 1.0 - low
    weights[:, bones.index("neck")] = low
    return weights


def _skull(head: Head, turns: F8, lift: F8) -> F8:
    places = reach(head.field, head.middle, directions(turns), 0.2)
    offset = places - head.middle
    away = np.linalg.norm(offset, axis=1, keepdims=True)
    lifted: F8 = head.middle + offset * (1.0 + lift[:, None] / away)
    return lifted


def _path(head: Head, worn: _Style, azimuth: F8, share: F8, lift: F8, ragged: F8 | float = 0.0) -> F8:
    """Places of hair at azimuths from the crown (0) by the hairline (1) to where it falls (2), [n, 3]."""
    line = hairline(azimuth) + _INSIDE + ragged
    elevation = _CROWN + (line - _CROWN) * np.minimum(share, 1.0)
    turns = np.stack([azimuth, elevation], axis=1)
    thick = worn.thick[0] + (worn.thick[1] - worn.thick[0]) * step(0.9, 0.1, elevation)
    rooted = -0.12 + 1.12 * step(1.0, 0.60, share) if worn.fall == 0.0 else np.ones(len(share))
    front = step(1.15, 0.75, np.abs(azimuth))
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
    azimuth = -math.pi + 2.0 * math.pi * np.arange(_COLUMNS) / _COLUMNS
    shares = [0.08, 0.20, 0.34, 0.48, 0.62, 0.75, 0.88, 1.0]
    if worn.fall:
        shares += [1.35, 1.7, 2.0]
    rings, bump = [], Chance(seed, "cap")
    clumps, ragged = (np.array([bump.share() - 0.5 for _ in range(_COLUMNS)]) for _ in range(2))
    ragged = 0.045 * ragged
    for share in shares:
        rough = np.array([bump.share() - 0.5 for _ in range(_COLUMNS)])
        rough = (0.0022 * rough + 0.0034 * clumps) * worn.wild * (share < 0.95) * step(0.0, 0.3, np.array([share]))
        places = _path(head, worn, azimuth, np.full(_COLUMNS, share), rough, ragged)
        rings.append(draft.add(places, _held(bones, places, head, np.ones(_COLUMNS))))
        shades += [np.full(3, 0.80 + 6.0 * float(r)) for r in rough]
    u = [8.0 * i / _COLUMNS for i in range(_COLUMNS + 1)]
    for number, (one, two) in enumerate(itertools.pairwise(rings)):
        _swept_band(draft, one, two, (shares[number], shares[number + 1]), worn)
    first = np.array([draft.corners[i] for i in rings[0]])
    draft.lid(rings[0], first.mean(axis=0) + [0.0, 0.006, 0.0], (4.0, 0.0))
    shades.append(np.full(3, 0.8))
    under = _skull(head, np.stack([azimuth, hairline(azimuth) - 0.01], axis=1), np.full(_COLUMNS, -0.004))
    # the underside begins with corners of its own, or the rim would be shaded as if it hung over
    rim = np.array([draft.corners[i] for i in rings[-1]])
    rings.append(draft.add(rim, np.array([draft.weights[i] for i in rings[-1]])))
    shades += [np.full(3, 0.4)] * _COLUMNS
    if worn.fall:
        tips = np.array([draft.corners[i] for i in rings[-1]])
        inner = tips + (head.middle - [0.0, 0.10, 0.0] - tips) * [0.10, 0.0, 0.10] + [0.0, 0.004, 0.0]
        ring = draft.add(inner, _held(bones, inner, head, np.ones(_COLUMNS)))
        draft.band(rings[-1], ring, u, (0.6, 0.62), flip=True)
        shades += [np.full(3, 0.35)] * _COLUMNS
        rings.append(ring)
    ring = draft.add(under, _held(bones, under, head, np.zeros(_COLUMNS)))
    draft.band(rings[-1], ring, u, (0.62, 0.7), flip=True)
    shades += [np.full(3, 0.4)] * _COLUMNS
    draft.lid(ring, head.middle + [0.0, 0.02, -0.01], (4.0, 0.7), flip=True)
    shades.append(np.full(3, 0.4))


def _swept_band(draft: Draft, one: I8, two: I8, share: tuple[float, float], worn: _Style) -> None:
    """Faces between two rings of the cap; strands go aside on their way from the crown."""
    tiles, tall = 8.0 * worn.fine / _COLUMNS, 1.0 if worn.fine == 1.0 else 2.5 * worn.fine
    for i in range(_COLUMNS):
        j = (i + 1) % _COLUMNS
        ends = ((i, share[0]), (i + 1, share[0]), (i + 1, share[1]), (i, share[1]))
        uvs = [(k * tiles + worn.sweep * along, tall * along) for k, along in ends]
        draft.face((one[i], one[j], two[j], two[i]), uvs, flip=True)


def _lock(
    draft: Draft, shades: list[F8], head: Head, bones: Skeleton, worn: _Style, style: str, chance: Chance, number: int
) -> None:
    """One lock: a flat spindle from a root near the crown along the cap, its tip free."""
    spot = number * 0.61803 % 1.0
    around = (
        2.0 * math.pi * spot - math.pi
        if not worn.fall
        else math.copysign(0.95 + 2.0 * abs(2.0 * spot - 1.0), spot - 0.5)
    )
    azimuth0 = around + 0.2 * (chance.share() - 0.5)
    falls = worn.fall > 0.0 and abs(azimuth0) > 0.8
    begin = 0.30 + 0.45 * chance.share() if worn.fall == 0.0 else 0.35 + 0.35 * chance.share()
    if style == "tail":
        begin = 0.5
    length = worn.lock[0] * (0.8 + 0.4 * chance.share())
    end = min(begin + length / 0.13, 1.10) if not falls else 1.75 + 0.35 * chance.share()
    steps = 6 if falls else 4
    share = np.linspace(begin, end, steps)
    swept = worn.sweep * (1.0 if worn.fall == 0.0 else math.copysign(1.0, azimuth0))
    drift = swept * (share - begin) + 0.25 * worn.wild * (chance.share() - 0.5) * (share - begin)
    along = np.linspace(0.0, 1.0, steps)
    lift = -0.0006 + (0.0012 + 0.004 * worn.wild * chance.share()) * np.sin(math.pi * (0.15 + 0.75 * along))
    line = _path(head, worn, azimuth0 + drift, np.minimum(share, 2.0), lift)
    if worn.fall == 0.0 and style == "short":
        line[-1] += (line[-1] - head.middle) * 0.05
    _spindle(
        draft, shades, head, bones, line, worn.lock[1] * (0.7 + 0.6 * chance.share()), 0.78 + 0.26 * chance.share()
    )


def _spindle(
    draft: Draft, shades: list[F8], head: Head, bones: Skeleton, line: F8, breadth: float, shade: float
) -> None:
    along = np.gradient(line, axis=0)
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    out = line - head.middle
    out = out - (out * along).sum(axis=1, keepdims=True) * along
    out /= np.linalg.norm(out, axis=1, keepdims=True)
    beside = np.cross(along, out)
    profile = np.sin(math.pi * np.linspace(0.02, 0.96, len(line)) ** 0.8) ** 0.7
    rings = []
    for point, side, up, wide in zip(line, beside, out, profile, strict=True):
        half, thick = 0.5 * breadth * wide, 0.0030 * wide
        places = np.array(
            [
                point - half * side - 1.3 * thick * up,
                point - 1.6 * thick * up,
                point + half * side - 1.3 * thick * up,
                point + thick * up,
            ]
        )
        rings.append(draft.add(places, _held(bones, places, head, np.ones(4))))
        tone = shade * (0.84 + 0.18 * wide)
        shades += [np.full(3, 0.90 * tone), np.full(3, 0.8 * tone), np.full(3, 0.90 * tone), np.full(3, tone)]
    u = [0.0, 0.25, 0.5, 0.25, 0.0]
    for number, (one, two) in enumerate(itertools.pairwise(rings)):
        draft.band(one, two, u, (number / len(rings), (number + 1) / len(rings)))
    draft.lid(rings[0], line[0], (0.25, 0.0), flip=True)
    draft.lid(rings[-1], line[-1] + 0.4 * (line[-1] - line[-2]), (0.25, 1.0))
    shades += [np.full(3, 0.6 * shade), np.full(3, shade)]


def _tail(draft: Draft, shades: list[F8], head: Head, bones: Skeleton, chance: Chance) -> None:
    """Hair gathered behind: a knot and strands that hang from it."""
    root = head.mark(0.0, 30.0, -104.0)
    for number in range(7):
        turn = 2.0 * math.pi * number / 7.0
        spread = np.array([math.cos(turn), 0.35 * math.sin(turn), 0.7 * math.sin(turn)])
        drop = 0.15 + 0.03 * chance.share()
        way = np.linspace(0.0, 1.0, 6)[:, None]
        line = root + spread * (0.007 + 0.016 * np.sin(math.pi * way * 0.9)) + way**1.3 * np.array([0.0, -drop, -0.004])
        line = line + np.sin(math.pi * way) * np.array([0.0, 0.0, -0.030])
        _spindle(draft, shades, head, bones, line, 0.030, 0.8 + 0.3 * chance.share())
