"""Two boxes (Figure 42): the axis along which they overlap least, of their 15 (Gottschalk, Lin & Manocha 1996).

The axis of the last tick is kept until another one is clearly less deep, so that faces that touch evenly do not change
places; contact points are laid over each other by `manifold`.
"""

from __future__ import annotations

import math
from typing import Any

from mimics_app.contracts.kernel import kernel
from mimics_app.rendering.haptic.kernels.objects.triples import Three, axis, cross, dot, middle, minus, times

__all__ = ["separate_boxes"]

_KEEP = 0.95
"""The axis of the last tick counts as so much less deep than it is."""

_EDGE = 1.05
"""Edges count as so much deeper: where a face does as well, the face it is."""

_PARALLEL = 1e-6
"""Square of the sine between two edges below which they have no normal of their own."""


@kernel
def _reach(size: Any, x: Three, y: Three, z: Three, n: Three) -> float:
    """How far a box reaches along n from its middle."""
    return 0.5 * (size[0] * abs(dot(x, n)) + size[1] * abs(dot(y, n)) + size[2] * abs(dot(z, n)))


@kernel
def separate_boxes(a: Any, b: Any, feature: int, last: Three) -> tuple[int, float, Three]:
    """Axis of least overlap of two boxes.

    Args:
        a: SOLID of a box.
        b: SOLID of the other.
        feature: Axis of the last tick, as returned; 0: none.
        last: Normal of the last tick, or zero: says the way out where the middles coincide.

    Returns:
        (axis 1-3: faces of a, 4-6: faces of b, 7-15: edges; 0: apart, overlap [m], unit normal from a to b).
    """
    size_a, size_b = a.size, b.size
    ax, ay, az = axis(a, 0), axis(a, 1), axis(a, 2)
    bx, by, bz = axis(b, 0), axis(b, 1), axis(b, 2)
    between = minus(middle(b), middle(a))
    best, least, overlap, normal = 0, math.inf, 0.0, ax
    for number in range(1, 16):
        if number < 7:
            n = axis(a, number - 1) if number < 4 else axis(b, number - 4)
            weight = 1.0
        else:
            n = cross(axis(a, (number - 7) // 3), axis(b, (number - 7) % 3))
            square = dot(n, n)
            if square < _PARALLEL:
                continue
            n = times(1.0 / math.sqrt(square), n)
            weight = _EDGE
        apart = dot(between, n)
        deep = _reach(size_a, ax, ay, az, n) + _reach(size_b, bx, by, bz, n) - abs(apart)
        if deep <= 0.0:
            return 0, 0.0, last
        if number == feature:
            weight *= _KEEP
        if deep * weight < least:
            best, least, overlap = number, deep * weight, deep
            backwards = apart < 0.0 or (apart == 0.0 and dot(last, n) < 0.0)
            normal = times(-1.0, n) if backwards else n
    return best, overlap, normal
