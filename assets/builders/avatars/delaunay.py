"""Delaunay triangulation of points of a plane (Bowyer 1981, Watson 1981).

A face has points on common circles: scipy chooses the other diagonal there, in 2 to 6 of 541 triangles, and the shipped
people would change with it.
"""

from __future__ import annotations

import numpy as np

from assets.builders.avatars.fields import F8
from assets.builders.avatars.sheet import I8

__all__ = ["triangulate"]

_FAR = 50.0
"""Size of the first, enclosing triangle, in extents of the points."""


def triangulate(points: F8) -> I8:
    """Return the Delaunay triangles [m, 3] of points [n, 2], counter-clockwise."""
    centre, extent = points.mean(axis=0), float(np.ptp(points, axis=0).max())
    outer = centre + _FAR * extent * np.array([[-1.0, -1.0], [1.0, -1.0], [0.0, 1.4]])
    places = np.vstack([points, outer])
    count = len(points)
    corners = np.array([[count, count + 1, count + 2]])
    circles = _circles(places, corners)
    for new in range(count):
        away = ((places[new] - circles[:, :2]) ** 2).sum(axis=1)
        hit = away < circles[:, 2] * (1.0 - 1e-12)
        edges = np.vstack([corners[hit][:, pair] for pair in ((0, 1), (1, 2), (2, 0))])
        known = {(int(a), int(b)) for a, b in edges}
        rim = np.array([(a, b, new) for a, b in sorted(known) if (b, a) not in known])
        corners = np.vstack([corners[~hit], rim])
        circles = np.vstack([circles[~hit], _circles(places, rim)])
    result: I8 = corners[(corners < count).all(axis=1)]
    return result


def _circles(places: F8, corners: I8) -> F8:
    """Return centre and squared radius of the circumscribed circle of each triangle, [m, 3]."""
    a, b, c = (places[corners[:, i]] for i in range(3))
    b, c = b - a, c - a
    twice = 2.0 * (b[:, 0] * c[:, 1] - b[:, 1] * c[:, 0])
    twice = np.where(np.abs(twice) < 1e-18, 1e-18, twice)
    bb, cc = (b * b).sum(axis=1), (c * c).sum(axis=1)
    x = (c[:, 1] * bb - b[:, 1] * cc) / twice
    y = (b[:, 0] * cc - c[:, 0] * bb) / twice
    return np.stack([a[:, 0] + x, a[:, 1] + y, x * x + y * y], axis=1)
