"""Queries of a triangle mesh through its tree of boxes: where a segment enters it, and its closest triangle.

The tree of a mesh is a heap: node i has the children 2 i + 1 and 2 i + 2, the last `leaves` nodes (a power of two) are
leaves, and leaf j holds the triangles j T / leaves to (j + 1) T / leaves, which stand in the order of a space-filling
curve. So it needs neither pointers nor a stack: the next node is known from the number of the last.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mimics_app.contracts.arrays import F8, I4, Vec
from mimics_app.contracts.kernel import kernel

if TYPE_CHECKING:
    from mimics_app.contracts.record_types import MeshRecord

__all__ = [
    "ANYWHERE",
    "INSIDE",
    "LOOKS",
    "closest_on_triangle",
    "closest_triangle",
    "first_crossing",
    "next_node",
    "triangle_normal",
]


Three = tuple[float, float, float]

LOOKS = 0.3
"""Cosine between the normal of a face and a direction from which it looks along it; each convex solid has one."""

ANYWHERE = (0.0, 0.0, 0.0)
"""No direction."""

INSIDE = 6
"""Region of a triangle: its interior. 0..2: the edge from that corner to the next; 3..5: a corner."""

_CORNER_A, _CORNER_B, _CORNER_C = 3, 4, 5
"""Regions of the corners."""

_SURFACE = 1e-9
"""A segment may begin so far [m] behind a triangle and still enter through it: rounding of what was released there."""

_EDGE = 1e-9
"""Share of a triangle by which its edges are widened: a segment through an edge must not slip between two triangles."""


@kernel
def triangle_normal(vertices: F8, corners: I4, t: int, out: Vec) -> float:
    """Set out = (b - a) x (c - a), outward for corners counter-clockwise from outside; return its length."""
    a, b, c = corners[t, 0], corners[t, 1], corners[t, 2]
    ux, uy, uz = vertices[b, 0] - vertices[a, 0], vertices[b, 1] - vertices[a, 1], vertices[b, 2] - vertices[a, 2]
    vx, vy, vz = vertices[c, 0] - vertices[a, 0], vertices[c, 1] - vertices[a, 1], vertices[c, 2] - vertices[a, 2]
    out[0] = uy * vz - uz * vy
    out[1] = uz * vx - ux * vz
    out[2] = ux * vy - uy * vx
    return np.sqrt(out[0] * out[0] + out[1] * out[1] + out[2] * out[2])


@kernel
def _along(vertices: F8, a: int, b: int, share: float, out: Vec) -> None:
    for i in range(3):
        out[i] = vertices[a, i] + share * (vertices[b, i] - vertices[a, i])


@kernel
def closest_on_triangle(vertices: F8, corners: I4, t: int, p: Vec, out: Vec) -> int:
    """Set out to the point of triangle t that is closest to p; return the region it lies in (Ericson 2005, 5.1.5).

    Args:
        vertices: Shape [n, 3] [m].
        corners: Rows of vertices, shape [triangles, 3].
        t: Triangle.
        p: Point [m], same frame.
        out: Receives the closest point [m].
    """
    a, b, c = corners[t, 0], corners[t, 1], corners[t, 2]
    ab_ap = ac_ap = ab_ab = ab_ac = ac_ac = 0.0
    for i in range(3):
        ab, ac, ap = vertices[b, i] - vertices[a, i], vertices[c, i] - vertices[a, i], p[i] - vertices[a, i]
        ab_ap += ab * ap
        ac_ap += ac * ap
        ab_ab += ab * ab
        ab_ac += ab * ac
        ac_ac += ac * ac
    # Products with the vectors from b and c to p follow from those from a.
    ab_bp, ac_bp = ab_ap - ab_ab, ac_ap - ab_ac
    ab_cp, ac_cp = ab_ap - ab_ac, ac_ap - ac_ac
    if ab_ap <= 0.0 and ac_ap <= 0.0:
        _along(vertices, a, a, 0.0, out)
        return _CORNER_A
    if ab_bp >= 0.0 and ac_bp <= ab_bp:
        _along(vertices, b, b, 0.0, out)
        return _CORNER_B
    if ac_cp >= 0.0 and ab_cp <= ac_cp:
        _along(vertices, c, c, 0.0, out)
        return _CORNER_C
    return _closest_off_corners(vertices, a, b, c, (ab_ap, ac_ap, ab_bp, ac_bp, ab_cp, ac_cp), out)


@kernel
def _closest_off_corners(
    vertices: F8, a: int, b: int, c: int, products: tuple[float, float, float, float, float, float], out: Vec
) -> int:
    """The rest of `closest_on_triangle`, for a point nearest to an edge or the interior."""
    ab_ap, ac_ap, ab_bp, ac_bp, ab_cp, ac_cp = products
    of_c = ab_ap * ac_bp - ab_bp * ac_ap
    if of_c <= 0.0 and ab_ap >= 0.0 and ab_bp <= 0.0:
        _along(vertices, a, b, ab_ap / (ab_ap - ab_bp), out)
        return 0
    of_b = ab_cp * ac_ap - ab_ap * ac_cp
    if of_b <= 0.0 and ac_ap >= 0.0 and ac_cp <= 0.0:
        _along(vertices, a, c, ac_ap / (ac_ap - ac_cp), out)
        return 2
    of_a = ab_bp * ac_cp - ab_cp * ac_bp
    if of_a <= 0.0 and ac_bp - ab_bp >= 0.0 and ab_cp - ac_cp >= 0.0:
        _along(vertices, b, c, (ac_bp - ab_bp) / ((ac_bp - ab_bp) + (ab_cp - ac_cp)), out)
        return 1
    total = of_a + of_b + of_c
    v, w = of_b / total, of_c / total
    for i in range(3):
        at = vertices[a, i]
        out[i] = at + v * (vertices[b, i] - at) + w * (vertices[c, i] - at)
    return INSIDE


@kernel
def next_node(node: int) -> int:
    """The node after one whose subtree is done, in depth-first order; 0 after the last."""
    while node > 0 and node % 2 == 0:
        node = (node - 1) // 2
    return node + 1 if node > 0 else 0


@kernel
def _meets(boxes: F8, node: int, a: Vec, b: Vec) -> bool:
    """The box around the segment a -> b, widened by the tolerance, overlaps that of a node."""
    for i in range(3):
        if min(a[i], b[i]) - _SURFACE > boxes[node, 3 + i] or max(a[i], b[i]) + _SURFACE < boxes[node, i]:
            return False
    return True


@kernel
def _crossing(vertices: F8, corners: I4, t: int, a: Vec, b: Vec, n: Vec) -> float:
    """Share of the segment a -> b at which it passes triangle t from front to back; 2 where it does not."""
    size = triangle_normal(vertices, corners, t, n)
    first = corners[t, 0]
    before = after = 0.0
    for i in range(3):
        before += n[i] * (a[i] - vertices[first, i])
        after += n[i] * (b[i] - vertices[first, i])
    if after >= 0.0 or after >= before or before < -_SURFACE * size:
        return 2.0
    share = max(0.0, before / (before - after))
    for k in range(3):
        i, j = corners[t, k], corners[t, (k + 1) % 3]
        ex, ey, ez = vertices[j, 0] - vertices[i, 0], vertices[j, 1] - vertices[i, 1], vertices[j, 2] - vertices[i, 2]
        x = a[0] + share * (b[0] - a[0]) - vertices[i, 0]
        y = a[1] + share * (b[1] - a[1]) - vertices[i, 1]
        z = a[2] + share * (b[2] - a[2]) - vertices[i, 2]
        inward = n[0] * (ey * z - ez * y) + n[1] * (ez * x - ex * z) + n[2] * (ex * y - ey * x)
        if inward < -_EDGE * size * size:
            return 2.0
    return share


@kernel
def first_crossing(mesh: MeshRecord, vertices: F8, corners: I4, boxes: F8, a: Vec, b: Vec, n: Vec) -> int:
    """The first triangle that the segment a -> b passes from front to back, -1: none.

    Args:
        mesh: MESH record.
        vertices: Shape [n, 3] [m].
        corners: Rows of vertices, shape [triangles, 3].
        boxes: Least and greatest corner of each node, shape [nodes, 6].
        a: Beginning [m], mesh frame.
        b: End [m].
        n: Scratch, shape [3].
    """
    found, earliest = -1, 2.0
    node = 0
    while True:
        if _meets(boxes, mesh.first_node + node, a, b):
            leaf = node - mesh.leaves + 1
            if leaf < 0:
                node = 2 * node + 1
                continue
            begin = mesh.first_triangle + leaf * mesh.triangles // mesh.leaves
            end = mesh.first_triangle + (leaf + 1) * mesh.triangles // mesh.leaves
            for t in range(begin, end):
                share = _crossing(vertices, corners, t, a, b, n)
                if share < earliest:
                    found, earliest = t, share
        node = next_node(node)
        if node == 0:
            return found


@kernel
def _box_distance(boxes: F8, node: int, p: Vec) -> float:
    """Square of the distance from p to a node's box [m^2]."""
    total = 0.0
    for i in range(3):
        off = max(boxes[node, i] - p[i], 0.0, p[i] - boxes[node, 3 + i])
        total += off * off
    return total


@kernel
def closest_triangle(
    mesh: MeshRecord, vertices: F8, corners: I4, boxes: F8, p: Vec, limit: float, toward: Three, out: Vec
) -> int:
    """The triangle closest to p, -1: none is closer than `limit` [m]. Of equally close ones that which p faces most.

    Arguments as `first_crossing`; out is scratch, shape [3]. Only triangles that look `toward` a direction count (unit,
    mesh frame), or all with `ANYWHERE`.
    """
    found, best = -1, limit * limit
    facing = 0.0
    node = 0
    while True:
        if _box_distance(boxes, mesh.first_node + node, p) <= best:
            leaf = node - mesh.leaves + 1
            if leaf < 0:
                node = 2 * node + 1
                continue
            begin = mesh.first_triangle + leaf * mesh.triangles // mesh.leaves
            end = mesh.first_triangle + (leaf + 1) * mesh.triangles // mesh.leaves
            for t in range(begin, end):
                closest_on_triangle(vertices, corners, t, p, out)
                square = (p[0] - out[0]) ** 2 + (p[1] - out[1]) ** 2 + (p[2] - out[2]) ** 2
                if square <= best * (1.0 + _EDGE) and _looks(vertices, corners, t, toward, out):
                    turned = _facing(vertices, corners, t, p, out)
                    if square < best * (1.0 - _EDGE) or turned > facing:
                        found, facing = t, turned
                    best = min(best, square)
        node = next_node(node)
        if node == 0:
            return found


@kernel
def _looks(vertices: F8, corners: I4, t: int, toward: Three, out: Vec) -> bool:
    """True for a triangle that looks along a direction, or when there is none."""
    if toward[0] == 0.0 and toward[1] == 0.0 and toward[2] == 0.0:
        return True
    size = triangle_normal(vertices, corners, t, out)
    return out[0] * toward[0] + out[1] * toward[1] + out[2] * toward[2] > LOOKS * size


@kernel
def _facing(vertices: F8, corners: I4, t: int, p: Vec, out: Vec) -> float:
    """Distance of p from the plane of a triangle [m]: says on which side of an edge shared by two it is."""
    size = triangle_normal(vertices, corners, t, out)
    first = corners[t, 0]
    total = 0.0
    for i in range(3):
        total += out[i] * (p[i] - vertices[first, i])
    return abs(total) / size
