"""Cylinders against cylinders and boxes: the normal between their closest points by GJK.

Both are taken as slightly smaller cores with a skin (`_SKIN` of the thinnest half, or the shape's own rounding if that
is larger). While the cores are apart their closest points give a continuous normal (Gilbert, Johnson & Keerthi 1988)
for caps, sides, rims, edges and corners alike; edges and rims are thereby rounded by the skin. Deeper than both skins
the least overlap counts, of the last normal, the faces and the crossed edges: the smaller solid bounds its depth.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import F8, Vec3
from mimics_app.contracts.loop.haptic_objects import ShapeKind
from mimics_app.maths.triple_kernels import along, cross, minus, times, unit
from mimics_app.maths.vec import dot
from mimics_app.rendering.haptic.kernels.objects.solid_frame import axis, position_of

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import Floats, SolidRecord

__all__ = ["separate_hulls", "support"]


_SKIN = 0.1
"""Skin of a solid, relative to half of its thinnest side [-]."""

_ITERATIONS = 32
"""Largest number of GJK iterations; a box takes 3-5, two rims about 10."""

_EXACT = 1e-10
"""Relative gain at which GJK ends [-]."""

_KEEP = 0.9
"""Factor on the depth along the last normal when normals are compared [-]."""

_THICKEST_SKIN = 0.9
"""Largest rounding used as a skin, relative to half of the thinnest side, so that a core is left [-]."""

_AT_ORIGIN = 1e-20
"""Square of a distance that counts as 0 [m^2]."""

_TOUCHING = 1e-9
"""Distance of two cores below which its direction is undefined [m]."""

_AT_A, _AT_B, _AT_C = 1, 2, 4
"""Vertices of a triangle as bits."""

_TETRAHEDRON = 4
"""Number of vertices of a tetrahedron, and of its faces."""

_AXES_OF_BOTH, _DIRECTIONS = 6, 15
"""Number of axes of two solids, and of candidate normals: these axes and their nine cross products."""


@kernel
def _skin(solid: SolidRecord) -> float:
    """Thickness of a solid's skin [m]."""
    size = solid.size
    if solid.kind == ShapeKind.BOX:
        thin = 0.5 * min(size[0], min(size[1], size[2]))
    else:
        thin = min(size[0], 0.5 * size[1])
    return max(_SKIN * thin, min(solid.rounding, _THICKEST_SKIN * thin))


@kernel
def support(solid: SolidRecord, d: Vec3, skin: float) -> Vec3:
    """Support point [m] along d of a box or cylinder without its skin."""
    size, p = solid.size, position_of(solid)
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
def _vertex(simplex: F8, i: int) -> Vec3:
    """Vertex i of the simplex [m]."""
    return simplex[i, 0], simplex[i, 1], simplex[i, 2]


@kernel
def _keep(simplex: F8, slot: int, p: Vec3) -> None:
    """Store vertex p in a row of the simplex."""
    simplex[slot, 0], simplex[slot, 1], simplex[slot, 2] = p


@kernel
def _on_line(simplex: F8) -> tuple[int, Vec3]:
    """Closest point of a segment to the origin; the simplex keeps the vertices that support it."""
    a, b = _vertex(simplex, 0), _vertex(simplex, 1)
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
def _triangle(a: Vec3, b: Vec3, c: Vec3) -> tuple[int, Vec3]:
    """Closest point of a triangle to the origin by its Voronoi regions (Ericson 2005, 5.1.5).

    Returns:
        (vertices that support it as bits 1, 2, 4, the point).
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
def _inside_triangle(a: Vec3, b: Vec3, c: Vec3, d123: Vec3, d456: Vec3, areas: Vec3) -> tuple[int, Vec3]:
    """The Voronoi regions of edges and face of `_triangle`."""
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
def _on_triangle(simplex: F8) -> tuple[int, Vec3]:
    """Closest point of a triangle to the origin; the simplex keeps the vertices that support it."""
    bits, point = _triangle(_vertex(simplex, 0), _vertex(simplex, 1), _vertex(simplex, 2))
    count = 0
    for i in range(3):
        if bits & (1 << i):
            _keep(simplex, count, _vertex(simplex, i))
            count += 1
    return count, point


@kernel
def _drop_vertex(simplex: F8, dropped: int) -> None:
    """Reduce a tetrahedron to its face opposite one vertex, in the first three rows."""
    for slot in range(dropped, 3):
        _keep(simplex, slot, _vertex(simplex, slot + 1))


@kernel
def _outside_of(a: Vec3, b: Vec3, c: Vec3, other: Vec3) -> bool:
    """Whether the origin and the fourth vertex lie on different sides of face abc."""
    n = cross(minus(b, a), minus(c, a))
    return -dot(a, n) * dot(minus(other, a), n) <= 0.0


@kernel
def _on_tetrahedron(simplex: F8) -> tuple[int, Vec3]:
    """Closest point of a tetrahedron to the origin, on its nearest outer face; 4 vertices: the origin is inside."""
    nearest, dropped = math.inf, -1
    for i in range(_TETRAHEDRON):
        a, b = _vertex(simplex, (i + 1) % _TETRAHEDRON), _vertex(simplex, (i + 2) % _TETRAHEDRON)
        c, other = _vertex(simplex, (i + 3) % _TETRAHEDRON), _vertex(simplex, i)
        if _outside_of(a, b, c, other):
            _, point = _triangle(a, b, c)
            if dot(point, point) < nearest:
                nearest, dropped = dot(point, point), i
    if dropped < 0:
        return _TETRAHEDRON, (0.0, 0.0, 0.0)
    _drop_vertex(simplex, dropped)
    return _on_triangle(simplex)


@kernel
def _on_simplex(simplex: F8, count: int) -> tuple[int, Vec3]:
    """Closest point of a simplex to the origin; the simplex is reduced to the vertices that support it."""
    if count == 1:
        return 1, _vertex(simplex, 0)
    if count == 2:
        return _on_line(simplex)
    if count == 3:
        return _on_triangle(simplex)
    return _on_tetrahedron(simplex)


@kernel
def _gap(a: SolidRecord, b: SolidRecord, start: Vec3, skin_a: float, skin_b: float, simplex: Floats) -> Vec3:
    """Shortest vector from the core of b to that of a by GJK; zero when they overlap."""
    v, count = start, 0
    for _ in range(_ITERATIONS):
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
def _overlap(a: SolidRecord, b: SolidRecord, n: Vec3) -> float:
    """Overlap [m] of the whole solids along n, from a to b."""
    at_a = support(a, n, 0.0)
    at_b = support(b, times(-1.0, n), 0.0)
    return dot(minus(at_a, at_b), n)


@kernel
def _candidate(a: SolidRecord, b: SolidRecord, i: int) -> Vec3:
    """Candidate normal i of two overlapping solids: one of their axes or of the cross products of these."""
    if i < 3:
        return axis(a, i)
    if i < _AXES_OF_BOTH:
        return axis(b, i - 3)
    crossed = cross(axis(a, (i - _AXES_OF_BOTH) // 3), axis(b, (i - _AXES_OF_BOTH) % 3))
    return unit(crossed, axis(b, 1))


@kernel
def _least_overlap(a: SolidRecord, b: SolidRecord, last: Vec3) -> tuple[float, Vec3]:
    """Overlap and normal of two solids with overlapping cores: of the last normal and the candidates the least deep."""
    between = minus(position_of(b), position_of(a))
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
def separate_hulls(a: SolidRecord, b: SolidRecord, last: Vec3, simplex: Floats) -> tuple[float, float, Vec3]:
    """Overlap and normal of two solids of which one is a cylinder, the other a cylinder or box.

    Args:
        a: SOLID of one.
        b: SOLID of the other.
        last: Normal of the last tick, or zero.
        simplex: Scratch, shape [4, 3].

    Returns:
        (overlap [m], <= 0: apart; further overlap of the sharp solids along the normal [m]; unit normal from a to b).
    """
    skin_a, skin_b = _skin(a), _skin(b)
    away = minus(position_of(a), position_of(b))
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
