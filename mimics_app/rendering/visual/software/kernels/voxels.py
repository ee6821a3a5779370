"""Boxes of the triangles in the cells of a grid."""

from __future__ import annotations

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import F4, F8, I4, I8, U4

__all__ = ["bound_clusters", "voxelise"]

_ROUNDING = 1e-6, 1e-15
"""Relative and absolute margin of a test in double precision."""


@kernel
def bound_clusters(vertices: F4, members: I4, starts: I4, boxes: F8) -> None:
    """Compute the boxes of clusters of vertices.

    Args:
        vertices: Position [m] and more of each vertex, [n, >= 3].
        members: Vertices of the first cluster, then those of the second, and so on.
        starts: First member of each cluster, and the number of members, int32 [clusters + 1].
        boxes: Written: least and greatest corner [m], [clusters, 2, 3].
    """
    for cluster in range(boxes.shape[0]):
        boxes[cluster, 0], boxes[cluster, 1] = np.inf, -np.inf
        for member in range(starts[cluster], starts[cluster + 1]):
            for i in range(3):
                place = vertices[members[member], i]
                boxes[cluster, 0, i] = min(boxes[cluster, 0, i], place)
                boxes[cluster, 1, i] = max(boxes[cluster, 1, i], place)


@kernel
def _meets_plane(corners: F8, low: F8, high: F8) -> bool:
    """Whether a box meets the plane of a triangle, [3, 3]."""
    offset = reach = 0.0
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        normal = (corners[1, j] - corners[0, j]) * (corners[2, k] - corners[0, k])
        normal -= (corners[1, k] - corners[0, k]) * (corners[2, j] - corners[0, j])
        offset += normal * (low[i] + high[i] - 2.0 * corners[0, i])
        reach += abs(normal) * (high[i] - low[i])
    return abs(offset) <= reach * (1.0 + _ROUNDING[0]) + _ROUNDING[1]


@kernel
def _extend_cells(corners: F8, low: F8, high: F8, first: I8, last: I8, least: F8, cell: float, cells: F8) -> None:
    """Extend the boxes of the cells from `first` to `last` by what they have of a triangle."""
    below, above = np.empty(3), np.empty(3)
    for x in range(first[0], last[0] + 1):
        for y in range(first[1], last[1] + 1):
            for z in range(first[2], last[2] + 1):
                for i, place in enumerate((x, y, z)):
                    below[i] = low[i] if place == first[i] else least[i] + place * cell
                    above[i] = high[i] if place == last[i] else least[i] + (place + 1) * cell
                if _meets_plane(corners, below, above):
                    box = cells[x, y, z]
                    for i in range(3):
                        box[0, i], box[1, i] = min(box[0, i], below[i]), max(box[1, i], above[i])


@kernel
def voxelise(positions: F4, indices: U4, least: F8, cell: float, cells: F8) -> None:
    """Extend the boxes of a grid's cells by what they have of triangles, or a little more.

    What is beyond the grid, as of a mesh that a program is writing, counts to the cells at its border.

    Args:
        positions: Vertices [m], [n, 3].
        indices: Three per triangle, [m].
        least: Least corner of the grid [m], [3].
        cell: Width of a cell [m].
        cells: Least and greatest corner of what is in each cell [m], [x, y, z, 2, 3]; changed.
    """
    corners, low, high = np.empty((3, 3)), np.empty(3), np.empty(3)
    first, last = np.empty(3, np.int64), np.empty(3, np.int64)
    for triangle in range(indices.shape[0] // 3):
        for corner in range(3):
            corners[corner] = positions[indices[3 * triangle + corner]]
        for i in range(3):
            low[i], high[i] = corners[:, i].min(), corners[:, i].max()
            most = cells.shape[i] - 1
            first[i] = max(0, min(most, int((low[i] - least[i]) / cell)))
            last[i] = max(0, min(most, int((high[i] - least[i]) / cell)))
        _extend_cells(corners, low, high, first, last, least, cell, cells)
