"""Cut of a closed mesh by the plane of a leg: the polygon that the foot meets (equation (4) of D2.1 for a mesh)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import F8
from mimics_app.rendering.haptic.control.lokomat.sagittal_outline import EDGES

__all__ = ["cut_mesh", "polygon_fault"]

_WELD = 1e-7
"""Largest distance of vertices that are one [m]."""

_STRAIGHT = 1e-6
"""Largest distance of a vertex from the line through its neighbours that is left out [m]."""

_THINNEST = 1e-3
"""Shortest edge that is left of a polygon within its rounding [m]."""


def cut_mesh(vertices: F8, faces: NDArray[np.integer], y: float) -> F8:
    """Return the polygon in which a plane cuts a closed mesh, without vertices on straight lines.

    Args:
        vertices: Shape [n, 3], x forward, y to the left, z up [m].
        faces: Shape [m, 3], counter-clockwise from outside.
        y: Plane of the leg [m].

    Returns:
        x and z of its vertices [m], shape [k, 2], in an order that has the object on the right.

    Raises:
        ValueError: The plane misses the mesh, the mesh is not closed there, or the cut has several parts.
    """
    _, welded = np.unique(np.round(np.asarray(vertices, np.float64) / _WELD), axis=0, return_inverse=True)
    following: dict[tuple[int, int], tuple[int, int]] = {}
    points: dict[tuple[int, int], F8] = {}
    for face in faces:
        ends = _crossings(np.asarray(vertices, np.float64)[face], welded.reshape(-1)[face], y)
        if ends is None:
            continue
        (start, first), (end, last) = ends
        if start in following:
            raise ValueError("the mesh is not closed, or its faces are not all turned outwards")
        following[start], points[start], points[end] = end, first, last
    if not following:
        raise ValueError(f"the plane of the leg, at y = {y:.3g} m, misses it")
    if set(following) != set(following.values()):
        raise ValueError("the mesh is not closed")
    loop = [next(iter(following))]
    while (step := following[loop[-1]]) != loop[0]:
        loop.append(step)
    if len(loop) < len(following):
        raise ValueError("the plane of the leg cuts it in several parts")
    return _without_straight(np.array([points[key] for key in loop]))


def _crossings(corners: F8, numbers: NDArray[np.integer], y: float) -> list[tuple[tuple[int, int], F8]] | None:
    """Return where a face crosses the plane, by its edge: first where the cut enters it, then where it leaves."""
    above = corners[:, 1] - y
    found = []
    for a, b in ((0, 1), (1, 2), (2, 0)):
        if (above[a] < 0.0) == (above[b] < 0.0):
            continue
        low, high = (a, b) if numbers[a] < numbers[b] else (b, a)  # the same point from both faces of an edge
        share = above[low] / (above[low] - above[high])
        place = corners[low] + share * (corners[high] - corners[low])
        found.append((above[b] >= 0.0, ((int(numbers[low]), int(numbers[high])), place[[0, 2]])))
    if not found:
        return None
    # Counter-clockwise from outside, the edge that rises to larger y is where the cut leaves with the object right.
    (_, first), (_, second) = sorted(found, key=lambda each: each[0])
    return [first, second]


def _without_straight(polygon: F8) -> F8:
    """Return a polygon without vertices that lie on the line through their neighbours."""
    kept, i = [np.array(point) for point in polygon], 0
    while i < len(kept) and len(kept) > 3:
        before, point, after = kept[i - 1], kept[i], kept[(i + 1) % len(kept)]
        along, own = after - before, point - before
        off = abs(float(along[0] * own[1] - along[1] * own[0]))
        if off <= _STRAIGHT * float(np.hypot(*along)) or np.hypot(*own) <= _STRAIGHT:
            del kept[i]
        else:
            i += 1
    return np.array(kept)


def polygon_fault(polygon: F8, rounding: float) -> str:
    """Return why a polygon is no outline of a hard object, in a sentence without a subject; "" where it is one.

    Args:
        polygon: x and z of its vertices [m], shape [k, 2], in either order.
        rounding: Radius of its edges [m].
    """
    count = len(polygon)
    if count < 3:
        return "has fewer than three corners"
    if count > EDGES:
        return f"has {count} corners; a hard object has at most {EDGES}: simplify it"
    edges = [(polygon[i], polygon[(i + 1) % count]) for i in range(count)]
    for i in range(count):
        for j in range(i + 2, count - (1 if i == 0 else 0)):
            if _cross(*edges[i], *edges[j]):
                return "crosses itself"
    if _shortest_within(polygon, rounding) < _THINNEST:
        return f"is too small or too sharp for a rounding of {rounding:g} m"
    return ""


def _cross(a: F8, b: F8, c: F8, d: F8) -> bool:
    """Whether two segments cross."""

    def side(p: F8, q: F8, r: F8) -> float:
        return float((q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]))

    return side(a, b, c) * side(a, b, d) <= 0.0 and side(c, d, a) * side(c, d, b) <= 0.0


def _shortest_within(polygon: F8, rounding: float) -> float:
    """Return the length of the shortest edge that is left within a rounding [m], negative where one is turned."""
    along = np.roll(polygon, -1, axis=0) - polygon
    length = np.hypot(along[:, 0], along[:, 1])
    along = along / length[:, None]
    before = np.roll(along, 1, axis=0)
    turned = np.arctan2(before[:, 0] * along[:, 1] - before[:, 1] * along[:, 0], (before * along).sum(axis=1))
    lost = rounding * np.abs(np.tan(0.5 * turned)) * np.where(turned * turned.sum() > 0.0, 1.0, -1.0)
    return float((length - lost - np.roll(lost, -1)).min())
