"""Coarser forms of a mesh: edges collapsed in the order of what the surface loses by it.

Quadric error metrics of Garland & Heckbert (1997) with half-edge collapses: what is left are corners of the mesh as it
was, with their normals and texture coordinates, so that all levels of detail share one set of vertices. Open borders
and seams of attributes are held in place by planes that stand on them. Of what bends, the loss is the greatest of
several poses (deformation sensitive decimation, Mohr & Gleicher 2003, which adds them up).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import F8, I8
from mimics_app.world.simplify.edge_collapse import collapse, farthest

__all__ = ["Decimated", "decimate"]


_BORDER_WEIGHT = 10.0
"""Of the planes that stand on borders and seams, against those of triangles of the same area."""


_WELD = 1e-6
"""Vertices nearer than this share of the mesh's extent are one corner of it: a few steps of float32."""


@dataclass(frozen=True, eq=False)
class Decimated:
    """A coarser form.

    Attributes:
        indices: Three per triangle, of vertices the mesh had, uint32 [m].
        error: Farthest that a corner of the mesh as it was lies from the coarser surface in any pose [m].
    """

    indices: NDArray[np.uint32]
    error: float

    @property
    def triangle_count(self) -> int:
        """Number of triangles."""
        return len(self.indices) // 3


def decimate(
    positions: NDArray[np.floating],
    indices: NDArray[np.integer],
    triangles: int,
    error: float = np.inf,
    poses: Sequence[NDArray[np.floating]] = (),
) -> Decimated:
    """Take triangles away.

    Vertices at the same place are one corner of the surface; where they differ in anything else there is a seam, which
    is kept.

    Args:
        positions: [m], shape [n, 3].
        indices: Three per triangle, shape [m].
        triangles: Stop when so many or one fewer are left.
        error: Stop before a corner that stays is farther than this from the planes it stands for [m], as root mean
            square; the farthest corner that was taken away can lie several times as far.
        poses: Where the vertices are as well [m], [n, 3] each: what bends must keep its form there too.

    Returns:
        What is left; more triangles than requested where no collapse is left that neither folds nor tears.
    """
    first, corner_of = _weld(np.asarray(positions, np.float64))
    places = np.stack([np.asarray(each, np.float64)[first] for each in (positions, *poses)])
    wedges = np.ascontiguousarray(indices, np.int64).reshape(-1, 3).copy()
    corners = corner_of[wedges]
    sound = (corners[:, 0] != corners[:, 1]) & (corners[:, 1] != corners[:, 2]) & (corners[:, 2] != corners[:, 0])
    wedges, corners = wedges[sound], corners[sound]
    if not len(wedges):
        return Decimated(np.zeros(0, np.uint32), 0.0)
    quadrics = np.stack([_quadrics(each, wedges, corners) for each in places])
    alive = np.ones(len(wedges), np.bool_)
    collapse(places, wedges, corners, quadrics, alive, triangles, error * error)
    away = max(farthest(each, np.ascontiguousarray(each[corners[alive]])) for each in places)
    return Decimated(wedges[alive].reshape(-1).astype(np.uint32), away)


def _weld(positions: F8) -> tuple[I8, I8]:
    """(a vertex of each corner, [c], corner of each vertex, [n]): what rounding keeps apart is one place."""
    extent = float(np.ptp(positions, axis=0).max(initial=0.0)) if len(positions) else 0.0
    cells = np.rint(positions / (_WELD * extent or 1.0)).astype(np.int64)
    _, first, corner_of = np.unique(cells, axis=0, return_index=True, return_inverse=True)
    return first.astype(np.int64), np.ascontiguousarray(corner_of, np.int64).reshape(-1)


def _quadrics(places: F8, wedges: I8, corners: I8) -> F8:
    """Per corner the sum of area x (n, d)(n, d)^T of its planes, 10 numbers, and the sum of the areas; [c, 11]."""
    a, b, c = (places[corners[:, k]] for k in range(3))
    normals = np.cross(b - a, c - a)
    double = np.linalg.norm(normals, axis=1)
    normals /= np.where(double > 0.0, double, 1.0)[:, None]
    quadrics = np.zeros((len(places), 11))
    faces = _planes(normals, a, 0.5 * double)
    for k in range(3):
        np.add.at(quadrics, corners[:, k], faces)
    ends, walls = _walls(places, wedges, corners, normals)
    for end in ends.T:
        np.add.at(quadrics, end, walls)
    return quadrics


def _walls(places: F8, wedges: I8, corners: I8, normals: F8) -> tuple[I8, F8]:
    """(ends [e, 2], quadrics [e, 11]) of planes that stand on edges where triangles do not share both wedges."""
    edges = np.concatenate([wedges[:, [k, (k + 1) % 3]] for k in range(3)])
    at = np.concatenate([corners[:, [k, (k + 1) % 3]] for k in range(3)])
    faces = np.tile(np.arange(len(wedges)), 3)
    key = np.sort(edges, axis=1)
    _, inverse, uses = np.unique(key, axis=0, return_inverse=True, return_counts=True)
    single = uses[inverse.reshape(-1)] != 2
    ends, along = at[single], places[at[single, 1]] - places[at[single, 0]]
    normals = np.cross(along, normals[faces[single]])
    length = np.linalg.norm(normals, axis=1)
    normals /= np.where(length > 0.0, length, 1.0)[:, None]
    areas = _BORDER_WEIGHT * (along * along).sum(axis=1)
    return ends, _planes(normals, places[ends[:, 0]], areas)


def _planes(normals: F8, points: F8, areas: F8) -> F8:
    p = np.concatenate([normals, -(normals * points).sum(axis=1, keepdims=True)], axis=1)
    products = [p[:, i] * p[:, j] for i in range(4) for j in range(i, 4)]
    return np.asarray(np.stack([*products, np.ones(len(p))], axis=1) * areas[:, None])
