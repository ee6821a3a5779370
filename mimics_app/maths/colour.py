"""Display values of colours and the light they stand for."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from mimics_app.contracts.arrays import F8

__all__ = ["linear_light"]


def linear_light(display: ArrayLike) -> F8:
    """Return linear light, 0-1, of sRGB display values, 0-1 (IEC 61966-2-1), in their shape."""
    value = np.asarray(display, np.float64)
    return np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4)
