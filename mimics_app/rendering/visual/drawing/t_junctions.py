"""T-junction removal: a vertex that lies on another triangle's edge becomes a vertex of that triangle too.

At a T-junction the pixels along the edge are rounded to different sides, and the background is visible through the
crack here and there; occlusion culling would change what is seen through it.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import F4, F8, I4, I8
from mimics_app.rendering.visual.kernels.solid import points_on_edges
from mimics_app.world.content.meshes.mesh import MeshData

__all__ = ["Sealed", "remove_t_junctions", "unmatched_edges"]


_WELD = 2e-6
"""Distance over the mesh's size within which vertices are welded; float32 rounds to 6e-8."""

_ON_EDGE = 6e-6
"""Distance over the mesh's size within which a vertex lies on an edge."""

_MAX_TESTS = 50_000_000
"""Maximum number of vertices times edges that are tested."""

_OFFSETS = (0.377, 0.711, 0.043)


@dataclass(frozen=True, eq=False)
class Sealed:
    """A mesh without T-junctions.

    Attributes:
        mesh: The original mesh where it had none, else one of the same surface.
        points: Its distinct positions [m], float64 [p, 3].
        triangles: Numbers of points, three different ones per triangle, int32 [n, 3].
        repaired: Number of vertices inserted into edges.
    """

    mesh: MeshData
    points: F8
    triangles: I4
    repaired: int


def remove_t_junctions(mesh: MeshData) -> Sealed | None:
    """Remove a mesh's T-junctions; None where that would take too long."""
    size = float(np.linalg.norm(mesh.bounds[1] - mesh.bounds[0]))
    point_of = _weld(mesh.positions, size * _WELD)
    first = np.unique(point_of, return_index=True)[1]
    points = mesh.positions[first].astype(np.float64)
    vertices = mesh.indices.reshape(-1, 3).astype(np.int64)
    welded = point_of[vertices]
    whole = (welded[:, 0] != welded[:, 1]) & (welded[:, 1] != welded[:, 2]) & (welded[:, 2] != welded[:, 0])
    vertices, welded = vertices[whole], welded[whole]
    open_edges = unmatched_edges(welded)
    candidates = np.unique(open_edges).astype(np.int32)
    if len(open_edges) * len(candidates) > _MAX_TESTS:
        return None
    found = np.empty((4 * len(open_edges) + 16, 3))
    count = points_on_edges(points, open_edges, candidates, size * _ON_EDGE, found)
    if count > len(found):
        return None
    positions = mesh.positions[first][point_of]
    snapped = not np.array_equal(positions, mesh.positions)
    if count == 0 and not snapped:
        return Sealed(mesh, points, welded.astype(np.int32), 0)
    builder = _Splitter(mesh, positions, point_of, found[:count], open_edges)
    split = builder.split(vertices)
    return Sealed(builder.mesh(split), points, builder.points[split].astype(np.int32), count)


def unmatched_edges(triangles: NDArray[np.integer]) -> I4:
    """Return directed edges of triangles without a counterpart in the opposite direction, int32 [e, 2]."""
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]).astype(np.int64)
    if not len(edges):
        return np.zeros((0, 2), np.int32)
    base = int(edges.max()) + 1
    low, high = edges.min(axis=1), edges.max(axis=1)
    key, place = np.unique(low * base + high, return_inverse=True)
    balance = np.zeros(len(key), np.int64)
    np.add.at(balance, place, np.where(edges[:, 0] == low, 1, -1))
    left = np.flatnonzero(balance)
    pairs = np.stack([key[left] // base, key[left] % base], axis=1)
    turned = np.where((balance[left] > 0)[:, None], pairs, pairs[:, ::-1])
    return np.repeat(turned, np.abs(balance[left]), axis=0).astype(np.int32)


class _Splitter:
    """Splits triangles at points on their edges."""

    def __init__(self, mesh: MeshData, positions: F4, points: I8, found: F8, edges: I4) -> None:
        self._source = mesh
        self._parts = [
            [array] for array in (positions, mesh.normals, mesh.uvs, mesh.colours, mesh.second_uvs) if array is not None
        ]
        self._place = {int(point): number for number, point in reversed(list(enumerate(points)))}
        self._known = positions
        self.points = points
        self._count = len(positions)
        self._more: list[int] = []
        self._on: dict[tuple[int, int], list[tuple[float, int]]] = {}
        for edge, point, along in found:
            a, b = edges[int(edge)].tolist()
            self._on.setdefault((a, b), []).append((along, int(point)))
        for inserted in self._on.values():
            inserted.sort()

    def split(self, triangles: I8) -> I8:
        """Return the split triangles [m, 3] of some triangles [n, 3], by numbers of old and new vertices."""
        touched = np.zeros(len(triangles), np.bool_)
        for i, (a, b, c) in enumerate(self.points[triangles].tolist()):
            touched[i] = (a, b) in self._on or (b, c) in self._on or (c, a) in self._on
        made: list[tuple[int, int, int]] = []
        for triangle in triangles[touched].tolist():
            self._split_one(triangle, made)
        self.points = np.concatenate([self.points, np.array(self._more, np.int64)])
        return np.concatenate([triangles[~touched], np.array(made, np.int64).reshape(-1, 3)])

    def mesh(self, triangles: I8) -> MeshData:
        """Return the mesh of split triangles."""
        arrays = iter([np.concatenate(parts) for parts in self._parts])
        positions, normals = next(arrays), next(arrays)
        uvs = next(arrays) if self._source.uvs is not None else None
        colours = next(arrays) if self._source.colours is not None else None
        second = next(arrays) if self._source.second_uvs is not None else None
        return MeshData(positions, normals, triangles.reshape(-1).astype(np.uint32), uvs, colours, second_uvs=second)

    def _split_one(self, triangle: list[int], made: list[tuple[int, int, int]]) -> None:
        """Split a triangle along lines from the vertex opposite an edge with points, until no edge has any."""
        waiting = [self._with_points(triangle)]
        while waiting:
            vertices, inserted = waiting.pop()
            side = next((k for k in range(3) if inserted[k]), None)
            if side is None:
                made.append((vertices[0], vertices[1], vertices[2]))
                continue
            a, b, c = (vertices[(side + k) % 3] for k in range(3))
            row = [a, *inserted[side], b]
            for k, (start, end) in enumerate(itertools.pairwise(row)):
                after = inserted[(side + 1) % 3] if k == len(row) - 2 else []
                before = inserted[(side + 2) % 3] if k == 0 else []
                waiting.append(([start, end, c], [[], after, before]))

    def _with_points(self, triangle: list[int]) -> tuple[list[int], list[list[int]]]:
        """Return the triangle and the new vertices along each of its edges."""
        inserted: list[list[int]] = []
        for k in range(3):
            a, b = triangle[k], triangle[(k + 1) % 3]
            found = self._on.get((int(self.points[a]), int(self.points[b])), [])
            inserted.append([self._add(a, b, along, point) for along, point in found])
        return triangle, inserted

    def _add(self, a: int, b: int, along: float, point: int) -> int:
        """Add a vertex at a point, its other attributes interpolated between both ends; return its number."""
        self._parts[0].append(self._known[self._place[point]][None])
        for parts in self._parts[1:]:
            mixed = (1.0 - along) * parts[0][a] + along * parts[0][b]
            parts.append(mixed[None].astype(np.float32))
        self._more.append(point)
        self._count += 1
        return self._count - 1


def _weld(positions: F4, cell: float) -> I8:
    """Return the number of each vertex's point; vertices nearer to each other than a cell share one."""
    exact, number = np.unique(positions, axis=0, return_inverse=True)
    number = number.reshape(-1).astype(np.int64)
    places = exact.astype(np.float64)
    for offset in _OFFSETS:
        squares = np.floor(places / max(cell, 1e-300) + offset).astype(np.int64)
        _, first, group = np.unique(squares, axis=0, return_index=True, return_inverse=True)
        number, places = group.reshape(-1)[number], places[first]
    return number
