"""Where the shadows of boxes may fall: prisms along the sun's rays, cut to what they fall on."""

from __future__ import annotations

import math

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import B1, F8, I4, I8, U1
from mimics_app.maths.mat import affine_inverse
from mimics_app.rendering.visual.software.kernels.shape_places import MISSED, ItemsOfFrame, ShapeTable

__all__ = ["FIGURES", "cut_prisms", "cut_prisms_on_items", "find_moving", "slice_casters"]


_CASTS, _KEPT = 1, 2


@kernel
def find_moving(casters: I4, kept: I4, moved_at: I8, kept_in: int, last: int, marks: U1, moving: I4) -> int:
    """List the casters that are not kept; return their number, -1 where the kept ones do not hold any more.

    They hold while all of them cast and have not moved since, and each of the others has moved lately.

    Args:
        casters: Numbers of the items that cast, [n].
        kept: Numbers of the items whose depths are kept, [k].
        moved_at: Frame in which each item last moved, [items].
        kept_in: Frame in which the depths were drawn.
        last: Frame since which an item must have moved, so that it does not count as static.
        marks: Scratch, [items].
        moving: Written, [>= n].
    """
    marks[:] = 0
    for item in casters:
        marks[item] = _CASTS
    for item in kept:
        if moved_at[item] > kept_in or not marks[item]:
            return -1
        marks[item] = _KEPT
    count = 0
    for item in casters:
        if marks[item] == _KEPT:
            continue
        if moved_at[item] <= last:
            return -1
        moving[count] = item
        count += 1
    return count


FIGURES = 6
"""Of a caster in the frame of the rays: least and greatest x, y and z [m]."""

_LEFT, _RIGHT, _BOTTOM, _TOP, _FARTHEST, _NEAREST = range(FIGURES)

_EDGES = 1, 2, 4
"""Corners of a box at the ends of its edges from the first corner."""

_PARALLEL = 1e-9
"""Change of a coordinate along a ray below which the ray is parallel to the sides [1/m]."""

_SLENDER = 2.0
"""Length over width up to which a prism is one piece: an oblique one is much smaller than its bounding rectangle."""

_MOST_PIECES = 8

_ROWS = 4
"""Of a matrix that moves points."""

_FLAT = 1e-12
"""Volume of the unit cube of a node [m^3] below which its box is not used."""


@kernel
def _measure_corners(corners: F8, rays: F8, figures: F8) -> None:
    """Compute the figures of boxes, [n, `FIGURES`], from their corners in the world [m], [n, 8, 3]."""
    for box in range(corners.shape[0]):
        x, y, z = corners[box, 0]
        for k in range(3):
            least = rays[k, 0] * x + rays[k, 1] * y + rays[k, 2] * z
            greatest = least
            for end in _EDGES:
                along = rays[k, 0] * (corners[box, end, 0] - x) + rays[k, 1] * (corners[box, end, 1] - y)
                along += rays[k, 2] * (corners[box, end, 2] - z)
                least, greatest = least + min(along, 0.0), greatest + max(along, 0.0)
            figures[box, 2 * k], figures[box, 2 * k + 1] = least, greatest


@kernel
def _count_slices(boxes: F8, eye: F8, least: float, most: int) -> int:
    """Return the number of slices of a caster of some boxes, see `slice_casters`."""
    whole, away2 = boxes[0].copy(), 0.0
    for j in range(1, boxes.shape[0]):
        for k in range(3):
            whole[2 * k] = min(whole[2 * k], boxes[j, 2 * k])
            whole[2 * k + 1] = max(whole[2 * k + 1], boxes[j, 2 * k + 1])
    for k in range(3):
        away2 += (0.5 * (whole[2 * k] + whole[2 * k + 1]) - eye[k]) ** 2
    height, narrowest = whole[_TOP] - whole[_BOTTOM], least * math.sqrt(away2)
    return max(1, min(most, int(height / narrowest))) if narrowest > 0.0 else most


@kernel
def _slice(boxes: F8, slices: int, casters: F8) -> None:
    """Compute the figures of the slices of one caster, [slices, `FIGURES`], from those of its boxes."""
    bottom, top = np.inf, -np.inf
    for j in range(boxes.shape[0]):
        bottom, top = min(bottom, boxes[j, _BOTTOM]), max(top, boxes[j, _TOP])
    for k in range(slices):
        low, high = bottom + k * (top - bottom) / slices, bottom + (k + 1) * (top - bottom) / slices
        left, right, far, near = np.inf, -np.inf, np.inf, -np.inf
        for j in range(boxes.shape[0]):
            if boxes[j, _BOTTOM] <= high and boxes[j, _TOP] >= low:
                left, right = min(left, boxes[j, _LEFT]), max(right, boxes[j, _RIGHT])
                far, near = min(far, boxes[j, _FARTHEST]), max(near, boxes[j, _NEAREST])
        for number, figure in enumerate((left, right, low, high, far, near)):
            casters[k, number] = figure


@kernel
def slice_casters(corners: F8, starts: I4, casts: B1, rays: F8, eye: F8, least: float, most: int, casters: F8) -> int:
    """Cut casters into slices of equal height across the rays, and compute the figures of each.

    Args:
        corners: Corners of their boxes, world [m], [boxes, 8, 3].
        starts: First box of each, and the number of boxes, int32 [n + 1].
        casts: Whether each casts a shadow at all; the others are left out, [n].
        rays: Axes of the frame of the rays in the world: across, across, towards the sun; [3, 3].
        eye: Position of the camera in the frame of the rays [m], [3].
        least: Smallest height of a slice over its distance from the eye.
        most: Most slices of a caster.
        casters: Written; of an empty slice the least x is beyond the greatest, [>= n * most, `FIGURES`].

    Returns:
        Number of slices.
    """
    count, boxes = 0, np.empty((corners.shape[0], FIGURES))
    _measure_corners(corners, rays, boxes)
    for i in range(starts.shape[0] - 1):
        if casts[i]:
            own = boxes[starts[i] : starts[i + 1]]
            slices = _count_slices(own, eye, least, most)
            _slice(own, slices, casters[count : count + slices])
            count += slices
    return count


@kernel
def _measure_box(box: F8, rays_from_node: F8, middle: F8, around: F8) -> None:
    """Compute middle and half extents of a box of a node in the frame of the rays [m], [3] each."""
    for k in range(3):
        middle[k], around[k] = rays_from_node[k, 3], 0.0
        for r in range(3):
            along = rays_from_node[k, r]
            middle[k] += along * 0.5 * (box[1, r] + box[0, r])
            around[k] += abs(along) * 0.5 * (box[1, r] - box[0, r])


@kernel
def _cut_by_box(prism: F8, middle: F8, inverse: F8, box: F8, rays: F8, reach: float) -> None:
    """Cut a prism to the box of what it falls on, grown by `reach`.

    Args:
        prism: Least and greatest x, y and z in the frame of the rays [m], [3, 2]; z is changed.
        middle: Middle of the box in that frame [m], [3].
        inverse: T_node_from_world, [4, 4].
        box: Its least and greatest corner in the node's frame [m], [2, 3].
        rays: Axes of the frame of the rays in the world, [3, 3].
        reach: Margin [m].
    """
    for i in range(3):
        row = inverse[i]
        limit = reach * math.sqrt(row[0] * row[0] + row[1] * row[1] + row[2] * row[2])
        limit += 0.5 * (box[1, i] - box[0, i])
        base = 0.0
        for k in range(2):
            slope = row[0] * rays[k, 0] + row[1] * rays[k, 1] + row[2] * rays[k, 2]
            base += slope * (0.5 * (prism[k, 0] + prism[k, 1]) - middle[k])
            limit += abs(slope) * 0.5 * (prism[k, 1] - prism[k, 0])
        slope = row[0] * rays[2, 0] + row[1] * rays[2, 1] + row[2] * rays[2, 2]
        if abs(slope) > _PARALLEL:
            centre, length = middle[2] - base / slope, limit / abs(slope)
            prism[2, 0], prism[2, 1] = max(prism[2, 0], centre - length), min(prism[2, 1], centre + length)
        elif abs(base) > limit:
            prism[2, 1] = -np.inf


@kernel
def _store(prism: F8, rays: F8, count: int, prisms: F8) -> int:
    """Store a prism in pieces while there is room; return the number of prisms with these."""
    width = max(prism[0, 1] - prism[0, 0], prism[1, 1] - prism[1, 0])
    length = prism[2, 1] - prism[2, 0]
    pieces = min(_MOST_PIECES, max(1, math.ceil(length / (_SLENDER * width))))
    for piece in range(pieces if count + pieces <= prisms.shape[0] else 0):
        for corner in range(prisms.shape[1]):
            x, y = prism[0, corner & 1], prism[1, corner >> 1 & 1]
            z = prism[2, 0] + (piece + (corner >> 2)) * length / pieces
            for r in range(3):
                prisms[count + piece, corner, r] = x * rays[0, r] + y * rays[1, r] + z * rays[2, r]
    return count + pieces


@kernel
def _turn_node(node: F8, rays: F8, rays_from_node: F8, inverse: F8) -> None:
    """Set the matrices from a node to the frame of the rays, [3, 4], and from the world to the node, [4, 4].

    The latter is not finite where the node is flat.
    """
    for k in range(3):
        for c in range(_ROWS):
            along = rays[k, 0] * node[0, c] + rays[k, 1] * node[1, c] + rays[k, 2] * node[2, c]
            rays_from_node[k, c] = along
    if abs(affine_inverse(node, inverse)) <= _FLAT:
        inverse[0, 0] = np.nan


@kernel
def _find_above(casters: F8, reach: float, middle: F8, around: F8, found: I4) -> int:
    """Write the numbers of the casters that are above a box; return how many."""
    left, right = middle[0] - around[0] - reach, middle[0] + around[0] + reach
    bottom, top = middle[1] - around[1] - reach, middle[1] + around[1] + reach
    far, count = middle[2] - around[2] - reach, 0
    for i in range(casters.shape[0]):
        beside = casters[i, _LEFT] >= right or casters[i, _RIGHT] <= left
        if not (beside or casters[i, _BOTTOM] >= top or casters[i, _TOP] <= bottom or casters[i, _NEAREST] <= far):
            found[count] = i
            count += 1
    return count


@kernel
def _cut_by_boxes(
    casters: F8, rays: F8, reach: float, boxes: F8, rays_from_node: F8, inverse: F8, prisms: F8, count: int
) -> int:
    """Store the prisms of casters on boxes of a node, see `cut_prisms`; return the number of prisms with these."""
    middle, around, prism = np.empty(3), np.empty(3), np.empty((3, 2))
    above = np.empty(casters.shape[0], np.int32)
    for j in range(boxes.shape[0]):
        _measure_box(boxes[j], rays_from_node, middle, around)
        around += reach
        for number in range(_find_above(casters, reach, middle, around, above)):
            caster = casters[above[number]]
            for k in range(2):
                prism[k, 0] = max(caster[2 * k] - reach, middle[k] - around[k])
                prism[k, 1] = min(caster[2 * k + 1] + reach, middle[k] + around[k])
            prism[2, 0], prism[2, 1] = middle[2] - around[2], min(caster[_NEAREST] + reach, middle[2] + around[2])
            if math.isfinite(inverse[0, 0]):
                _cut_by_box(prism, middle, inverse, boxes[j], rays, reach)
            if prism[2, 0] < prism[2, 1]:
                count = _store(prism, rays, count, prisms)
    return count


@kernel
def cut_prisms(casters: F8, rays: F8, reach: float, boxes: F8, nodes: I4, world: F8, prisms: F8, fallen: U1) -> int:
    """Compute the prisms in which the shadows of casters may fall on boxes.

    Args:
        casters: See `slice_casters`, [n, `FIGURES`].
        rays: Axes of the frame of the rays in the world, [3, 3].
        reach: Margin around a shadow [m].
        boxes: Least and greatest corner in the frame of a node [m], [m, 2, 3].
        nodes: Number of the node of each, int32 [m].
        world: T_world_from_node of each node, [nodes, 4, 4].
        prisms: Written: corners, world [m], [capacity, 8, 3].
        fallen: Set to 1 for each box on which a shadow may fall, [m].

    Returns:
        Number of prisms; more than the capacity where they did not fit.
    """
    count, turned, inverse = 0, np.empty((3, _ROWS)), np.empty((_ROWS, _ROWS))
    for j in range(boxes.shape[0]):
        before = count
        _turn_node(world[nodes[j]], rays, turned, inverse)
        count = _cut_by_boxes(casters, rays, reach, boxes[j : j + 1], turned, inverse, prisms, count)
        fallen[j] |= count > before
    return count


@kernel
def cut_prisms_on_items(
    casters: F8, rays: F8, reach: float, receiving: B1, items: ItemsOfFrame, table: ShapeTable, prisms: F8
) -> int:
    """Compute the prisms in which the shadows of casters may fall on items: on the boxes of their shapes, if known.

    Args:
        casters: See `slice_casters`, [n, `FIGURES`].
        rays: Axes of the frame of the rays in the world, [3, 3].
        reach: Margin around a shadow [m].
        receiving: The items, [items].
        items: Where they are.
        table: Their shapes; `missed` is written, see `ShapeTable`.
        prisms: Written: corners, world [m], [capacity, 8, 3].

    Returns:
        Number of prisms; more than the capacity where they did not fit.
    """
    world, spans = items.world, table.spans
    count, turned, inverse = 0, np.empty((3, _ROWS)), np.empty((_ROWS, _ROWS))
    seen = np.zeros(spans.shape[0], np.bool_)
    for item in range(receiving.shape[0]):
        shape, box = table.shapes[item], items.boxes[item : item + 1]
        if not receiving[item] or seen[shape]:
            continue
        _turn_node(world[table.rows[item]], rays, turned, inverse)
        if _cut_by_boxes(casters, rays, reach, box, turned, inverse, prisms[:0], 0) == 0:
            continue
        first, end = spans[shape]
        if first < end:
            seen[shape], box = True, table.boxes[first:end]
        else:
            table.missed[shape] = max(table.missed[shape], MISSED)
        count = _cut_by_boxes(casters, rays, reach, box, turned, inverse, prisms, count)
    return count
