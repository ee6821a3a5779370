"""Choice of occluder boxes, and their rasterisation into the coarse depth buffer (see `occlusion`)."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import F8, I4
from mimics_app.rendering.visual.kernels.projection import TO_SCREEN, project_box, to_node, to_screen

__all__ = ["ItemPlaces", "OccluderView", "Occluders", "draw_occluders", "pick_occluders"]


_POINTS = 24
"""Upper bound on the points of a box clipped by the near plane: fewer than 8 corners and 12 clipped edges."""

_CORNERS, _WINDOW = 8, 4
"""Corners of a box, and of the near plane's window."""

_MIN_DISTANCE2 = 1e-300
"""Smallest squared distance to divide by [m^2]."""

_MAX_ROW_PX = 1e9
"""Largest row of a hull [px], so that it fits an integer."""


class Occluders(NamedTuple):
    """Occluder boxes, in the frames of their nodes [m].

    Attributes:
        of_item: Number of each item's box, -1: none; int32 [n].
        inner_centre: Centres of the boxes, float64 [boxes, 3].
        inner_half: Their half extents, [boxes, 3].
        whole_centre: Centres of the bounding boxes of the whole bodies, [boxes, 3].
        whole_half: Their half extents, [boxes, 3].
        caps: Planes that the camera has to be behind, normal and offset, [.., 4].
        caps_from: First plane of each box, and the end of the last, int32 [boxes + 1].
    """

    of_item: I4
    inner_centre: F8
    inner_half: F8
    whole_centre: F8
    whole_half: F8
    caps: F8
    caps_from: I4


class OccluderView(NamedTuple):
    """A camera and its picture.

    Attributes:
        eye: Position of the camera, world [m], [3].
        window: Corners of the near plane's window relative to the camera [m], [4, 3].
        screen: Matrix from world vectors relative to the camera to X w, Y w [px] and w [m], [3, 3].
        rays: World directions of w = 1 per pixel to the right, per pixel up, and at pixel (0, 0); [3, 3].
        near: Distance of the near plane [m].
        block: Width of a square block [px].
        reach: Largest offset of a sample from its pixel's centre, with the margin [px].
    """

    eye: F8
    window: F8
    screen: F8
    rays: F8
    near: float
    block: int
    reach: float


class ItemPlaces(NamedTuple):
    """Where items are.

    Attributes:
        rows: Row of the node per item, [n].
        world: T_world_from_node per row.
        centres: Centres of the items' spheres, world [m], [n, 3].
    """

    rows: I4
    world: F8
    centres: F8


@kernel
def _is_valid(view: OccluderView, known: Occluders, box: int, world: F8, row: int, out: F8) -> bool:
    """Return True when an inner box is a valid occluder for a camera.

    Camera and near window have to be outside the bounding box of the whole body, on one side of it, so that the near
    plane removes no front face, and the camera behind every cap.

    Args:
        view: The camera.
        known: All boxes.
        box: Number of the box.
        world: T_world_from_node per row.
        row: Row of the item's node.
        out: Written: camera and corners in the node's frame, [5, 3].
    """
    eye, window, centre, half, caps = view.eye, view.window, known.whole_centre, known.whole_half, known.caps
    to_node(world, row, eye[0] - world[row, 0, 3], eye[1] - world[row, 1, 3], eye[2] - world[row, 2, 3], out, 0)
    for corner in range(_WINDOW):
        to_node(world, row, window[corner, 0], window[corner, 1], window[corner, 2], out, corner + 1)
    for k in range(3):
        for corner in range(1, _WINDOW + 1):
            out[corner, k] += out[0, k]
    apart = False
    for k in range(3):
        low, high = math.inf, -math.inf
        for point in range(_WINDOW + 1):
            low, high = min(low, out[point, k] - centre[box, k]), max(high, out[point, k] - centre[box, k])
        apart = apart or low > half[box, k] or high < -half[box, k]
    if not apart:
        return False
    for cap in range(known.caps_from[box], known.caps_from[box + 1]):
        depth = caps[cap, 0] * out[0, 0] + caps[cap, 1] * out[0, 1] + caps[cap, 2] * out[0, 2] + caps[cap, 3]
        if not depth < 0.0:
            return False
    return True


@kernel
def pick_occluders(items: I4, eye: F8, least: float, known: Occluders, placed: ItemPlaces, out: I4, score: F8) -> int:
    """Pick the items whose inner boxes have the largest solid angle.

    Args:
        items: Items in the frustum, [k].
        eye: Position of the camera, world [m], [3].
        least: Half diagonal of a box over its distance up to which it hides too little to be picked.
        known: All boxes.
        placed: Where the items are.
        out: Written: items, best first, [capacity].
        score: Scratch, [capacity].

    Returns:
        How many, at most the length of `out`.
    """
    world, centres, inner_half = placed.world, placed.centres, known.inner_half
    kept, capacity = 0, out.shape[0]
    for i in range(items.shape[0]):
        item = items[i]
        box = known.of_item[item]
        if box < 0:
            continue
        row, size, distance2 = placed.rows[item], 0.0, 0.0
        for k in range(3):
            for axis in range(3):
                size += (world[row, k, axis] * inner_half[box, axis]) ** 2
            distance2 += (centres[item, k] - eye[k]) ** 2
        worth = size / max(distance2, _MIN_DISTANCE2)
        if worth < least * least or (kept == capacity and worth <= score[kept - 1]):
            continue
        place = kept if kept < capacity else capacity - 1
        kept = min(kept + 1, capacity)
        while place > 0 and score[place - 1] < worth:
            score[place], out[place] = score[place - 1], out[place - 1]
            place -= 1
        score[place], out[place] = worth, item
    return kept


@kernel
def _cut_near(corners: F8, near: float, points: F8) -> int:
    """Write the screen points [px] of a box clipped by the near plane: its corners and cut edges; return how many."""
    count = 0
    for corner in range(_CORNERS):
        if corners[corner, 2] >= near:
            points[count, 0] = corners[corner, 0] / corners[corner, 2]
            points[count, 1] = corners[corner, 1] / corners[corner, 2]
            count += 1
        for bit in range(3):
            other = corner | (1 << bit)
            a, b = corners[corner, 2] - near, corners[other, 2] - near
            if other == corner or (a < 0.0) == (b < 0.0):
                continue
            share = a / (a - b)
            for k in range(2):
                at = corners[corner, k] + share * (corners[other, k] - corners[corner, k])
                points[count, k] = at / near
            count += 1
    return count


@kernel
def _hull(points: F8, count: int, out: F8) -> int:
    """Compute the convex hull, counter-clockwise with y up (monotone chain, Andrew 1979); ties in x go by y."""
    for i in range(1, count):
        x, y = points[i, 0], points[i, 1]
        j = i
        while j > 0 and (points[j - 1, 0] > x or (points[j - 1, 0] == x and points[j - 1, 1] > y)):
            points[j, 0], points[j, 1] = points[j - 1, 0], points[j - 1, 1]
            j -= 1
        points[j, 0], points[j, 1] = x, y
    size, base = 0, 2
    for chain in range(2):
        for step in range(chain, count):
            i = step if chain == 0 else count - 1 - step
            while size >= base and not _turns_left(out, size, points[i, 0], points[i, 1]):
                size -= 1
            out[size, 0], out[size, 1] = points[i, 0], points[i, 1]
            size += 1
        base = size + 1
    return size - 1


@kernel
def _turns_left(hull: F8, size: int, x: float, y: float) -> bool:
    ax, ay = hull[size - 1, 0] - hull[size - 2, 0], hull[size - 1, 1] - hull[size - 2, 1]
    return bool(ax * (y - hull[size - 2, 1]) - ay * (x - hull[size - 2, 0]) > 0.0)


@kernel
def _entry_planes(eye_local: F8, centre: F8, half: F8, box: int, world: F8, row: int, rays: F8, out: F8) -> int:
    """Write 1/w of a box's front faces as a X + b Y + c over the screen [px]; a ray enters at their minimum.

    Args:
        eye_local: Position of the camera in the node's frame, the first row of [5, 3].
        centre: Centres of the inner boxes [m], [boxes, 3].
        half: Their half extents [m], [boxes, 3].
        box: Number of the box.
        world: T_world_from_node per row.
        row: Row of the item's node.
        rays: World directions of w = 1 per pixel to the right, per pixel up, and at pixel (0, 0); [3, 3].
        out: Written, [3, 3].
    """
    faces = 0
    rays_local = np.empty((3, 3))
    for k in range(3):
        to_node(world, row, rays[k, 0], rays[k, 1], rays[k, 2], rays_local, k)
    for axis in range(3):
        offset = eye_local[0, axis] - centre[box, axis]
        if abs(offset) <= half[box, axis]:
            continue
        face = half[box, axis] if offset > 0.0 else -half[box, axis]
        for k in range(3):
            out[faces, k] = rays_local[k, axis] / (face - offset)
        faces += 1
    return faces


@kernel
def _fill(hull: F8, size: int, planes: F8, faces: int, block: int, reach: float, nearness: F8) -> None:
    """Rasterise a convex polygon into the blocks of which it covers all sample positions.

    Args:
        hull: Vertices of the polygon, counter-clockwise [px], [>= size, 2].
        size: Number of vertices.
        planes: 1/w as a X + b Y + c, [>= faces, 3].
        faces: Number of planes.
        block: Width of a square block [px].
        reach: Largest offset of a sample from its pixel's centre, with the margin [px].
        nearness: Largest 1/w so far per block [1/m], [rows, columns].
    """
    bottom, top = hull[0, 1], hull[0, 1]
    for k in range(1, size):
        bottom, top = min(bottom, hull[k, 1]), max(top, hull[k, 1])
    first = max(0, math.floor(bottom / block) - 1) if bottom > 0.0 else 0
    last = min(nearness.shape[0], math.floor(min(top, _MAX_ROW_PX) / block) + 1) if top > 0.0 else 0
    low_side, high_side = 0.5 - reach, block - 0.5 + reach
    for row in range(first, last):
        y0, y1 = row * block + low_side, row * block + high_side
        left, right = 0.0, float(nearness.shape[1] * block)
        for k in range(size):
            after = k + 1 if k + 1 < size else 0
            ex, ey = hull[after, 0] - hull[k, 0], hull[after, 1] - hull[k, 1]
            value = min(ex * (y0 - hull[k, 1]), ex * (y1 - hull[k, 1]))
            if ey > 0.0:
                right = min(right, hull[k, 0] + value / ey)
            elif ey < 0.0:
                left = max(left, hull[k, 0] + value / ey)
            elif value < 0.0:
                right = -1.0
        start = max(0, math.ceil((left - low_side) / block))
        end = min(nearness.shape[1], math.floor((right - high_side) / block) + 1)
        for column in range(start, end):
            x0, x1 = column * block + low_side, column * block + high_side
            entered = math.inf
            for face in range(faces):
                a, b, c = planes[face, 0], planes[face, 1], planes[face, 2]
                entered = min(entered, (a * x0 if a > 0.0 else a * x1) + (b * y0 if b > 0.0 else b * y1) + c)
            if entered < math.inf and entered > nearness[row, column]:
                nearness[row, column] = entered


@kernel
def draw_occluders(chosen: I4, view: OccluderView, known: Occluders, rows: I4, world: F8, nearness: F8) -> int:
    """Rasterise inner boxes into the coarse depth buffer.

    Args:
        chosen: Numbers of items that have one, [k].
        view: The camera.
        known: All boxes.
        rows: Row of the node per item, [n].
        world: T_world_from_node per row.
        nearness: Written: 1/w of the nearest occluder, 0: none [1/m], [rows, columns].

    Returns:
        How many were used.
    """
    nearness[:] = 0.0
    corners, points, hull = np.empty((_CORNERS, 3)), np.empty((_POINTS, 2)), np.empty((2 * _POINTS, 2))
    spots, planes, matrix = np.empty((_WINDOW + 1, 3)), np.empty((3, 3)), np.empty(TO_SCREEN)
    used = 0
    for i in range(chosen.shape[0]):
        item = chosen[i]
        row, box = rows[item], known.of_item[item]
        if not _is_valid(view, known, box, world, row, spots):
            continue
        to_screen(view.screen, view.eye, world, row, matrix)
        project_box(matrix, known.inner_centre, known.inner_half, box, corners)
        size = _cut_near(corners, view.near, points)
        if size < 3:
            continue
        faces = _entry_planes(spots, known.inner_centre, known.inner_half, box, world, row, view.rays, planes)
        sides = _hull(points, size, hull)
        if faces and sides >= 3:
            _fill(hull, sides, planes, faces, view.block, view.reach, nearness)
            used += 1
    return used
