"""Normals for triangles that came without any: smooth over gentle edges, creased at sharp ones."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import F8, I8
from mimics_app.world.meshes.mesh import MeshData

__all__ = ["CREASE", "shaded_mesh"]


CREASE = math.radians(40.0)
"""Angle between two faces from which their edge is seen as an edge."""


def shaded_mesh(vertices: F8, faces: I8, colours: NDArray[np.float32] | None = None) -> MeshData:
    """Triangles with normals of their own.

    Corners of faces that meet in a gentle edge share a vertex; a vertex on a sharp edge is split.

    Args:
        vertices: [m], [n, 3]; equal ones are taken as one.
        faces: Three per triangle, [m, 3]; faces without area are left out.
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
    names, indices = np.unique(labels, return_inverse=True)
    normals = np.zeros((len(names), 3))
    np.add.at(normals, indices.reshape(-1), np.repeat(areas, 3, axis=0))
    sizes = np.linalg.norm(normals, axis=1, keepdims=True)
    normals = np.where(sizes > 0.0, normals / np.where(sizes > 0.0, sizes, 1.0), (0.0, 1.0, 0.0))
    source = faces.reshape(-1)[names]
    return MeshData(
        vertices[source].astype(np.float32),
        normals.astype(np.float32),
        indices.reshape(-1).astype(np.uint32),
        colours=None if colours is None else colours[source],
    )


def _smooth_corners(welded: I8, normals: F8) -> I8:
    """Number of the first corner of each corner's group, [3 m]: what is joined over gentle edges."""
    count = len(welded)
    labels = np.arange(3 * count)
    joined = _gentle_pairs(welded, normals)
    while len(joined):
        least = np.minimum(labels[joined[:, 0]], labels[joined[:, 1]])
        before = labels.copy()
        np.minimum.at(labels, joined[:, 0], least)
        np.minimum.at(labels, joined[:, 1], least)
        labels = labels[labels]
        if np.array_equal(before, labels):
            break
    return labels


def _gentle_pairs(welded: I8, normals: F8) -> I8:
    """Pairs of corners of neighbouring faces that stand at one end of a gentle edge, [k, 2]."""
    count = len(welded)
    face = np.tile(np.arange(count), 3)
    begin = np.concatenate([np.arange(count) * 3 + side for side in range(3)])
    end = np.concatenate([np.arange(count) * 3 + (side + 1) % 3 for side in range(3)])
    flat = welded.reshape(-1)
    ends = np.sort(np.stack([flat[begin], flat[end]], axis=1), axis=1)
    order = np.lexsort((ends[:, 1], ends[:, 0]))
    same = np.all(ends[order[1:]] == ends[order[:-1]], axis=1)
    one, two = order[:-1][same], order[1:][same]
    gentle = np.einsum("ij,ij->i", normals[face[one]], normals[face[two]]) > math.cos(CREASE)
    one, two = one[gentle], two[gentle]
    # Neighbours run along their edge in opposite directions, unless one of them is turned over.
    along = flat[begin[one]] == flat[begin[two]]
    first = np.where(along, begin[two], end[two])
    second = np.where(along, end[two], begin[two])
    return np.concatenate([np.stack([begin[one], first], 1), np.stack([end[one], second], 1)])
