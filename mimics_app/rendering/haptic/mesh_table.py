"""Tables of triangle meshes for the loop: all meshes of a scene with adjacency and bounding-box trees (BVH)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import F8, I4
from mimics_app.rendering.haptic.kernels.objects.records import MESH

__all__ = ["MeshTable", "box_tree", "build_mesh_table", "curve_order", "sharp_sides"]


_LEAF = 4
"""Largest number of triangles per leaf; the average is at least half of it."""

_WELD = 1e-9
"""Grid on which vertices are welded, as a share of the mesh's size."""

_CURVE_BITS = 20
"""Bits per axis of the Morton code."""

_SHARP = 0.94
"""Cosine between the normals of two triangles below which their edge is sharp: 20 degrees."""


class MeshTable(NamedTuple):
    """All meshes of a scene, concatenated; SHAPE.mesh is a row of `rows`.

    Attributes:
        rows: MESH, shape [meshes].
        vertices: Vertices, shape frame [m], shape [vertices, 3].
        corners: Vertex indices of each triangle, counter-clockwise from outside, shape [triangles, 3].
        neighbours: Triangle across the edge from each corner to the next, -1: none, shape [triangles, 3].
        fan_starts: Start of the triangles around each vertex in `fans`, shape [vertices + 1].
        fans: Triangles by vertex, shape [3 triangles].
        boxes: Bounding box of each node of the trees, minimum and maximum [m], shape [nodes, 6].
        hulls: Vertices of the convex hulls of meshes on bodies [m], shape [hull vertices, 3].
        edges: Both ends of the sharp edges of the same meshes [m], shape [edges, 6].
    """

    rows: NDArray[Any]
    vertices: F8
    corners: I4
    neighbours: I4
    fan_starts: I4
    fans: I4
    boxes: F8
    hulls: F8
    edges: F8


def build_mesh_table(meshes: Sequence[tuple[F8, I4]] = (), hulls: Mapping[int, F8] | None = None) -> MeshTable:
    """Build the tables of meshes given as (vertices [m] [n, 3], triangles [m, 3]), in the order of SHAPE.mesh.

    A mesh on a body also needs the vertices of its convex hull [m] [n, 3] in `hulls`, by mesh number, for collisions
    with other bodies.

    Coincident vertices are welded and degenerate triangles dropped; a closed mesh with inward normals is flipped.
    Parts of one mesh must not intersect: make them separate shapes.

    Raises:
        ValueError: A mesh has no triangle with an area, is not finite, refers to a missing vertex, has an edge of three
            triangles, or neighbouring triangles of opposite orientation.
    """
    rows = np.zeros(len(meshes), MESH)
    parts: list[tuple[F8, I4, I4, F8]] = []
    vertex = triangle = node = hull = edge = 0
    sharp: list[F8] = []
    carried = hulls or {}
    for number, (row, (vertices, triangles)) in enumerate(zip(rows, meshes, strict=True)):
        points, corners = _clean(np.asarray(vertices, float), np.asarray(triangles, np.int64))
        corners = corners[curve_order(points[corners].mean(axis=1))]
        neighbours = _neighbours(corners)
        if not (neighbours < 0).any() and _volume(points, corners) < 0.0:
            corners = corners[:, ::-1].copy()
            neighbours = _neighbours(corners)
        boxes = box_tree(points[corners])
        row["first_triangle"], row["triangles"], row["first_node"] = triangle, len(corners), node
        row["leaves"], row["closed"] = (len(boxes) + 1) // 2, not (neighbours < 0).any()
        row["first_hull"], row["hull_corners"] = hull, len(carried.get(number, ()))
        linked = np.where(neighbours < 0, -1, neighbours + triangle)
        parts.append((points, (corners + vertex).astype(np.int32), linked.astype(np.int32), boxes))
        vertex, triangle, node = vertex + len(points), triangle + len(corners), node + len(boxes)
        sharp.append(_sharp_edges(points, corners, neighbours) if number in carried else np.zeros((0, 6)))
        row["first_edge"], row["edges"] = edge, len(sharp[-1])
        hull, edge = hull + int(row["hull_corners"]), edge + len(sharp[-1])
    tips = [np.asarray(carried[number], float).reshape(-1, 3) for number in sorted(carried)]
    ends = np.ascontiguousarray(np.concatenate([np.zeros((0, 6)), *sharp]))
    return _joined(rows, parts, vertex, np.ascontiguousarray(np.concatenate([np.zeros((0, 3)), *tips])), ends)


def _joined(rows: NDArray[Any], parts: list[tuple[F8, I4, I4, F8]], count: int, hulls: F8, edges: F8) -> MeshTable:
    """Concatenate all meshes, with the triangles around each of the `count` vertices."""
    empty = (np.zeros((0, 3)), np.zeros((0, 3), np.int32), np.zeros((0, 3), np.int32), np.zeros((0, 6)))
    vertices, corners, neighbours, boxes = (
        np.ascontiguousarray(np.concatenate(x)) for x in zip(empty, *parts, strict=True)
    )
    of_vertex = corners.ravel()
    fans = np.argsort(of_vertex, kind="stable") // 3
    starts = np.searchsorted(np.sort(of_vertex), np.arange(count + 1))
    fan_starts, of_fans = starts.astype(np.int32), fans.astype(np.int32)
    return MeshTable(rows, vertices, corners, neighbours, fan_starts, of_fans, boxes, hulls, edges)


def _clean(vertices: F8, triangles: NDArray[np.int64]) -> tuple[F8, NDArray[np.int64]]:
    """Weld coincident vertices and drop triangles without area."""
    if not np.isfinite(vertices).all():
        raise ValueError("a vertex of the mesh is not finite")
    if triangles.size and (triangles.min() < 0 or triangles.max() >= len(vertices)):
        wrong = triangles.min() if triangles.min() < 0 else triangles.max()
        raise ValueError(f"a triangle refers to vertex {wrong} of {len(vertices)}")
    if not triangles.size:
        raise ValueError("the mesh has no triangles")
    size = float(np.ptp(vertices[triangles].reshape(-1, 3), axis=0).max())
    cells = np.round((vertices - vertices.min(axis=0)) / max(size * _WELD, 1e-300)).astype(np.int64)
    order = np.lexsort(cells.T)
    new = np.concatenate([[True], (np.diff(cells[order], axis=0) != 0).any(axis=1)])
    joined = np.empty(len(order), np.int64)
    joined[order] = np.cumsum(new) - 1
    points, corners = vertices[order[new]], joined[triangles]
    a, b, c = (points[corners[:, i]] for i in range(3))
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    corners = corners[area > (size * _WELD) ** 2]
    if not len(corners):
        raise ValueError("all triangles of the mesh are degenerate")
    return points, corners


def _neighbours(corners: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return the triangle across the edge from each corner to the next, -1 for none, shape [triangles, 3]."""
    heads, tails = corners.ravel(), np.roll(corners, -1, axis=1).ravel()
    span = int(corners.max()) + 1
    keys = np.minimum(heads, tails) * span + np.maximum(heads, tails)
    order = np.argsort(keys, kind="stable")
    same = keys[order][1:] == keys[order][:-1]
    if (same[1:] & same[:-1]).any():
        raise ValueError("an edge belongs to three triangles: make the parts that meet there separate shapes")
    first, second = order[:-1][same], order[1:][same]
    if (heads[first] == heads[second]).any():
        raise ValueError("two neighbouring triangles have opposite orientations: order all vertices counter-clockwise")
    found = np.full(len(heads), -1, np.int64)
    found[first], found[second] = second // 3, first // 3
    return found.reshape(-1, 3)


def sharp_sides(
    points: F8, corners: NDArray[np.integer], neighbours: NDArray[np.integer]
) -> tuple[NDArray[np.intp], NDArray[np.intp], F8]:
    """Return the convex edges with more than 20 degrees between their faces, each once.

    Args:
        points: Vertices [m], shape [vertices, 3].
        corners: Vertex indices of each triangle, shape [triangles, 3].
        neighbours: Triangle across the edge from each corner to the next, -1: none, shape [triangles, 3].

    Returns:
        (triangle of each edge, its corner at which the edge begins, unit normals of all triangles).
    """
    a, b, c = (points[corners[:, i]] for i in range(3))
    normals = np.cross(b - a, c - a)
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    triangle, side = np.nonzero(neighbours > np.arange(len(corners))[:, None])  # each edge once
    other = neighbours[triangle, side]
    turned = np.einsum("ij,ij->i", normals[triangle], normals[other]) < _SHARP
    begin = points[corners[triangle, side]]
    falls = np.einsum("ij,ij->i", normals[triangle], points[corners[other]].mean(axis=1) - begin) < 0.0
    return triangle[turned & falls], side[turned & falls], normals


def _sharp_edges(points: F8, corners: NDArray[np.int64], neighbours: NDArray[np.int64]) -> F8:
    """Return both ends of the sharp edges of a mesh, shape [edges, 6]."""
    triangle, side, _ = sharp_sides(points, corners, neighbours)
    return np.hstack([points[corners[triangle, side]], points[corners[triangle, (side + 1) % 3]]])


def _volume(points: F8, corners: NDArray[np.int64]) -> float:
    """Return the enclosed volume [m^3], negative for inward normals."""
    a, b, c = (points[corners[:, i]] - points[corners[0, 0]] for i in range(3))
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum()) / 6.0


def curve_order(points: F8) -> NDArray[np.int64]:
    """Return the order of points along a Morton curve, which keeps close points together."""
    low = points.min(axis=0)
    cells = (points - low) / max(float(np.ptp(points, axis=0).max()), 1e-300) * ((1 << _CURVE_BITS) - 1)
    keys = np.zeros(len(points), np.int64)
    for axis in range(3):
        of_axis = cells[:, axis].astype(np.int64)
        for bit in range(_CURVE_BITS):
            keys |= ((of_axis >> bit) & 1) << (3 * bit + axis)
    return np.argsort(keys, kind="stable")


def box_tree(triangles: F8) -> F8:
    """Return the bounding boxes of a binary heap over triangles [n, 3, 3], shape [2 leaves - 1, 6].

    The number of leaves is a power of two and at most n.
    """
    count = len(triangles)
    leaves = 1
    while leaves * _LEAF < count:
        leaves *= 2
    leaves = min(leaves, 1 << (count.bit_length() - 1))
    starts = np.arange(leaves) * count // leaves
    low = np.minimum.reduceat(triangles.min(axis=1), starts)
    high = np.maximum.reduceat(triangles.max(axis=1), starts)
    levels = [np.hstack([low, high])]
    while len(levels[-1]) > 1:
        below = levels[-1]
        low = np.minimum(below[0::2, :3], below[1::2, :3])
        high = np.maximum(below[0::2, 3:], below[1::2, 3:])
        levels.append(np.hstack([low, high]))
    return np.concatenate(levels[::-1])
