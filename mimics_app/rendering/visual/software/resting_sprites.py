"""Sprites that are behind everything that changes: they need not be drawn again with it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import F8
from mimics_app.rendering.visual.effects.far_sprites import FarSprites
from mimics_app.rendering.visual.kernels.particles import SPRITE
from mimics_app.rendering.visual.kernels.sprites import LEVEL, UPRIGHT

__all__ = ["RestingSprites"]

_PERIOD = 60
"""Frames after which a distance is forgotten, at the earliest."""


class RestingSprites(FarSprites):
    """Counts the blended billboards at rest that are behind all sprites that change or have a mask.

    What is farther than all of something is behind it at every pixel, and is blended before it.
    """

    def __init__(self) -> None:
        self._before, self._rest = np.zeros(0, SPRITE), np.zeros(0, np.bool_)
        self._farthest = [0.0, 0.0]
        self._frames = 0

    def follow(self, billboards: NDArray[np.void]) -> None:
        alike = len(self._before) == len(billboards)
        self._rest = self._before == billboards if alike else np.zeros(len(billboards), np.bool_)
        self._before = billboards.copy()

    def rest(self) -> None:
        self._rest[:] = True

    def count(self, sprites: NDArray[np.void], numbers: NDArray[np.int32], solid: int, eye: F8, away: F8) -> int:
        seen, at_rest = sprites[numbers], np.zeros(len(sprites), np.bool_)
        at_rest[: len(self._rest)] = self._rest
        rests = at_rest[numbers]
        rests[:solid] = False
        offset, half = seen["place"] - eye, seen["half"]
        distance = np.linalg.norm(offset, axis=1)
        radius = np.linalg.norm(half, axis=1) + seen["lift"] * half[:, 1]
        least = np.where(seen["facing"] == LEVEL, distance - radius, distance)
        upright = seen["facing"] == UPRIGHT
        least[upright] = np.hypot(offset[upright, 0], offset[upright, 2])
        far = self._far(max((distance + radius)[~rests].max(initial=0.0), away.max(initial=0.0)))
        nearer = np.flatnonzero(~(rests & (least > far))[solid:])
        return int(nearer[0]) if len(nearer) else len(numbers) - solid

    def _far(self, distance: float) -> float:
        """Return the largest distance of at least the last `_PERIOD` frames.

        Otherwise a particle at the far edge of a cloud would change the count whenever it comes and goes.
        """
        if self._frames % _PERIOD == 0:
            self._farthest = [self._farthest[1], distance]
        self._frames += 1
        self._farthest[1] = max(self._farthest[1], distance)
        return max(self._farthest)
