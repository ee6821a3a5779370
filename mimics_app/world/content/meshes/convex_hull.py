"""Convex hull of points in space."""

from __future__ import annotations

import numpy as np

from mimics_app.contracts.arrays import F8, I4

__all__ = ["convex_hull"]


_FLAT = 1e-7
"""Thickness up to which points count as coplanar, as a share of their extent."""


def convex_hull(points: F8) -> tuple[F8, I4]:
    """Return vertices and triangles of the convex hull (Barber, Dobkin & Huhdanpaa 1996, by Qhull).

    Args:
        points: [m], shape [n, 3].

    Returns:
        (vertices [m], shape [k, 3]; indices, counter-clockwise from outside, shape [m, 3]).

    Raises:
        ValueError: A coordinate is not finite, or all points lie in one plane, within their precision.
    """
    from scipy.spatial import ConvexHull, QhullError

    points = np.unique(np.asarray(points, np.float64), axis=0)
    if not np.isfinite(points).all():
        raise ValueError("a coordinate of a point is not finite")
    if len(points) < 4:
        raise ValueError(f"{len(points)} different points do not span a solid")
    centred = points - points.mean(axis=0)
    thinnest = np.linalg.svd(centred, full_matrices=False)[2][2]
    if np.ptp(centred @ thinnest) <= _FLAT * np.ptp(points, axis=0).max():
        raise ValueError("all points lie in one plane")
    try:
        hull = ConvexHull(points)
    except QhullError as error:  # so far from the origin that their digits do not tell
        raise ValueError("all points lie in one plane") from error
    p, q, r = (points[hull.simplices[:, k]] for k in range(3))
    inward = np.einsum("ij,ij->i", np.cross(q - p, r - p), hull.equations[:, :3]) < 0.0
    faces = np.where(inward[:, None], hull.simplices[:, ::-1], hull.simplices)
    used, indices = np.unique(faces, return_inverse=True)
    return points[used], indices.reshape(-1, 3).astype(np.int32)
