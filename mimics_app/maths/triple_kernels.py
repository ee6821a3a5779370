"""Three-vectors as tuples for compiled code, which keeps them in registers; `maths.vec` has `dot`, for arrays too."""

from __future__ import annotations

import math

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec3

__all__ = ["across", "along", "cross", "minus", "times", "unit"]

_NO_SIZE = 1e-12
"""Length below which the direction of a vector is undefined, in its own unit."""

_ALONG_X = 0.6
"""Component x of a unit vector from which it is crossed with y instead of x [-]."""


@kernel
def cross(a: Vec3, b: Vec3) -> Vec3:
    """Return a x b."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@kernel
def minus(a: Vec3, b: Vec3) -> Vec3:
    """Return a - b."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@kernel
def times(factor: float, a: Vec3) -> Vec3:
    """Return factor a."""
    return factor * a[0], factor * a[1], factor * a[2]


@kernel
def along(a: Vec3, factor: float, b: Vec3) -> Vec3:
    """Return a + factor b."""
    return a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2]


@kernel
def unit(a: Vec3, otherwise: Vec3) -> Vec3:
    """Return a / |a|, or `otherwise` where a has no direction."""
    size = math.sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2])
    if size < _NO_SIZE:
        return otherwise
    return a[0] / size, a[1] / size, a[2] / size


@kernel
def across(n: Vec3) -> Vec3:
    """A unit vector perpendicular to the unit vector n, a function of n alone."""
    if abs(n[0]) < _ALONG_X:
        return unit((0.0, n[2], -n[1]), (0.0, 0.0, 1.0))
    return unit((-n[2], 0.0, n[0]), (0.0, 1.0, 0.0))
