"""Short vectors for compiled code, without allocation: results go to `out`, which may be one of the arguments.

`maths.triples` has three-vectors in plain Python.
"""

from __future__ import annotations

import math

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Mat, Vec, Vec3

__all__ = [
    "all_finite",
    "clamp_joints",
    "clamp_norm",
    "copy",
    "cross",
    "dot",
    "fill",
    "norm",
    "normalise",
    "rotate",
    "rotate_back",
    "scale",
    "unit",
]


@kernel
def dot(a: Vec | Vec3, b: Vec | Vec3) -> float:
    """The inner product of two 3-vectors."""
    product: float = a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
    return product


@kernel
def norm(a: Vec | Vec3) -> float:
    """Length of a, shape [3], in its unit; inf when it overflows."""
    return math.sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2])


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


@kernel
def copy(source: Vec, out: Vec) -> None:
    """Copy the first elements of source to out, for the length of out."""
    for i in range(out.shape[0]):
        out[i] = source[i]


@kernel
def fill(out: Vec, value: float) -> None:
    """Set every element of out to value."""
    for i in range(out.shape[0]):
        out[i] = value


@kernel
def scale(a: Vec, factor: float) -> None:
    """Multiply a by factor in place."""
    for i in range(a.shape[0]):
        a[i] *= factor


@kernel
def clamp_norm(a: Vec, limit: float) -> float:
    """Shorten a, shape [3], to at most `limit` along its direction; return the factor used (1: unchanged)."""
    length = norm(a)
    if length <= limit:
        return 1.0
    factor = limit / length
    for i in range(3):
        a[i] *= factor
    return factor


@kernel
def clamp_joints(q: Vec, lowest: Vec, highest: Vec) -> int:
    """Clamp q to [lowest, highest] joint by joint; bit i of the result is set where joint i was outside."""
    outside = 0
    for i in range(q.shape[0]):
        if q[i] < lowest[i]:
            q[i] = lowest[i]
            outside |= 1 << i
        elif q[i] > highest[i]:
            q[i] = highest[i]
            outside |= 1 << i
    return outside


@kernel
def all_finite(a: Vec) -> bool:
    """True when no element of a is NaN or infinite."""
    for i in range(a.shape[0]):
        if not math.isfinite(a[i]):
            return False
    return True


@kernel
def rotate(R: Mat, a: Vec, out: Vec) -> None:
    """Set out = R a for R of shape [3, 3]; out must not be a."""
    for i in range(3):
        out[i] = R[i, 0] * a[0] + R[i, 1] * a[1] + R[i, 2] * a[2]


@kernel
def rotate_back(R: Mat, a: Vec, out: Vec) -> None:
    """Set out = R^T a for R of shape [3, 3]; out must not be a."""
    for i in range(3):
        out[i] = R[0, i] * a[0] + R[1, i] * a[1] + R[2, i] * a[2]


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
