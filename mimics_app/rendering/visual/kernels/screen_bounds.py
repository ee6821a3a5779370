"""Rectangles of balls on the screen and in shadow maps."""

from __future__ import annotations

import math

import numpy as np

from mimics_app.contracts.arrays import F8, I4
from mimics_app.contracts.kernel import kernel

__all__ = ["bound_balls", "bound_in_map"]


_TIP = math.sqrt(3.0)
"""Distance of the vertices of the octahedron that circumscribes the unit ball."""

_FIGURES = 10
_LOW_X, _HIGH_X, _LOW_Y, _HIGH_Y, _NEAR, _FAR, _LEFT, _RIGHT, _BOTTOM, _TOP = range(_FIGURES)
"""Indices of a set's bounds: minimum and maximum of x, y and depth in the camera's frame [m], and of x and y on the
screen [tangents]."""


@kernel
def _hold(reached: F8, x: float, y: float, away: float, near: float) -> None:
    """Extend a set's bounds by a point in the camera's frame [m]; on the screen it counts as no nearer than `near`."""
    reached[_LOW_X], reached[_HIGH_X] = min(reached[_LOW_X], x), max(reached[_HIGH_X], x)
    reached[_LOW_Y], reached[_HIGH_Y] = min(reached[_LOW_Y], y), max(reached[_HIGH_Y], y)
    reached[_NEAR], reached[_FAR] = min(reached[_NEAR], away), max(reached[_FAR], away)
    depth = max(away, near)
    reached[_LEFT], reached[_RIGHT] = min(reached[_LEFT], x / depth), max(reached[_RIGHT], x / depth)
    reached[_BOTTOM], reached[_TOP] = min(reached[_BOTTOM], y / depth), max(reached[_TOP], y / depth)


@kernel
def _hold_ball(reached: F8, x: float, y: float, away: float, radius: float, near: float) -> None:
    """Extend a set's bounds by a ball, by the vertices of its circumscribed octahedron."""
    if radius == 0.0:
        _hold(reached, x, y, away, near)
        return
    tip = _TIP * radius
    _hold(reached, x - tip, y, away, near)
    _hold(reached, x + tip, y, away, near)
    _hold(reached, x, y - tip, away, near)
    _hold(reached, x, y + tip, away, near)
    _hold(reached, x, y, away - tip, near)
    _hold(reached, x, y, away + tip, near)


@kernel
def _widen(reached: F8, near: float) -> None:
    """Set the screen bounds of a set that crosses the near plane, from its box at the near plane and at its far end."""
    far = reached[_FAR]
    reached[_LEFT] = min(reached[_LOW_X] / near, reached[_LOW_X] / far)
    reached[_RIGHT] = max(reached[_HIGH_X] / near, reached[_HIGH_X] / far)
    reached[_BOTTOM] = min(reached[_LOW_Y] / near, reached[_LOW_Y] / far)
    reached[_TOP] = max(reached[_HIGH_Y] / near, reached[_HIGH_Y] / far)


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
    pose, reached, count = world_from_eye, np.zeros(_FIGURES), 0
    for i in range(points.shape[0]):
        reached[::2], reached[1::2] = np.inf, -np.inf
        for j in range(points.shape[1]):
            x, y, z = points[i, j, 0] - pose[0, 3], points[i, j, 1] - pose[1, 3], points[i, j, 2] - pose[2, 3]
            across = x * pose[0, 0] + y * pose[1, 0] + z * pose[2, 0]
            up = x * pose[0, 1] + y * pose[1, 1] + z * pose[2, 1]
            away = -(x * pose[0, 2] + y * pose[1, 2] + z * pose[2, 2])
            _hold_ball(reached, across, up, away, radii[i], near)
        if reached[_FAR] < near:
            continue
        if reached[_NEAR] < near:
            _widen(reached, near)
        bounds[count, 0], bounds[count, 1] = reached[_LEFT] - left, reached[_RIGHT] - left
        bounds[count, 2], bounds[count, 3] = reached[_BOTTOM] - bottom, reached[_TOP] - bottom
        bounds[count, :2] /= right - left
        bounds[count, 2:] /= top - bottom
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
