"""Locks of hair: closed blades that lie on the hair below or stand off it, broad at the root, pointed at the tip."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from assets.builders.avatars.draft import Draft
from assets.builders.avatars.fields import F8
from assets.builders.avatars.sheet import I8
from assets.builders.kit.rng import Rng

__all__ = ["LAID", "Lock", "add_lock"]

_THICK = 0.0030
"""Half of the thickness of a lock [m]."""
_PARTING = 0.50
"""Azimuth of a parting [rad]."""


@dataclass(frozen=True)
class Lock:
    """One lock.

    Attributes:
        azimuth: Of its root and of its tip [rad].
        share: Of both on the path from the crown (0) by the hairline (1) to the ends of long hair (2).
        lift: Height of root, middle and tip over the hair below [m].
        breadth: Largest breadth [m].
        shade: Factor on the colour.
        rings: Number of cross-sections.
    """

    azimuth: tuple[float, float]
    share: tuple[float, float]
    lift: tuple[float, float, float]
    breadth: float
    shade: float
    rings: int = 3

    def steps(self) -> tuple[F8, F8, F8]:
        """Return azimuth, share and lift along it, the tip last, [rings + 1] each."""
        t = np.linspace(0.0, 1.0, self.rings + 1)
        azimuth = self.azimuth[0] + (self.azimuth[1] - self.azimuth[0]) * np.sin(0.5 * math.pi * t)
        share = self.share[0] + (self.share[1] - self.share[0]) * t
        root, middle, tip = self.lift
        lift = root * (1.0 - t) * (1.0 - 2.0 * t) + 4.0 * middle * t * (1.0 - t) + tip * t * (2.0 * t - 1.0)
        return azimuth, share, lift


def add_lock(draft: Draft, line: F8, middle: F8, lock: Lock, held: Callable[[F8], F8]) -> list[F8]:
    """Add a lock along a line [rings + 1, 3] about the centre of a head, with weights by `held`; return its shades."""
    along = np.gradient(line, axis=0)
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    out = line - middle
    out -= (out * along).sum(axis=1, keepdims=True) * along
    out /= np.linalg.norm(out, axis=1, keepdims=True)
    beside = np.cross(along, out)
    t = np.linspace(0.0, 1.0, lock.rings + 1)
    profile = (0.62 + 0.9 * t) * (1.0 - t**1.6) / 0.92
    rings: list[I8] = []
    shades: list[F8] = []
    for i in range(lock.rings):
        half, thick = 0.5 * lock.breadth * profile[i] * beside[i], _THICK * out[i]
        places = np.array([line[i] - half - thick, line[i] + half - thick, line[i] + 0.6 * thick])
        rings.append(draft.add(places, held(places)))
        tone = lock.shade * (0.72 + 0.40 * t[i])
        shades += [np.full(3, 0.80 * tone), np.full(3, 0.80 * tone), np.full(3, tone)]
    u, tall = (0.0, 0.5, 0.25, 0.0), 0.8 / lock.rings
    for number, (one, two) in enumerate(itertools.pairwise(rings)):
        draft.band(one, two, u, (number * tall, (number + 1) * tall), flip=True)
    draft.face(rings[0].tolist(), [(0.25, 0.0)] * 3)
    draft.lid(rings[-1], line[-1], (0.25, 0.8), flip=True)
    return [*shades, np.full(3, 1.1 * lock.shade)]


def _parted(rng: Rng) -> list[Lock]:
    """Long hair from a parting to both sides, and a fringe that sweeps over the forehead."""
    locks = []
    for number in range(7):  # the broad side, from behind to before
        begin, end = 0.20 + 0.095 * number, -2.35 + 0.215 * number
        locks.append((_PARTING - 0.12, end, begin, 1.80 + 0.20 * rng.share()))
    for number in range(5):
        begin, end = 0.26 + 0.13 * number, 2.30 - 0.28 * number
        locks.append((_PARTING + 0.12, end, begin, 1.80 + 0.20 * rng.share()))
    for number in range(6):
        end = math.pi + 0.26 * (number - 2.5)
        locks.append((end + 0.2 * (rng.share() - 0.5), end, 0.14 + 0.3 * (number % 2), 1.86 + 0.16 * rng.share()))
    long = [
        Lock((one, two), (begin, end), (-0.0005, 0.0035 + 0.002 * rng.share(), _flick(rng)),
             0.034 + 0.008 * rng.share(), 0.88 + 0.18 * rng.share(), 5)
        for one, two, begin, end in locks
    ]  # fmt: skip
    fringe = ((-0.92, 1.62), (-1.02, 1.78), (-1.12, 1.92))
    return long + [
        Lock((_PARTING - 0.08, tip), (0.84 + 0.05 * k, end), (0.0, 0.008, 0.004), 0.034, tone, 6)
        for k, (tip, end) in enumerate(fringe)
        for tone in (0.92 + 0.12 * rng.share(),)
    ]


def _flick(rng: Rng) -> float:
    """Distance of the tip of long hair from the hair below it [m]."""
    return -0.004 + 0.008 * rng.share()


def _brushed_up(rng: Rng) -> list[Lock]:
    """Short hair: a fringe brushed up and to one side, rows overlapping like shingles behind it, close at the sides."""

    def row(
        azimuths: F8, turn: float, share: tuple[float, float], lift: tuple[float, float], breadth: float
    ) -> list[Lock]:
        made = []
        for azimuth in azimuths:
            loose, askew, tone = (rng.share() - 0.5 for _ in range(3))
            ends = float(azimuth) + 0.10 * askew, float(azimuth) + turn + 0.25 * askew
            high = lift[0] * (1.0 + 0.3 * loose), lift[1] * (1.0 + 0.5 * loose)
            begin, end = share[0] + 0.03 * askew, share[1] + 0.06 * loose
            made.append(Lock(ends, (begin, end), (-0.0015, *high), breadth, 0.95 + 0.22 * tone, 2))
        return made

    return [
        *row(np.linspace(-0.80, 0.76, 13), 0.34, (0.985, 0.60), (0.0075, 0.0065), 0.021),
        *row(np.linspace(-1.02, 0.98, 11), 0.36, (0.80, 0.38), (0.0050, 0.0060), 0.024),
        *row(np.linspace(-1.25, 1.20, 8), 0.40, (0.55, 0.12), (0.0040, 0.0050), 0.028),
        *row(np.linspace(1.60, 4.70, 7), 0.15, (0.22, 0.56), (0.0020, 0.0025), 0.028),
        *row(np.linspace(1.75, 4.55, 6), 0.10, (0.46, 0.80), (0.0015, 0.0010), 0.026),
        *row(np.linspace(1.05, 1.75, 4), 0.06, (0.40, 0.74), (0.0020, 0.0015), 0.024),
        *row(-np.linspace(1.05, 1.75, 4), -0.06, (0.40, 0.74), (0.0020, 0.0015), 0.024),
    ]


LAID: Mapping[str, Callable[[Rng], list[Lock]]] = {"bob": _parted, "short": _brushed_up}
"""The locks of each style of hair that has some."""
