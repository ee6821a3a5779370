"""Three-vectors as tuples, which collision tests keep in registers instead of arrays."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec3

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import SolidRecord

__all__ = ["across", "along", "axis", "cross", "dot", "minus", "position_of", "times", "to_local", "to_world", "unit"]


_NO_SIZE = 1e-12
"""Length below which the direction of a vector is undefined, in its own unit."""

_ALONG_X = 0.6
"""Component x of a unit vector from which it is crossed with y instead of x [-]."""


@kernel
def dot(a: Vec3, b: Vec3) -> float:
    """Return a . b."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


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


@kernel
def position_of(solid: SolidRecord) -> Vec3:
    """Origin of a SOLID in the world [m]."""
    return solid.position[0], solid.position[1], solid.position[2]


@kernel
def axis(solid: SolidRecord, j: int) -> Vec3:
    """Axis j of a SOLID in the world: column j of its rotation."""
    return solid.rotation[0, j], solid.rotation[1, j], solid.rotation[2, j]


@kernel
def to_local(solid: SolidRecord, a: Vec3) -> Vec3:
    """Direction R^T a: from the world to the frame of a SOLID."""
    return dot(axis(solid, 0), a), dot(axis(solid, 1), a), dot(axis(solid, 2), a)


@kernel
def to_world(solid: SolidRecord, a: Vec3) -> Vec3:
    """Direction R a: from the frame of a SOLID to the world."""
    R = solid.rotation
    return (
        R[0, 0] * a[0] + R[0, 1] * a[1] + R[0, 2] * a[2],
        R[1, 0] * a[0] + R[1, 1] * a[1] + R[1, 2] * a[2],
        R[2, 0] * a[0] + R[2, 1] * a[1] + R[2, 2] * a[2],
    )
