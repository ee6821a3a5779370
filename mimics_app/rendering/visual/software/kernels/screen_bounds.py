"""Rectangles of balls on the screen and in shadow maps."""

from __future__ import annotations

import math

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import F8, I4

__all__ = ["bound_balls", "bound_in_map"]


_TIPS = math.sqrt(3.0) * np.vstack([np.eye(3), -np.eye(3)])
"""Vertices of the octahedron that circumscribes the unit ball, [6, 3]."""


@kernel
def _bound_from_box(points: F8, radius: float, pose: F8, near: float, bounds: F8) -> None:
    """Compute the bounds of a set that crosses the near plane, from its box at the near plane and at its far end.

    Args:
        points: Centres of its balls, world [m], [k, 3].
        radius: Their radius [m].
        pose: T_world_from_eye, [4, 4].
        near: Distance of the near plane [m].
        bounds: Written: left, right, bottom, top [tangents], [4].
    """
    tip, low, high = _TIPS[0, 0] * radius, np.full(3, np.inf), np.full(3, -np.inf)
    for point in points:
        for k in range(3):
            at = 0.0
            for r in range(3):
                at += (point[r] - pose[r, 3]) * pose[r, k]
            low[k], high[k] = min(low[k], at - tip), max(high[k], at + tip)
    for k in range(2):
        bounds[2 * k] = min(low[k] / near, low[k] / -low[2])
        bounds[2 * k + 1] = max(high[k] / near, high[k] / -low[2])


@kernel
def _bound_set(points: F8, radius: float, pose: F8, near: float, bounds: F8) -> bool:
    """Compute the bounds of a set, see `_bound_from_box`; return False where it is behind the near plane."""
    left = bottom = nearest = np.inf
    right = top = farthest = -np.inf
    for j in range(points.shape[0]):
        x, y, z = points[j, 0] - pose[0, 3], points[j, 1] - pose[1, 3], points[j, 2] - pose[2, 3]
        across = x * pose[0, 0] + y * pose[1, 0] + z * pose[2, 0]
        up = x * pose[0, 1] + y * pose[1, 1] + z * pose[2, 1]
        away = -(x * pose[0, 2] + y * pose[1, 2] + z * pose[2, 2])
        for tip in range(_TIPS.shape[0] if radius > 0.0 else 1):
            depth = away + radius * _TIPS[tip, 2]
            nearest, farthest = min(nearest, depth), max(farthest, depth)
            scale = 1.0 / max(depth, near)
            x, y = (across + radius * _TIPS[tip, 0]) * scale, (up + radius * _TIPS[tip, 1]) * scale
            left, right, bottom, top = min(left, x), max(right, x), min(bottom, y), max(top, y)
    bounds[0], bounds[1], bounds[2], bounds[3] = left, right, bottom, top
    if nearest < near <= farthest:
        _bound_from_box(points, radius, pose, near, bounds)
    return farthest >= near


@kernel
def bound_balls(points: F8, radii: F8, world_from_eye: F8, tangents: F8, near: float, bounds: F8) -> int:
    """Compute screen rectangles of the convex hulls of sets of balls; hulls behind the near plane are left out.

    Args:
        points: Centres of each set's balls, world [m], [n, k, 3].
        radii: Radius of each set's balls [m], [n].
        world_from_eye: Pose of the camera, [4, 4].
        tangents: Tangents of the picture's edges: left, right, bottom, top.
        near: Distance of the near plane [m].
        bounds: Written: left, right, bottom, top as shares of the picture, [>= n, 4].

    Returns:
        Number of rectangles.
    """
    left, right, bottom, top = tangents
    count = 0
    for i in range(points.shape[0]):
        own = bounds[count]
        if _bound_set(points[i], radii[i], world_from_eye, near, own):
            own[0], own[1] = (own[0] - left) / (right - left), (own[1] - left) / (right - left)
            own[2], own[3] = (own[2] - bottom) / (top - bottom), (own[3] - bottom) / (top - bottom)
            count += 1
    return count


@kernel
def bound_in_map(clip_from_world: F8, items: I4, centres: F8, radii: F8, bounds: F8) -> None:
    """Write the rectangle that each of some balls covers in an orthographic map.

    Args:
        clip_from_world: Projection of the map, [4, 4].
        items: Numbers of the balls, [k].
        centres: Centres of all balls, world [m], [n, 3].
        radii: Their radii [m], [n].
        bounds: Written: left, right, bottom, top as shares of the map, [k, 4].
    """
    for axis in range(2):
        row = clip_from_world[axis]
        stretch = math.sqrt(row[0] ** 2 + row[1] ** 2 + row[2] ** 2)
        for number, item in enumerate(items):
            at = row[0] * centres[item, 0] + row[1] * centres[item, 1] + row[2] * centres[item, 2] + row[3]
            bounds[number, 2 * axis] = 0.5 * (at - stretch * radii[item] + 1.0)
            bounds[number, 2 * axis + 1] = 0.5 * (at + stretch * radii[item] + 1.0)
