"""Levels of detail: what files, shapes and tables agree on."""

from __future__ import annotations

import math
from collections.abc import Sequence

__all__ = ["COVERED_PICTURE", "MAX_LEVELS", "coverages_of"]

MAX_LEVELS = 8
"""Levels of detail a body can have."""

COVERED_PICTURE = (1920, 1080)
"""In which the coverages of levels are given [px]."""


def coverages_of(radius: float, errors: Sequence[float], pixels: float) -> tuple[float, ...]:
    """Least share of the picture at which each level is shown, the last one's 0: none is wrong by more pixels.

    A sphere of radius r covers c of a picture of w x h where its own radius is sqrt(c w h / pi) pixels.

    Args:
        radius: Of the sphere about the body [m].
        errors: Farthest each level lies from the body [m], the finest one's first; rising.
        pixels: Largest error in a picture of `COVERED_PICTURE` [px].
    """
    area = math.pi * pixels**2 / (COVERED_PICTURE[0] * COVERED_PICTURE[1])
    least = [min(1.0, area * (radius / error) ** 2) if error > 0.0 else 1.0 for error in errors[1:]]
    falling = [value * (1.0 - 1e-6) ** k for k, value in enumerate(least)]
    return (*falling, 0.0)
