"""Queries of a triangle mesh through its BVH of AABBs: first crossing of a segment, and closest triangle.

The BVH is a heap: node i has the children 2 i + 1 and 2 i + 2, the last `leaves` nodes (a power of two) are leaves, and
leaf j holds the triangles j T / leaves to (j + 1) T / leaves, sorted along a space-filling curve. The traversal needs
neither pointers nor a stack: the next node follows from the index of the last.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import F8, I4, Vec, Vec3
from mimics_app.maths.vec import dot, norm

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import MeshRecord

__all__ = [
    "ANY_DIRECTION",
    "FACING",
    "INSIDE",
    "closest_on_triangle",
    "closest_triangle",
    "first_crossing",
    "next_node",
    "triangle_normal",
]


FACING = 0.3
"""Cosine between a face's normal and a direction from which the face counts as facing it [-]."""

ANY_DIRECTION = (0.0, 0.0, 0.0)
"""Direction argument that lets every face count."""

INSIDE = 6
"""Region of a triangle: its interior. 0..2: the edge from that vertex to the next; 3..5: a vertex."""

FIRST_VERTEX = 3
"""Region of the first vertex; the others follow."""

_SURFACE = 1e-9
"""Distance behind a triangle from which a segment still enters through it [m]: rounding of a point at rest on it."""

_EDGE = 1e-9
"""Relative widening of a triangle's edges: a segment through an edge must not pass between two triangles [-]."""


@kernel
def triangle_normal(vertices: F8, corners: I4, t: int, out: Vec) -> float:
    """Set out = (b - a) x (c - a), outward for vertices counter-clockwise from outside; return its length."""
    a, b, c = corners[t, 0], corners[t, 1], corners[t, 2]
    ux, uy, uz = vertices[b, 0] - vertices[a, 0], vertices[b, 1] - vertices[a, 1], vertices[b, 2] - vertices[a, 2]
    vx, vy, vz = vertices[c, 0] - vertices[a, 0], vertices[c, 1] - vertices[a, 1], vertices[c, 2] - vertices[a, 2]
    out[0] = uy * vz - uz * vy
    out[1] = uz * vx - ux * vz
    out[2] = ux * vy - uy * vx
    return norm(out)


@kernel
def _along(vertices: F8, a: int, b: int, share: float, out: Vec) -> None:
    """Set out to the point at a share of the edge from vertex a to vertex b."""
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

    Returns:
        0..2: edge, 3..5: vertex, 6: INSIDE.
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
        return FIRST_VERTEX
    if ab_bp >= 0.0 and ac_bp <= ab_bp:
        _along(vertices, b, b, 0.0, out)
        return FIRST_VERTEX + 1
    if ac_cp >= 0.0 and ab_cp <= ac_cp:
        _along(vertices, c, c, 0.0, out)
        return FIRST_VERTEX + 2
    return _closest_off_vertices(vertices, a, b, c, (ab_ap, ac_ap, ab_bp, ac_bp, ab_cp, ac_cp), out)


@kernel
def _closest_off_vertices(
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
    """Node after a finished subtree in depth-first order; 0 after the last."""
    while node > 0 and node % 2 == 0:
        node = (node - 1) // 2
    return node + 1 if node > 0 else 0


@kernel
def _meets(boxes: F8, node: int, a: Vec, b: Vec) -> bool:
    """Whether the AABB of the segment a -> b, widened by the tolerance, overlaps that of a node."""
    for i in range(3):
        if min(a[i], b[i]) - _SURFACE > boxes[node, 3 + i] or max(a[i], b[i]) + _SURFACE < boxes[node, i]:
            return False
    return True


@kernel
def _crossing(vertices: F8, corners: I4, t: int, a: Vec, b: Vec, n: Vec) -> float:
    """Share of the segment a -> b at which it crosses triangle t from front to back; 2: it does not."""
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
    """First triangle that the segment a -> b crosses from front to back, -1: none.

    Args:
        mesh: MESH record.
        vertices: Shape [n, 3] [m].
        corners: Rows of vertices, shape [triangles, 3].
        boxes: AABB of each node, minimum then maximum, shape [nodes, 6] [m].
        a: Start of the segment [m], mesh frame.
        b: End of the segment [m].
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
    """Square of the distance from p to a node's AABB [m^2]."""
    total = 0.0
    for i in range(3):
        off = max(boxes[node, i] - p[i], 0.0, p[i] - boxes[node, 3 + i])
        total += off * off
    return total


@kernel
def closest_triangle(
    mesh: MeshRecord, vertices: F8, corners: I4, boxes: F8, p: Vec, limit: float, toward: Vec3, out: Vec
) -> int:
    """Triangle closest to p, -1: none is within `limit` [m]; of equally close ones that with p farthest off its plane.

    Arguments as `first_crossing`; out is scratch, shape [3]. Only triangles that face the direction `toward` count
    (unit, mesh frame), or all with `ANY_DIRECTION`.
    """
    found, best = -1, limit * limit
    farthest = 0.0
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
                if square <= best * (1.0 + _EDGE) and _faces(vertices, corners, t, toward, out):
                    off_plane = _plane_distance(vertices, corners, t, p, out)
                    if square < best * (1.0 - _EDGE) or off_plane > farthest:
                        found, farthest = t, off_plane
                    best = min(best, square)
        node = next_node(node)
        if node == 0:
            return found


@kernel
def _faces(vertices: F8, corners: I4, t: int, toward: Vec3, out: Vec) -> bool:
    """Whether a triangle faces a direction; true for ANY_DIRECTION."""
    if toward[0] == 0.0 and toward[1] == 0.0 and toward[2] == 0.0:
        return True
    size = triangle_normal(vertices, corners, t, out)
    return dot(out, toward) > FACING * size


@kernel
def _plane_distance(vertices: F8, corners: I4, t: int, p: Vec, out: Vec) -> float:
    """Distance of p from the plane of a triangle [m]."""
    size = triangle_normal(vertices, corners, t, out)
    first = corners[t, 0]
    total = 0.0
    for i in range(3):
        total += out[i] * (p[i] - vertices[first, i])
    return abs(total) / size
