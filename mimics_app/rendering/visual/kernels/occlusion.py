"""Occlusion culling against a coarse depth buffer of the occluder boxes, never nearer than the drawn surfaces.

One value per block of k x k pixels: 1/w of the nearest box that covers all sample positions of the block, at the
entry into that box, minimum over the block. An item is occluded where every block that its samples can touch has a
value above the item's own largest 1/w. All rounding is conservative:

- positions count as covered, and as touched, with a margin of a sixteenth of a pixel; drivers round vertices to 1/256
  of a pixel, and the error of single precision is smaller;
- 1/w is compared with a margin of `depth_step`, several steps of a 24-bit depth buffer, and a share of the item's own
  depth range, by which slanted triangles are off at their edges;
- w is the depth along the view axis, so that 1/w is linear on the screen for any plane (Blinn 1992).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import F8, I4
from mimics_app.rendering.visual.kernels.projection import TO_SCREEN, project_box, to_screen

__all__ = ["MARGIN_PX", "CoarseDepth", "ItemBoxes", "hides", "is_hidden", "remove_hidden"]


MARGIN_PX = 0.0625
"""Largest assumed error of a drawn vertex [px]; drivers stay below a sixteenth of it."""

_DEPTH_SHARE = 1.0 / 64.0
"""Share of an item's own range of 1/w by which its edges may be drawn nearer than its box."""

_CORNERS = 8
"""Corners of a box."""


class CoarseDepth(NamedTuple):
    """The coarse depth buffer of a picture; pixels may be finer cells than those of the picture.

    Attributes:
        nearness: 1/w of the nearest occluder per block [1/m], [rows, columns]; without any blocks nothing is hidden.
        block: Width of a square block [px].
        width: Width of the picture [px].
        height: Height of the picture [px].
        near: Distance of the near plane [m].
        depth_step: Difference of 1/w that the depth buffer resolves for certain [1/m].
    """

    nearness: F8
    block: int
    width: int
    height: int
    near: float
    depth_step: float


class ItemBoxes(NamedTuple):
    """Boxes around items.

    Attributes:
        rows: Row of the node per item, [n].
        world: T_world_from_node per row.
        centre: Centres of the boxes in their nodes' frames [m], [n, >= 3].
        half: Half extents of those boxes [m], [n, 3].
    """

    rows: I4
    world: F8
    centre: F8
    half: F8


@kernel
def hides(
    depth: CoarseDepth, left: float, right: float, bottom: float, top: float, highest: float, lowest: float
) -> bool:
    """Return True where occluders are nearer than a body in every block of a rectangle.

    Args:
        depth: The coarse depth buffer.
        left: First column of pixels.
        right: Last column.
        bottom: First row.
        top: Last row.
        highest: Largest 1/w of the body [1/m].
        lowest: Its smallest.
    """
    nearness = depth.nearness
    if nearness.size == 0:
        return False
    wanted = highest + depth.depth_step + _DEPTH_SHARE * (highest - lowest)
    # Half a pixel more, so that rounding leaves the block as it is; a division of integers takes longer.
    of_pixel = 1.0 / depth.block
    first, last = int((left + 0.5) * of_pixel), int((right + 0.5) * of_pixel)
    for row in range(int((bottom + 0.5) * of_pixel), int((top + 0.5) * of_pixel) + 1):
        for column in range(first, last + 1):
            if not nearness[row, column] > wanted:
                return False
    return True


@kernel
def is_hidden(corners: F8, depth: CoarseDepth, touch: float) -> bool:
    """Return True where no sample of a picture shows a box.

    Args:
        corners: X w, Y w [px] and w [m] of its corners, [8, 3].
        depth: The coarse depth buffer.
        touch: Largest distance of a sample from the outer side of its pixel, with the margin [px].
    """
    x0, x1, y0, y1 = math.inf, -math.inf, math.inf, -math.inf
    nearest, farthest = math.inf, 0.0
    for corner in range(_CORNERS):
        w = corners[corner, 2]
        if not w > depth.near:
            return False
        x, y = corners[corner, 0] / w, corners[corner, 1] / w
        x0, x1, y0, y1 = min(x0, x), max(x1, x), min(y0, y), max(y1, y)
        nearest, farthest = min(nearest, w), max(farthest, w)
    left, right = max(0.0, math.ceil(x0 - touch)), min(depth.width - 1.0, math.floor(x1 + touch - 1.0))
    bottom, top = max(0.0, math.ceil(y0 - touch)), min(depth.height - 1.0, math.floor(y1 + touch - 1.0))
    if left > right or bottom > top:
        return True
    return hides(depth, left, right, bottom, top, 1.0 / nearest, 1.0 / farthest)


@kernel
def remove_hidden(
    items: I4, count: int, eye: F8, screen: F8, depth: CoarseDepth, reach: float, boxes: ItemBoxes
) -> int:
    """Remove the occluded items; the rest keep their order.

    Args:
        items: Items in the frustum, [>= count], changed.
        count: Number of items.
        eye: Position of the camera, world [m], [3].
        screen: Matrix from world vectors relative to the camera to X w, Y w [px] and w [m], [3, 3].
        depth: The coarse depth buffer.
        reach: Largest offset of a sample from its pixel's centre, with the margin [px].
        boxes: Boxes of all items.

    Returns:
        How many remain.
    """
    corners, matrix = np.empty((_CORNERS, 3)), np.empty(TO_SCREEN)
    touch = 0.5 + reach
    kept = 0
    for i in range(count):
        item = items[i]
        to_screen(screen, eye, boxes.world, boxes.rows[item], matrix)
        project_box(matrix, boxes.centre, boxes.half, item, corners)
        if not is_hidden(corners, depth, touch):
            items[kept] = item
            kept += 1
    return kept
