"""Levels of detail: limits and coverages shared by files, shapes and tables."""

from __future__ import annotations

import math
from collections.abc import Sequence

__all__ = ["COVERED_PICTURE", "MAX_LEVELS", "coverages_of"]

MAX_LEVELS = 8
"""Largest number of levels of detail of a body."""

COVERED_PICTURE = (1920, 1080)
"""Picture size that the coverages of levels refer to [px]."""


def coverages_of(radius: float, errors: Sequence[float], pixels: float) -> tuple[float, ...]:
    """Return the smallest coverage at which each level is shown, 0 for the last, so that no error exceeds `pixels`.

    A sphere covers the share c of a picture of w x h pixels where its projected radius is sqrt(c w h / pi) pixels.

    Args:
        radius: Radius of the body's bounding sphere [m].
        errors: Largest distance of each level from the body's surface [m], finest level first; increasing.
        pixels: Largest error in a picture of `COVERED_PICTURE` [px].
    """
    area = math.pi * pixels**2 / (COVERED_PICTURE[0] * COVERED_PICTURE[1])
    smallest = [min(1.0, area * (radius / error) ** 2) if error > 0.0 else 1.0 for error in errors[1:]]
    decreasing = [value * (1.0 - 1e-6) ** k for k, value in enumerate(smallest)]
    return (*decreasing, 0.0)
