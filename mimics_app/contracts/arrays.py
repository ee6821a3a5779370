"""Array types by number type, for signatures; docstrings give the shapes."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["B1", "F4", "F8", "I4", "I8", "U1", "U2", "U4", "U8", "Mat", "Records", "Vec", "Vec3", "Words"]

F8 = NDArray[np.float64]
F4 = NDArray[np.float32]
I8 = NDArray[np.int64]
I4 = NDArray[np.int32]
U8 = NDArray[np.uint64]
U4 = NDArray[np.uint32]
U2 = NDArray[np.uint16]
U1 = NDArray[np.uint8]
B1 = NDArray[np.bool_]

Vec = F8
"""One axis: a point, a direction, a row of memory."""

Mat = F8
"""Two axes."""

Words = I8
"""Words of shared memory, or of a table for compiled code."""

Records = NDArray[Any]
"""Rows of a structured dtype."""

Vec3 = tuple[float, float, float]
"""x, y and z of a point [m] or a direction [-]."""
