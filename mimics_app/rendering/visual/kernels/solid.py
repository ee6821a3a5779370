"""Inside of a closed surface: cells that no triangle touches, winding numbers, and the best box of such cells."""

from __future__ import annotations

import math

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import F8, I4, U1

__all__ = ["find_best_box", "grow_box", "label_cells", "mark_cells", "points_on_edges", "winding_number"]


_BISECTIONS = 10

_CORNERS, _SIDES = 8, 6
"""Corners and faces of a box."""


@kernel
def points_on_edges(points: F8, edges: I4, candidates: I4, tolerance: float, found: F8) -> int:
    """Find the points that lie on edges between their ends, within a tolerance.

    Args:
        points: Positions [m], [n, 3].
        edges: Numbers of two points each, [e, 2].
        candidates: Numbers of the points to test, [c].
        tolerance: Maximum distance from the edge, and minimum distance from its ends [m].
        found: Written: edge, point, parameter along the edge (0 to 1); [rows, 3].

    Returns:
        Number of points found; one more than `found` has rows when there are more.
    """
    count = 0
    for e in range(edges.shape[0]):
        a, b = edges[e, 0], edges[e, 1]
        dx, dy, dz = points[b, 0] - points[a, 0], points[b, 1] - points[a, 1], points[b, 2] - points[a, 2]
        length2 = dx * dx + dy * dy + dz * dz
        for c in range(candidates.shape[0]):
            p = candidates[c]
            x, y, z = points[p, 0] - points[a, 0], points[p, 1] - points[a, 1], points[p, 2] - points[a, 2]
            along = (x * dx + y * dy + z * dz) / length2
            margin = tolerance / math.sqrt(length2)
            if p == a or p == b or not margin < along < 1.0 - margin:
                continue
            x, y, z = x - along * dx, y - along * dy, z - along * dz
            if x * x + y * y + z * z > tolerance * tolerance:
                continue
            if count == found.shape[0]:
                return count + 1
            found[count, 0], found[count, 1], found[count, 2] = e, p, along
            count += 1
    return count


@kernel
def winding_number(triangles: F8, point: F8) -> float:
    """Return the winding number of surfaces about a point, counter-clockwise seen from outside: 1 inside, 0 outside.

    Sum of the solid angles of the triangles (Van Oosterom & Strackee 1983) over the whole sphere.

    Args:
        triangles: Vertices [m], [n, 3, 3].
        point: Position [m], [3], on no triangle.
    """
    total = 0.0
    a, b, c = np.empty(3), np.empty(3), np.empty(3)
    for t in range(triangles.shape[0]):
        for k in range(3):
            a[k], b[k] = triangles[t, 0, k] - point[k], triangles[t, 1, k] - point[k]
            c[k] = triangles[t, 2, k] - point[k]
        la, lb = math.sqrt(a[0] ** 2 + a[1] ** 2 + a[2] ** 2), math.sqrt(b[0] ** 2 + b[1] ** 2 + b[2] ** 2)
        lc = math.sqrt(c[0] ** 2 + c[1] ** 2 + c[2] ** 2)
        triple = a[0] * (b[1] * c[2] - b[2] * c[1])
        triple += a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0])
        ab = a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
        bc = b[0] * c[0] + b[1] * c[1] + b[2] * c[2]
        ca = c[0] * a[0] + c[1] * a[1] + c[2] * a[2]
        total += math.atan2(triple, la * lb * lc + ab * lc + bc * la + ca * lb)
    return total / (2.0 * math.pi)


@kernel
def _separated(axis: F8, vertices: F8, half: F8) -> bool:
    """Return True when an axis separates a triangle from a box around the origin."""
    low = high = axis[0] * vertices[0, 0] + axis[1] * vertices[0, 1] + axis[2] * vertices[0, 2]
    for k in range(1, 3):
        at = axis[0] * vertices[k, 0] + axis[1] * vertices[k, 1] + axis[2] * vertices[k, 2]
        low, high = min(low, at), max(high, at)
    reach = abs(axis[0]) * half[0] + abs(axis[1]) * half[1] + abs(axis[2]) * half[2]
    return bool(low > reach or high < -reach)


@kernel
def touches_box(triangle: F8, lower: F8, upper: F8, scratch: F8) -> bool:
    """Return True when a triangle and a closed box intersect (separating axes: Akenine-Moller 2001).

    Args:
        triangle: Vertices [m], [3, 3].
        lower: Minimum corner of the box [m], [3].
        upper: Maximum corner [m], [3].
        scratch: Scratch, [8, 3].
    """
    for k in range(3):
        low = min(triangle[0, k], triangle[1, k], triangle[2, k])
        high = max(triangle[0, k], triangle[1, k], triangle[2, k])
        if low > upper[k] or high < lower[k]:
            return False
    half, vertices = scratch[0], scratch[1:4]
    for k in range(3):
        half[k] = 0.5 * (upper[k] - lower[k])
        for vertex in range(3):
            vertices[vertex, k] = triangle[vertex, k] - 0.5 * (upper[k] + lower[k])
    return not _separated_by_edges(half, vertices, scratch[4:7], scratch[7])


@kernel
def _separated_by_edges(half: F8, vertices: F8, edges: F8, axis: F8) -> bool:
    """Return True when the triangle's normal, or the cross product of two edges, is a separating axis."""
    for k in range(3):
        for edge in range(3):
            edges[edge, k] = vertices[(edge + 1) % 3, k] - vertices[edge, k]
    for k in range(3):
        i, j = (k + 1) % 3, (k + 2) % 3
        axis[k] = edges[0, i] * edges[1, j] - edges[0, j] * edges[1, i]
    if _separated(axis, vertices, half):
        return True
    for edge in range(3):
        for k in range(3):
            i, j = (k + 1) % 3, (k + 2) % 3
            axis[k], axis[i], axis[j] = 0.0, -edges[edge, j], edges[edge, i]
            if _separated(axis, vertices, half):
                return True
    return False


@kernel
def mark_cells(triangles: F8, lower: F8, size: F8, blocked: U1) -> None:
    """Mark the cells of a grid that triangles touch.

    Args:
        triangles: Vertices [m], [n, 3, 3].
        lower: Minimum corner of the grid [m], [3].
        size: Size of a cell [m], [3].
        blocked: Set to 1 where touched, [nx, ny, nz].
    """
    scratch, low, high = np.empty((_CORNERS, 3)), np.empty(3), np.empty(3)
    first, last = np.empty(3, np.int64), np.empty(3, np.int64)
    for t in range(triangles.shape[0]):
        for k in range(3):
            start = min(triangles[t, 0, k], triangles[t, 1, k], triangles[t, 2, k]) - lower[k]
            end = max(triangles[t, 0, k], triangles[t, 1, k], triangles[t, 2, k]) - lower[k]
            first[k] = max(0, math.floor(start / size[k]) - 1)
            last[k] = min(blocked.shape[k] - 1, math.floor(end / size[k]) + 1)
        for i in range(first[0], last[0] + 1):
            low[0], high[0] = lower[0] + i * size[0], lower[0] + (i + 1) * size[0]
            for j in range(first[1], last[1] + 1):
                low[1], high[1] = lower[1] + j * size[1], lower[1] + (j + 1) * size[1]
                for k in range(first[2], last[2] + 1):
                    low[2], high[2] = lower[2] + k * size[2], lower[2] + (k + 1) * size[2]
                    if not blocked[i, j, k] and touches_box(triangles[t], low, high, scratch):
                        blocked[i, j, k] = 1


@kernel
def label_cells(blocked: U1, labels: I4, stack: I4, seeds: I4) -> int:
    """Label the groups of free cells that are connected by faces.

    Args:
        blocked: 1 where a cell is blocked, [nx, ny, nz].
        labels: Written: number of the group from 1 on, 0 where blocked; [nx, ny, nz].
        stack: Scratch, [cells, 3].
        seeds: Written: one cell of each group, [cells, 3].

    Returns:
        Number of groups.
    """
    labels[:] = 0
    groups = 0
    for i in range(blocked.shape[0]):
        for j in range(blocked.shape[1]):
            for k in range(blocked.shape[2]):
                if blocked[i, j, k] or labels[i, j, k]:
                    continue
                seeds[groups, 0], seeds[groups, 1], seeds[groups, 2] = i, j, k
                groups += 1
                _flood(blocked, labels, stack, i, j, k, groups)
    return groups


@kernel
def _flood(blocked: U1, labels: I4, stack: I4, i: int, j: int, k: int, label: int) -> None:
    labels[i, j, k] = label
    stack[0, 0], stack[0, 1], stack[0, 2] = i, j, k
    height = 1
    while height:
        height -= 1
        x, y, z = stack[height, 0], stack[height, 1], stack[height, 2]
        for side in range(_SIDES):
            step = 1 - 2 * (side % 2)
            a, b = x + (step if side < 2 else 0), y + (step if side in (2, 3) else 0)
            c = z + (step if side > 3 else 0)
            inside = 0 <= a < blocked.shape[0] and 0 <= b < blocked.shape[1] and 0 <= c < blocked.shape[2]
            if inside and not blocked[a, b, c] and not labels[a, b, c]:
                labels[a, b, c] = label
                stack[height, 0], stack[height, 1], stack[height, 2] = a, b, c
                height += 1


@kernel
def _longest_run(free: U1) -> tuple[int, int]:
    """Return first cell and length of the longest run of free cells."""
    best = start = length = 0
    best_start = 0
    for i in range(free.shape[0]):
        if free[i]:
            if length == 0:
                start = i
            length += 1
            if length > best:
                best, best_start = length, start
        else:
            length = 0
    return best_start, best


@kernel
def find_best_box(free: U1, size: F8, out: I4) -> float:
    """Find the box of free cells with the largest surface, by trying every pair of layers in two axes.

    Args:
        free: 1 where a cell may be used, [nx, ny, nz].
        size: Size of a cell [m], [3].
        out: Written: first cell and end of the box, [2, 3].

    Returns:
        Half of its surface [m^2], 0 where no cell is free.
    """
    nx, ny, nz = free.shape
    best = 0.0
    plate, row = np.empty((nx, ny), np.uint8), np.empty(nx, np.uint8)
    for z0 in range(nz):
        plate[:] = 1
        for z1 in range(z0, nz):
            plate &= free[:, :, z1]
            for y0 in range(ny):
                row[:] = 1
                for y1 in range(y0, ny):
                    row &= plate[:, y1]
                    x0, length = _longest_run(row)
                    if length == 0:
                        break
                    a, b, c = length * size[0], (y1 + 1 - y0) * size[1], (z1 + 1 - z0) * size[2]
                    if a * b + b * c + c * a > best:
                        best = a * b + b * c + c * a
                        out[0, 0], out[0, 1], out[0, 2] = x0, y0, z0
                        out[1, 0], out[1, 1], out[1, 2] = x0 + length, y1 + 1, z1 + 1
    return best


@kernel
def _is_free(triangles: F8, lower: F8, upper: F8, scratch: F8) -> bool:
    for t in range(triangles.shape[0]):
        if touches_box(triangles[t], lower, upper, scratch):
            return False
    return True


@kernel
def grow_box(triangles: F8, box: F8, reach: F8) -> None:
    """Move the faces of a box outwards in turn, each as far as no triangle touches the box, by bisection.

    Args:
        triangles: Vertices [m], [n, 3, 3].
        box: Minimum and maximum corner [m], [2, 3], changed.
        reach: Maximum displacement of a face by axis [m], [3].
    """
    scratch = np.empty((_CORNERS, 3))
    for face in range(_SIDES):
        side, axis = face % 2, face // 2
        step = reach[axis] if side else -reach[axis]
        before = box[side, axis]
        good, bad = 0.0, 1.0
        for _ in range(_BISECTIONS):
            middle = 0.5 * (good + bad)
            box[side, axis] = before + middle * step
            if _is_free(triangles, box[0], box[1], scratch):
                good = middle
            else:
                bad = middle
        box[side, axis] = before + good * step
