"""Operations of the tick on short vectors, in place and without allocation."""

from __future__ import annotations

import math

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Mat, Vec

__all__ = ["all_finite", "clamp_joints", "clamp_norm", "copy", "fill", "norm", "rotate", "rotate_back", "scale"]


@kernel
def norm(a: Vec) -> float:
    """Euclidean length of a, shape [3], in a's unit; inf when it overflows."""
    return math.sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2])


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
