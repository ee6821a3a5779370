"""Mesh decimation by edge collapses in order of their error.

Quadric error metrics of Garland & Heckbert (1997) with half-edge collapses: the vertices left are vertices of the
original mesh, with their normals and texture coordinates, so that all levels of detail share one set of vertices.
Planes perpendicular to the surface hold open borders and seams of attributes in place. The error of a deformable mesh
is the largest of several poses (deformation sensitive decimation, Mohr & Gleicher 2003, which adds them).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import F8, I8
from mimics_app.world.files.simplify.edge_collapse import collapse, farthest

__all__ = ["Decimated", "decimate"]


_BORDER_WEIGHT = 10.0
"""Weight of the planes on borders and seams, against those of triangles of the same area."""


_WELD = 1e-6
"""Weld distance over the mesh's extent, a few steps of float32: nearer vertices are one corner of the surface."""


@dataclass(frozen=True, eq=False)
class Decimated:
    """A decimated mesh.

    Attributes:
        indices: Three per triangle, into the original vertices, uint32 [m].
        error: Largest distance of an original vertex from the decimated surface in any pose [m].
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
    """Decimate a mesh.

    Vertices at the same position are one corner of the surface; where other attributes differ there is a seam, which is
    kept.

    Args:
        positions: [m], shape [n, 3].
        indices: Three per triangle, shape [m].
        triangles: Target number of triangles; one fewer may be left.
        error: Maximum root mean square distance of a remaining corner from the planes it represents [m]; the largest
            distance of a removed one can be several times as large.
        poses: Positions of the vertices in further poses [m], [n, 3] each, whose error counts as well.

    Returns:
        The decimated mesh; with more triangles than requested where every further collapse folds or tears it.
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
    """Return (a vertex of each corner, [c]; corner of each vertex, [n]) of positions equal up to rounding."""
    extent = float(np.ptp(positions, axis=0).max(initial=0.0)) if len(positions) else 0.0
    cells = np.rint(positions / (_WELD * extent or 1.0)).astype(np.int64)
    _, first, corner_of = np.unique(cells, axis=0, return_index=True, return_inverse=True)
    return first.astype(np.int64), np.ascontiguousarray(corner_of, np.int64).reshape(-1)


def _quadrics(places: F8, wedges: I8, corners: I8) -> F8:
    """Return for each corner the sum of area x (n, d)(n, d)^T of its planes, 10 numbers, and of the areas; [c, 11]."""
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
    """Return (ends [e, 2], quadrics [e, 11]) of planes on edges whose triangles do not share both wedges."""
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
