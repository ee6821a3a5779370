"""Edge collapse on arrays: corners (positions) of a surface, wedges (vertices with attributes) at them, and a heap."""

from __future__ import annotations

import heapq
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import F8, I8

__all__ = ["collapse", "farthest"]


Edge = tuple[float, int, int, int, int]
"""Queued collapse: its error [m^2], source corner, target corner, and the stamps of both when it was queued."""

_MIN_COSINE = 0.25
"""Minimum cosine between a triangle's normals before and after a collapse: about 75 degrees, against folds."""

_MAX_RING = 64
"""Maximum triangles about a corner; a corner with more is kept."""

_BALL = 4
"""Components of a bounding ball: centre and radius."""

_VANISHED = 1e-12
"""Square of the share of its area below which a triangle is degenerate."""


class _Surface(NamedTuple):
    """Triangles of a surface, and a list of the slots (3 t + k) about each corner.

    Attributes:
        wedges: Wedges of the triangles, [t, 3].
        corners: Corners of the triangles, [t, 3].
        alive: False for a removed triangle, [t].
        first: First slot of each corner, -1: none, [c].
        following: Next slot of the same corner, -1: none, [3 t].
    """

    wedges: I8
    corners: I8
    alive: NDArray[np.bool_]
    first: I8
    following: I8


@kernel
def _link_corners(corners: I8, first: I8, following: I8) -> None:
    """Link the triangles' slots into one list per corner."""
    for t in range(corners.shape[0]):
        for k in range(3):
            following[3 * t + k] = first[corners[t, k]]
            first[corners[t, k]] = 3 * t + k


@kernel
def collapse(
    places: F8, wedges: I8, corners: I8, quadrics: F8, alive: NDArray[np.bool_], wanted: int, most: float
) -> None:
    """Collapse edges in order of increasing error.

    Args:
        places: Positions of the corners in every pose [m], [p, c, 3]; folds are tested in the first one.
        wedges: Wedges of the triangles, written, [t, 3].
        corners: Corners of the triangles, written, [t, 3].
        quadrics: Quadrics of the corners in every pose, written, [p, c, 11].
        alive: False for a removed triangle, written, [t].
        wanted: Target number of triangles.
        most: Maximum error [m^2].
    """
    first = np.full(places.shape[1], -1, np.int64)
    following = np.full(3 * wedges.shape[0], -1, np.int64)
    stamps = np.zeros(places.shape[1], np.int64)
    rings, pairs = np.empty((2, _MAX_RING), np.int64), np.empty((2, _MAX_RING), np.int64)
    _link_corners(corners, first, following)
    surface = _Surface(wedges, corners, alive, first, following)
    heap = [(0.0, 0, 0, 0, 0) for _ in range(0)]
    for t in range(wedges.shape[0]):
        _push(heap, t, -1, corners, quadrics, places, stamps)
    left = wedges.shape[0]
    while left > wanted and len(heap):
        loss, u, v, stamp_u, stamp_v = heapq.heappop(heap)
        if loss > most:
            break
        if stamps[u] != stamp_u or stamps[v] != stamp_v:
            continue
        gone = _try_collapse(surface, u, v, places[0], rings, pairs)
        if gone == 0:
            continue
        left -= gone
        quadrics[:, v] += quadrics[:, u]
        stamps[u], stamps[v] = -1, stamps[v] + 1
        for t in rings[0, : _ring(surface, v, rings[0])]:
            _push(heap, t, v, corners, quadrics, places, stamps)


@kernel
def _push(heap: list[Edge], t: int, only: int, corners: I8, quadrics: F8, places: F8, stamps: I8) -> None:
    """Queue a triangle's edges in both directions; those of one corner `only`, or all (-1)."""
    for k in range(3):
        u, v = corners[t, k], corners[t, (k + 1) % 3]
        if only in (-1, u, v):
            heapq.heappush(heap, (_loss(quadrics, u, v, places), u, v, stamps[u], stamps[v]))
            heapq.heappush(heap, (_loss(quadrics, v, u, places), v, u, stamps[v], stamps[u]))


@kernel
def _try_collapse(surface: _Surface, u: int, v: int, places: F8, rings: I8, pairs: I8) -> int:
    """Collapse u into v where no triangle folds or tears; return the number of triangles removed, 0 for none."""
    count_u, count_v = _ring(surface, u, rings[0]), _ring(surface, v, rings[1])
    if count_u <= 0 or count_v <= 0:
        return 0
    ring_u, ring_v = rings[0, :count_u], rings[1, :count_v]
    count, gone = _match_wedges(surface, u, v, ring_u, pairs)
    if count == 0 or not _keeps_topology(u, v, gone, surface.corners, ring_u, ring_v):
        return 0
    if not _stay_sound(surface, u, v, places, ring_u, pairs[0, :count]):
        return 0
    _move(surface, u, v, pairs[:, :count])
    return gone


@kernel
def _loss(quadrics: F8, u: int, v: int, places: F8) -> float:
    """Return the mean square distance [m^2] of v from the planes of both corners, in the worst pose."""
    worst = 0.0
    for pose in range(places.shape[0]):
        worst = max(worst, _loss_of_pose(quadrics[pose], u, v, places[pose, v]))
    return worst


@kernel
def _loss_of_pose(quadrics: F8, u: int, v: int, place: F8) -> float:
    x, y, z = place[0], place[1], place[2]
    total = 0.0
    weight = quadrics[u, 10] + quadrics[v, 10]
    if weight <= 0.0:
        return 0.0
    for k in (u, v):
        q = quadrics[k]
        total += q[0] * x * x + q[4] * y * y + q[7] * z * z + q[9]
        total += 2.0 * (q[1] * x * y + q[2] * x * z + q[3] * x + q[5] * y * z + q[6] * y + q[8] * z)
    return max(0.0, total / weight)


@kernel
def _ring(surface: _Surface, corner: int, out: I8) -> int:
    """Write the triangles about a corner and return their number; -1: too many."""
    count = 0
    slot = surface.first[corner]
    while slot >= 0:
        if surface.alive[slot // 3]:
            if count == out.shape[0]:
                return -1
            out[count] = slot // 3
            count += 1
        slot = surface.following[slot]
    return count


@kernel
def _shared_corners(u: int, v: int, corners: I8, ring_u: I8, ring_v: I8) -> int:
    """Return the number of corners that are neighbours of both u and v."""
    shared = 0
    for i in range(ring_u.shape[0]):
        for k in range(3):
            w = corners[ring_u[i], k]
            if w not in (u, v) and _uses(w, corners, ring_u[:i]) == 0:
                shared += _uses(w, corners, ring_v) > 0
    return shared


@kernel
def _uses(corner: int, corners: I8, ring: I8) -> int:
    """Return how many triangles of a ring have a corner."""
    uses = 0
    for t in ring:
        uses += corner in (corners[t, 0], corners[t, 1], corners[t, 2])
    return uses


@kernel
def _turns_over(u: int, v: int, triangle: int, corners: I8, places: F8) -> bool:
    """True when a triangle folds or degenerates as its corner u moves to v."""
    before, after = np.empty((3, 3)), np.empty((3, 3))
    for k in range(3):
        corner = corners[triangle, k]
        for m in range(3):
            before[k, m] = places[corner, m]
            after[k, m] = places[v if corner == u else corner, m]
    old, new = (
        np.cross(before[1] - before[0], before[2] - before[0]),
        np.cross(after[1] - after[0], after[2] - after[0]),
    )
    old2, new2 = (old * old).sum(), (new * new).sum()
    return new2 <= _VANISHED * old2 or (old * new).sum() < _MIN_COSINE * np.sqrt(old2 * new2)


@kernel
def _match_wedges(surface: _Surface, u: int, v: int, ring: I8, pairs: I8) -> tuple[int, int]:
    """Match wedges of u and v in shared triangles; return (pairs written, triangles that u and v share).

    No pairs where one wedge of u would have to become two of v.
    """
    count, gone = 0, 0
    for t in ring:
        old, new = -1, -1
        for k in range(3):
            if surface.corners[t, k] == u:
                old = surface.wedges[t, k]
            if surface.corners[t, k] == v:
                new = surface.wedges[t, k]
        if new < 0:
            continue
        gone += 1
        at = _find(pairs[0, :count], old)
        if at < 0:
            pairs[0, count], pairs[1, count] = old, new
            count += 1
        elif pairs[1, at] != new:
            return 0, gone
    return count, gone


@kernel
def _find(values: I8, wanted: int) -> int:
    """Return the index of a value, -1 where it is missing."""
    for i in range(values.shape[0]):
        if values[i] == wanted:
            return i
    return -1


@kernel
def _stay_sound(surface: _Surface, u: int, v: int, places: F8, ring: I8, olds: I8) -> bool:
    """True when u's remaining triangles have a target wedge and do not fold.

    A wedge without a target ends at a seam: u on a seam moves along the seam only.
    """
    corners = surface.corners
    for t in ring:
        if v in (corners[t, 0], corners[t, 1], corners[t, 2]):
            continue
        for k in range(3):
            if corners[t, k] == u and _find(olds, surface.wedges[t, k]) < 0:
                return False
        if _turns_over(u, v, t, corners, places):
            return False
    return True


@kernel
def _keeps_topology(u: int, v: int, gone: int, corners: I8, ring_u: I8, ring_v: I8) -> bool:
    """Link condition: u and v share as many neighbours as triangles; u on a border moves along it only."""
    if gone == 0 or gone > 2:
        return False
    if _shared_corners(u, v, corners, ring_u, ring_v) != gone:
        return False
    return gone == 2 or _on_border(u, corners, ring_u)


@kernel
def _on_border(u: int, corners: I8, ring: I8) -> bool:
    """True when u's triangles are one open fan."""
    ends = 0
    for t in ring:
        for k in range(3):
            ends += corners[t, k] != u and _uses(corners[t, k], corners, ring) == 1
    return ends == 2


@kernel
def _move(surface: _Surface, u: int, v: int, pairs: I8) -> None:
    """Move u's triangles to v and remove those of both."""
    wedges, corners, first, following = surface.wedges, surface.corners, surface.first, surface.following
    last, slot = -1, first[u]
    while slot >= 0:
        t, k = slot // 3, slot % 3
        if surface.alive[t]:
            if v in (corners[t, 0], corners[t, 1], corners[t, 2]):
                surface.alive[t] = False
            else:
                wedges[t, k] = pairs[1, _find(pairs[0], wedges[t, k])]
                corners[t, k] = v
        last, slot = slot, following[slot]
    following[last] = first[v]
    first[v] = first[u]
    first[u] = -1


@kernel
def farthest(points: F8, triangles: F8) -> float:
    """Return the largest distance [m] of points, [n, 3], from their nearest triangle, [t, 3, 3]."""
    count = triangles.shape[0]
    balls = np.empty((count, _BALL))
    for t in range(count):
        balls[t, 3] = 0.0
        for k in range(3):
            balls[t, k] = (triangles[t, 0, k] + triangles[t, 1, k] + triangles[t, 2, k]) / 3.0
        for k in range(3):
            balls[t, 3] = max(balls[t, 3], _apart(balls[t], triangles[t, k]))
    worst = 0.0
    for i in range(points.shape[0]):
        nearest = np.inf
        for t in range(count):
            if _apart(balls[t], points[i]) - balls[t, 3] < nearest:
                nearest = min(nearest, np.sqrt(_distance2(points[i], triangles[t])))
                if nearest <= worst:
                    break
        worst = max(worst, nearest)
    return worst


@kernel
def _apart(a: F8, b: F8) -> float:
    return float(np.sqrt((a[0] - b[0]) ** 2 + (a[1] - b[1]) ** 2 + (a[2] - b[2]) ** 2))


@kernel
def _distance2(p: F8, triangle: F8) -> float:
    """Return the squared distance [m^2] of a point from a triangle by its regions (Ericson 2005, 5.1.5)."""
    a, b, c = triangle[0], triangle[1], triangle[2]
    ab, ac, ap = b - a, c - a, p - a
    d1, d2 = (ab * ap).sum(), (ac * ap).sum()
    d3, d4 = d1 - (ab * ab).sum(), d2 - (ab * ac).sum()
    d5, d6 = d1 - (ab * ac).sum(), d2 - (ac * ac).sum()
    va, vb, vc = d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2
    if d1 <= 0.0 and d2 <= 0.0:
        s, t = 0.0, 0.0
    elif d3 >= 0.0 and d4 <= d3:
        s, t = 1.0, 0.0
    elif d6 >= 0.0 and d5 <= d6:
        s, t = 0.0, 1.0
    elif vc <= 0.0 and d1 >= 0.0 and d3 <= 0.0:
        s, t = d1 / (d1 - d3), 0.0
    elif vb <= 0.0 and d2 >= 0.0 and d6 <= 0.0:
        s, t = 0.0, d2 / (d2 - d6)
    elif va <= 0.0 and d4 >= d3 and d5 >= d6:
        t = (d4 - d3) / ((d4 - d3) + (d5 - d6))
        s = 1.0 - t
    else:
        s, t = vb / (va + vb + vc), vc / (va + vb + vc)
    away = ap - s * ab - t * ac
    return float((away * away).sum())
