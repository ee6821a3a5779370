"""Cylinders against cylinders and boxes: the normal between their closest points.

Both are taken as slightly smaller solids with a skin around them (`_SKIN` of the thinnest half, or the shape's own
rounding if that is more). While the cores are apart their closest points give a normal that never jumps (Gilbert,
Johnson & Keerthi 1988), whatever meets: cap, side, rim, edge or corner. Edges and rims are thereby rounded by the skin.
Deeper than both skins the least overlap counts, of the last normal, the faces and the crossed edges: a way out that is
bounded by the smaller solid.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.haptic_objects import ShapeKind
from mimics_app.contracts.kernel import kernel
from mimics_app.rendering.haptic.kernels.objects.triples import (
    Three,
    along,
    axis,
    cross,
    dot,
    middle,
    minus,
    times,
    unit,
)

if TYPE_CHECKING:
    from mimics_app.contracts.record_types import Floats, SolidRecord

__all__ = ["separate_hulls", "support"]


_SKIN = 0.1
"""Skin of a solid, as a share of half of its thinnest side."""

_TURNS = 32
"""Most steps of the search; a box takes 3-5, two rims about 10."""

_EXACT = 1e-10
"""Relative gain at which the search ends."""

_KEEP = 0.9
"""The last normal counts as so much less deep than it is."""


_THICKEST_SKIN = 0.9
"""Most that a rounding may be as a skin, as a share of half of the thinnest side: a core is left."""

_AT_ORIGIN = 1e-20
"""Square of a distance that counts as none [m^2]."""

_TOUCHING = 1e-9
"""Distance of two cores below which its direction says nothing [m]."""

_AT_A, _AT_B, _AT_C = 1, 2, 4
"""Corners of a triangle as bits."""

_TETRAHEDRON = 4
"""Its corners, and its faces: one against each."""

_AXES_OF_BOTH, _DIRECTIONS = 6, 15
"""The axes of two solids, and with the nine crossings of these: what is tried of two that overlap."""


@kernel
def _skin(solid: SolidRecord) -> float:
    size = solid.size
    if solid.kind == ShapeKind.BOX:
        thin = 0.5 * min(size[0], min(size[1], size[2]))
    else:
        thin = min(size[0], 0.5 * size[1])
    return max(_SKIN * thin, min(solid.rounding, _THICKEST_SKIN * thin))


@kernel
def support(solid: SolidRecord, d: Three, skin: float) -> Three:
    """Farthest point [m] along d of a box or cylinder without its skin."""
    size, p = solid.size, middle(solid)
    if solid.kind == ShapeKind.BOX:
        for j in range(3):
            edge = axis(solid, j)
            p = along(p, math.copysign(0.5 * size[j] - skin, dot(edge, d)), edge)
        return p
    up = axis(solid, 1)
    looks = dot(up, d)
    aside = unit(along(d, -looks, up), (0.0, 0.0, 0.0))
    return along(along(p, math.copysign(0.5 * size[1] - skin, looks), up), size[0] - skin, aside)


@kernel
def _corner(simplex: F8, i: int) -> Three:
    return simplex[i, 0], simplex[i, 1], simplex[i, 2]


@kernel
def _keep(simplex: F8, slot: int, p: Three) -> None:
    simplex[slot, 0], simplex[slot, 1], simplex[slot, 2] = p


@kernel
def _on_line(simplex: F8) -> tuple[int, Three]:
    """Closest point of a line to the origin; the simplex keeps the corners it lies between."""
    a, b = _corner(simplex, 0), _corner(simplex, 1)
    ab = minus(b, a)
    square = dot(ab, ab)
    t = -dot(a, ab) / square if square > 0.0 else 0.0
    if t <= 0.0:
        return 1, a
    if t >= 1.0:
        _keep(simplex, 0, b)
        return 1, b
    return 2, along(a, t, ab)


@kernel
def _triangle(a: Three, b: Three, c: Three) -> tuple[int, Three]:
    """Closest point of a triangle to the origin by its Voronoi regions (Ericson 2005, 5.1.5).

    Returns:
        (corners it lies between as bits 1, 2, 4, the point).
    """
    ab, ac = minus(b, a), minus(c, a)
    d1, d2, d3, d4, d5, d6 = -dot(ab, a), -dot(ac, a), -dot(ab, b), -dot(ac, b), -dot(ab, c), -dot(ac, c)
    va, vb, vc = d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2
    if d1 <= 0.0 and d2 <= 0.0:
        return _AT_A, a
    if d3 >= 0.0 and d4 <= d3:
        return _AT_B, b
    if d6 >= 0.0 and d5 <= d6:
        return _AT_C, c
    return _inside_triangle(a, b, c, (d1, d2, d3), (d4, d5, d6), (va, vb, vc))


@kernel
def _inside_triangle(a: Three, b: Three, c: Three, d123: Three, d456: Three, areas: Three) -> tuple[int, Three]:
    """The regions of edges and face of `_triangle`."""
    d1, d2, d3 = d123
    d4, d5, d6 = d456
    va, vb, vc = areas
    if vc <= 0.0 and d1 >= 0.0 and d3 <= 0.0:
        return _AT_A | _AT_B, along(a, d1 / (d1 - d3), minus(b, a))
    if vb <= 0.0 and d2 >= 0.0 and d6 <= 0.0:
        return _AT_A | _AT_C, along(a, d2 / (d2 - d6), minus(c, a))
    if va <= 0.0:
        return _AT_B | _AT_C, along(b, (d4 - d3) / ((d4 - d3) + (d5 - d6)), minus(c, b))
    scale = 1.0 / (va + vb + vc)
    return _AT_A | _AT_B | _AT_C, along(along(a, vb * scale, minus(b, a)), vc * scale, minus(c, a))


@kernel
def _on_triangle(simplex: F8) -> tuple[int, Three]:
    """Closest point of a triangle to the origin; the simplex keeps the corners it lies between."""
    bits, point = _triangle(_corner(simplex, 0), _corner(simplex, 1), _corner(simplex, 2))
    count = 0
    for i in range(3):
        if bits & (1 << i):
            _keep(simplex, count, _corner(simplex, i))
            count += 1
    return count, point


@kernel
def _drop_corner(simplex: F8, dropped: int) -> None:
    """Leave the triangle of a tetrahedron that lacks one corner in the first three rows."""
    for slot in range(dropped, 3):
        _keep(simplex, slot, _corner(simplex, slot + 1))


@kernel
def _outside_of(a: Three, b: Three, c: Three, other: Three) -> bool:
    """True when the origin lies on the far side of face abc from the fourth corner."""
    n = cross(minus(b, a), minus(c, a))
    return -dot(a, n) * dot(minus(other, a), n) <= 0.0


@kernel
def _on_tetrahedron(simplex: F8) -> tuple[int, Three]:
    """The nearest of the faces the origin is outside of; 4 corners: it is inside."""
    nearest, dropped = math.inf, -1
    for i in range(_TETRAHEDRON):
        a, b = _corner(simplex, (i + 1) % _TETRAHEDRON), _corner(simplex, (i + 2) % _TETRAHEDRON)
        c, other = _corner(simplex, (i + 3) % _TETRAHEDRON), _corner(simplex, i)
        if _outside_of(a, b, c, other):
            _, point = _triangle(a, b, c)
            if dot(point, point) < nearest:
                nearest, dropped = dot(point, point), i
    if dropped < 0:
        return _TETRAHEDRON, (0.0, 0.0, 0.0)
    _drop_corner(simplex, dropped)
    return _on_triangle(simplex)


@kernel
def _on_simplex(simplex: F8, count: int) -> tuple[int, Three]:
    """Closest point of a simplex to the origin; the simplex is reduced to what holds it."""
    if count == 1:
        return 1, _corner(simplex, 0)
    if count == 2:
        return _on_line(simplex)
    if count == 3:
        return _on_triangle(simplex)
    return _on_tetrahedron(simplex)


@kernel
def _gap(a: SolidRecord, b: SolidRecord, start: Three, skin_a: float, skin_b: float, simplex: Floats) -> Three:
    """Shortest vector from the core of b to that of a; zero when they overlap."""
    v, count = start, 0
    for _ in range(_TURNS):
        back = times(-1.0, v)
        at_a = support(a, back, skin_a)
        w = minus(at_a, support(b, v, skin_b))
        square = dot(v, v)
        if count > 0 and square - dot(v, w) <= _EXACT * square:
            break
        _keep(simplex, count, w)
        count, v = _on_simplex(simplex, count + 1)
        if count == _TETRAHEDRON or dot(v, v) < _AT_ORIGIN:
            return 0.0, 0.0, 0.0
    return v


@kernel
def _overlap(a: SolidRecord, b: SolidRecord, n: Three) -> float:
    """How deep the whole solids overlap along n, from a to b."""
    at_a = support(a, n, 0.0)
    at_b = support(b, times(-1.0, n), 0.0)
    return dot(minus(at_a, at_b), n)


@kernel
def _candidate(a: SolidRecord, b: SolidRecord, i: int) -> Three:
    """Directions worth trying of two solids that overlap: their axes and the crossings of these."""
    if i < 3:
        return axis(a, i)
    if i < _AXES_OF_BOTH:
        return axis(b, i - 3)
    crossed = cross(axis(a, (i - _AXES_OF_BOTH) // 3), axis(b, (i - _AXES_OF_BOTH) % 3))
    return unit(crossed, axis(b, 1))


@kernel
def _least_overlap(a: SolidRecord, b: SolidRecord, last: Three) -> tuple[float, Three]:
    """Overlap and normal of two solids whose cores overlap: along the last normal or the best of the candidates."""
    between = minus(middle(b), middle(a))
    normal = unit(last, unit(between, (0.0, 1.0, 0.0)))
    overlap = _overlap(a, b, normal)
    least = _KEEP * overlap
    for i in range(_DIRECTIONS):
        n = _candidate(a, b, i)
        apart = dot(between, n)
        n = times(-1.0, n) if apart < 0.0 or (apart == 0.0 and dot(last, n) < 0.0) else n
        deep = _overlap(a, b, n)
        if deep < least:
            overlap, least, normal = deep, deep, n
    return overlap, normal


@kernel
def separate_hulls(a: SolidRecord, b: SolidRecord, last: Three, simplex: Floats) -> tuple[float, float, Three]:
    """Overlap and normal of two solids of which one is a cylinder, the other a cylinder or box.

    Args:
        a: SOLID of one.
        b: SOLID of the other.
        last: Normal of the last tick, or zero.
        simplex: Room, shape [4, 3].

    Returns:
        (overlap [m], <= 0: apart; what the sharp solids overlap more along the normal [m]; unit normal from a to b).
    """
    skin_a, skin_b = _skin(a), _skin(b)
    away = minus(middle(a), middle(b))
    start = unit(times(-1.0, last), unit(away, (0.0, -1.0, 0.0)))
    v = _gap(a, b, start, skin_a, skin_b, simplex)
    gap = math.sqrt(dot(v, v))
    if gap > skin_a + skin_b:
        return 0.0, 0.0, last
    if gap > _TOUCHING:
        n = times(-1.0 / gap, v)
        overlap = skin_a + skin_b - gap
        return overlap, _overlap(a, b, n) - overlap, n
    overlap, n = _least_overlap(a, b, last)
    return overlap, 0.0, n
