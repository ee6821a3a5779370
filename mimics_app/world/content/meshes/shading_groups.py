"""Normals for triangles without any: smooth across edges below the crease angle, split at sharper ones."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import F8, I8
from mimics_app.world.content.meshes.mesh import MeshData

__all__ = ["shaded_mesh"]


_CREASE = math.radians(40.0)
"""Crease angle between two faces [rad], from which their edge is sharp."""


def shaded_mesh(vertices: F8, faces: I8, colours: NDArray[np.float32] | None = None) -> MeshData:
    """Return a mesh with smooth and creased normals.

    Faces that meet in a smooth edge share its vertices; a vertex on a sharp edge is split.

    Args:
        vertices: Positions [m], [n, 3]; equal ones are welded.
        faces: Indices, [m, 3]; degenerate faces are left out.
        colours: Linear RGBA per vertex, [n, 4], or None.
    """
    points, merged = np.unique(vertices, axis=0, return_inverse=True)
    welded = merged.reshape(-1)[faces]
    corners = points[welded]
    areas = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(areas, axis=1)
    kept = lengths > 0.0
    faces, welded, areas = faces[kept], welded[kept], areas[kept]
    labels = _smooth_corners(welded, areas / lengths[kept, None])
    _, first, indices = np.unique(labels, return_index=True, return_inverse=True)
    normals = np.zeros((len(first), 3))
    np.add.at(normals, indices.reshape(-1), np.repeat(areas, 3, axis=0))
    sizes = np.linalg.norm(normals, axis=1, keepdims=True)
    normals = np.where(sizes > 0.0, normals / np.where(sizes > 0.0, sizes, 1.0), (0.0, 1.0, 0.0))
    source = faces.reshape(-1)[first]
    return MeshData(
        vertices[source].astype(np.float32),
        normals.astype(np.float32),
        indices.reshape(-1).astype(np.uint32),
        colours=None if colours is None else colours[source],
    )


def _smooth_corners(welded: I8, normals: F8) -> I8:
    """Return the smoothing group of each face corner, [3 m]."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    joined, count = _smooth_pairs(welded, normals), welded.size
    links = coo_array((np.ones(len(joined), np.bool_), (joined[:, 0], joined[:, 1])), (count, count))
    groups: I8 = connected_components(links, directed=False)[1]
    return groups


def _smooth_pairs(welded: I8, normals: F8) -> I8:
    """Return pairs of face corners at one end of a smooth edge between neighbours, [k, 2]."""
    count = len(welded)
    face = np.tile(np.arange(count), 3)
    begin = np.concatenate([np.arange(count) * 3 + side for side in range(3)])
    end = np.concatenate([np.arange(count) * 3 + (side + 1) % 3 for side in range(3)])
    flat = welded.reshape(-1)
    ends = np.sort(np.stack([flat[begin], flat[end]], axis=1), axis=1)
    order = np.lexsort((ends[:, 1], ends[:, 0]))
    same = np.all(ends[order[1:]] == ends[order[:-1]], axis=1)
    one, two = order[:-1][same], order[1:][same]
    smooth = np.einsum("ij,ij->i", normals[face[one]], normals[face[two]]) > math.cos(_CREASE)
    one, two = one[smooth], two[smooth]
    # Neighbours run along their edge in opposite directions, unless one of them is flipped.
    along = flat[begin[one]] == flat[begin[two]]
    first = np.where(along, begin[two], end[two])
    second = np.where(along, end[two], begin[two])
    return np.concatenate([np.stack([begin[one], first], 1), np.stack([end[one], second], 1)])
