"""3-vectors for compiled code, without allocation: results go to `out`, which may be one of the arguments."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from mimics_app.compiled.kernel import kernel

__all__ = ["Vec", "cross", "distance", "dot", "norm", "normalise", "unit"]

Vec = NDArray[np.float64]
"""float64, shape [3] unless said otherwise."""


@kernel
def dot(a: Vec, b: Vec) -> float:
    """The inner product of two 3-vectors."""
    product: float = a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
    return product


@kernel
def norm(a: Vec) -> float:
    """Length of a 3-vector."""
    return math.sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2])


@kernel
def distance(a: Vec, b: Vec) -> float:
    """Length of a - b."""
    x, y, z = a[0] - b[0], a[1] - b[1], a[2] - b[2]
    return math.sqrt(x * x + y * y + z * z)


@kernel
def cross(a: Vec, b: Vec, out: Vec) -> None:
    """Set out = a x b (right-handed)."""
    x = a[1] * b[2] - a[2] * b[1]
    y = a[2] * b[0] - a[0] * b[2]
    z = a[0] * b[1] - a[1] * b[0]
    out[0], out[1], out[2] = x, y, z


@kernel
def normalise(a: Vec, out: Vec) -> float:
    """Set out = a / |a|; return |a|. A zero or not finite vector gives out = 0 and returns 0.

    The vector is scaled by its largest component first, so that 1e-200 and 1e200 are normalised too.
    """
    largest = max(abs(a[0]), abs(a[1]), abs(a[2]))
    x, y, z = a[0] / largest, a[1] / largest, a[2] / largest
    length = math.sqrt(x * x + y * y + z * z)
    if not (0.0 < length < math.inf):
        out[0] = out[1] = out[2] = 0.0
        return 0.0
    out[0], out[1], out[2] = x / length, y / length, z / length
    whole: float = largest * length
    return whole


def unit(values: object) -> Vec:
    """Unit vector in the direction of a vector as a new array, for code outside the loop.

    Args:
        values: Three numbers of any unit.

    Raises:
        ValueError: the vector is zero or not finite.
    """
    vector = np.array(values, np.float64)
    if vector.shape != (3,):
        raise ValueError(f"a vector of shape {list(vector.shape)} instead of [3]")
    if normalise(vector, vector) == 0.0:
        raise ValueError("a zero or not finite vector has no direction")
    return vector
