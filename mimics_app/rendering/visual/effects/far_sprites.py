"""Sprites that are behind everything that changes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import F8

__all__ = ["FarSprites"]


class FarSprites:
    """Counts them; on a graphics card none, for all sprites are drawn in every frame."""

    def follow(self, billboards: NDArray[np.void]) -> None:
        """Note the billboards of a frame: those that are as in the last one are at rest; SPRITE [n]."""

    def rest(self) -> None:
        """Note that all billboards are as in the last frame."""

    def count(self, sprites: NDArray[np.void], numbers: NDArray[np.int32], solid: int, eye: F8, away: F8) -> int:
        """Return how many blended sprites of a view are behind what changes.

        Args:
            sprites: All sprites, the billboards first, SPRITE [m].
            numbers: Those of the view: masked ones, then blended ones far to near, [k].
            solid: Number of masked ones.
            eye: Position of the camera, world [m], [3].
            away: Distances of the blended surfaces in the view [m].
        """
        return 0
