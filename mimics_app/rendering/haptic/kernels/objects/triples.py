"""Three-vectors as tuples: the collision tests compute in registers, with no array to write to."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mimics_app.contracts.kernel import kernel

if TYPE_CHECKING:
    from mimics_app.contracts.record_types import SolidRecord

__all__ = ["Three", "across", "along", "axis", "cross", "dot", "into", "middle", "minus", "out_of", "times", "unit"]

Three = tuple[float, float, float]


_NO_SIZE = 1e-12
"""Length below which a vector has no direction, in its own unit."""

_ALONG_X = 0.6
"""Part of a unit vector along x from which the other axis is taken to cross it with [-]."""


@kernel
def dot(a: Three, b: Three) -> float:
    """Return a . b."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@kernel
def cross(a: Three, b: Three) -> Three:
    """Return a x b."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@kernel
def minus(a: Three, b: Three) -> Three:
    """Return a - b."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@kernel
def times(factor: float, a: Three) -> Three:
    """Return factor a."""
    return factor * a[0], factor * a[1], factor * a[2]


@kernel
def along(a: Three, factor: float, b: Three) -> Three:
    """Return a + factor b."""
    return a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2]


@kernel
def unit(a: Three, otherwise: Three) -> Three:
    """Return a / |a|, or `otherwise` where a has no direction."""
    size = math.sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2])
    if size < _NO_SIZE:
        return otherwise
    return a[0] / size, a[1] / size, a[2] / size


@kernel
def across(n: Three) -> Three:
    """A unit vector perpendicular to the unit vector n; the same one for the same n."""
    if abs(n[0]) < _ALONG_X:
        return unit((0.0, n[2], -n[1]), (0.0, 0.0, 1.0))
    return unit((-n[2], 0.0, n[0]), (0.0, 1.0, 0.0))


@kernel
def middle(solid: SolidRecord) -> Three:
    """Origin of a SOLID in the world [m]."""
    return solid.position[0], solid.position[1], solid.position[2]


@kernel
def axis(solid: SolidRecord, j: int) -> Three:
    """Axis j of a SOLID in the world: column j of its rotation."""
    return solid.rotation[0, j], solid.rotation[1, j], solid.rotation[2, j]


@kernel
def into(solid: SolidRecord, a: Three) -> Three:
    """R^T a: a world direction in the frame of a SOLID."""
    return dot(axis(solid, 0), a), dot(axis(solid, 1), a), dot(axis(solid, 2), a)


@kernel
def out_of(solid: SolidRecord, a: Three) -> Three:
    """R a: a direction of a SOLID in the world."""
    R = solid.rotation
    return (
        R[0, 0] * a[0] + R[0, 1] * a[1] + R[0, 2] * a[2],
        R[1, 0] * a[0] + R[1, 1] * a[1] + R[1, 2] * a[2],
        R[2, 0] * a[0] + R[2, 1] * a[1] + R[2, 2] * a[2],
    )
