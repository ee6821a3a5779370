"""Ridges of triangle meshes: maximal straight sharp edges, with a bounding-box tree per mesh.

A static mesh may have any number of ridges, which are therefore found through a tree.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import F8
from mimics_app.rendering.haptic.kernels.objects.records import RIDGES
from mimics_app.rendering.haptic.mesh_table import MeshTable, box_tree, curve_order, sharp_sides

__all__ = ["RidgeTable", "build_ridge_table"]


_STRAIGHT = 1e-6
"""Sine of the angle below which two adjacent edges, and their faces, form one ridge."""


class RidgeTable(NamedTuple):
    """All ridges of a scene's meshes, concatenated by mesh.

    Attributes:
        rows: RIDGES, shape [meshes].
        lines: Both ends, shape frame [m], unit direction outward between the two faces, and for each end 1 where this
            ridge represents the vertex there (each vertex is represented once); shape [ridges, 11].
        boxes: Bounding box of each node of the trees, minimum and maximum [m], shape [nodes, 6].
    """

    rows: NDArray[Any]
    lines: F8
    boxes: F8


def build_ridge_table(meshes: MeshTable) -> RidgeTable:
    """Find the ridges of all meshes: convex edges with more than 20 degrees between their faces."""
    rows = np.zeros(len(meshes.rows), RIDGES)
    lines, boxes = [np.zeros((0, 11))], [np.zeros((0, 6))]
    line = node = 0
    for row, mesh in zip(rows, meshes.rows, strict=True):
        first, last = int(mesh["first_triangle"]), int(mesh["first_triangle"] + mesh["triangles"])
        neighbours = meshes.neighbours[first:last]
        found = _ridges(meshes.vertices, meshes.corners[first:last], np.where(neighbours < 0, -1, neighbours - first))
        row["first_ridge"], row["ridges"], row["first_node"] = line, len(found), node
        if not len(found):
            continue
        found = found[curve_order(0.5 * (found[:, 0:3] + found[:, 3:6]))]
        tree = box_tree(found[:, [0, 1, 2, 3, 4, 5, 3, 4, 5]].reshape(-1, 3, 3))
        row["leaves"] = (len(tree) + 1) // 2
        lines.append(found)
        boxes.append(tree)
        line, node = line + len(found), node + len(tree)
    return RidgeTable(rows, np.concatenate(lines), np.concatenate(boxes))


def _ridges(points: F8, corners: NDArray[Any], neighbours: NDArray[Any]) -> F8:
    """Return the rows of `RidgeTable.lines` of one mesh, ordered by their first triangles."""
    triangle, side, normals = sharp_sides(points, corners, neighbours)
    heads, tails = corners[triangle, side], corners[triangle, (side + 1) % 3]
    outward = normals[triangle] + normals[neighbours[triangle, side]]
    size = np.linalg.norm(outward, axis=1)
    outward /= np.where(size > 0.0, size, 1.0)[:, None]
    found: list[F8] = []
    represented: set[int] = set()
    for k, head, tail in _straight_runs(points, heads.tolist(), tails.tolist(), outward):
        own = [float(end not in represented) for end in (head, tail)]
        represented.update((head, tail))
        found.append(np.concatenate([points[head], points[tail], outward[k], own]))
    return np.array(found).reshape(-1, 11)


def _straight_runs(points: F8, heads: list[int], tails: list[int], outward: F8) -> Iterator[tuple[int, int, int]]:
    """Yield (one of its edges, vertex at one end, vertex at the other) of each straight run of edges."""
    directions = points[tails] - points[heads]
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    at: dict[int, list[int]] = {}
    for k, ends in enumerate(zip(heads, tails, strict=True)):
        for vertex in ends:
            at.setdefault(vertex, []).append(k)
    through = {vertex: pair for vertex, pair in at.items() if _is_straight(pair, directions, outward)}
    seen = [False] * len(heads)
    for k, ends in enumerate(zip(heads, tails, strict=True)):
        if not seen[k]:
            seen[k] = True
            first, last = (_follow(k, vertex, through, heads, tails, seen) for vertex in ends)
            yield k, first, last


def _is_straight(pair: list[int], directions: F8, outward: F8) -> bool:
    """Whether exactly two edges meet at a vertex and form one ridge."""
    if len(pair) != 2:
        return False
    one, two = pair
    bend, roll = np.cross(directions[one], directions[two]), np.cross(outward[one], outward[two])
    return bool(np.linalg.norm(bend) < _STRAIGHT and np.linalg.norm(roll) < _STRAIGHT)


def _follow(
    k: int, vertex: int, through: dict[int, list[int]], heads: list[int], tails: list[int], seen: list[bool]
) -> int:
    """Return the end vertex of the straight run that leaves edge k over `vertex`; its edges are marked as seen."""
    while vertex in through:
        one, two = through[vertex]
        k = two if one == k else one
        seen[k] = True
        vertex = tails[k] if heads[k] == vertex else heads[k]
    return vertex
