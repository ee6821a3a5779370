"""What boxes inside opaque things hide: a small picture of how near they are, never nearer than what is drawn.

One value stands for a block of k x k pixels: the inverse distance 1/w of the nearest box that covers the sample
positions of all of them, taken where that box is entered, least over the block. A thing is hidden where every block
that one of its samples can fall into has a value above its own nearest 1/w. Everything is rounded to the safe side:

- positions count as covered, and as touched, a sixteenth of a pixel farther than they are; drivers round corners to
  1/256 of a pixel, and single precision moves them by less than that;
- 1/w is compared with `depth_step` to spare, several steps of a 24-bit depth buffer, and with a share of the thing's
  own depth, which slanted triangles are off by at their edges;
- w is the distance along the line of sight, so that on the screen 1/w is linear on any plane (Blinn 1992).
"""

from __future__ import annotations

import math

import numpy as np

from mimics_app.contracts.arrays import F8, I4
from mimics_app.contracts.kernel import kernel
from mimics_app.rendering.visual.kernels.projection import project_box

__all__ = ["MARGIN_PX", "remove_hidden"]


MARGIN_PX = 0.0625
"""How far a corner drawn may be from where it should be [px]; drivers stay below a sixteenth of that."""

_DEPTH_SHARE = 1.0 / 64.0
"""Of a thing's own range of 1/w, by which its edges may come out nearer than its box."""

_CORNERS = 8
"""Of a box."""


@kernel
def _is_hidden(
    corners: F8, near: float, depth_step: float, block: int, touch: float, width: int, height: int, nearness: F8
) -> bool:
    x0, x1, y0, y1 = math.inf, -math.inf, math.inf, -math.inf
    nearest, farthest = math.inf, 0.0
    for corner in range(_CORNERS):
        w = corners[corner, 2]
        if not w > near:
            return False
        x, y = corners[corner, 0] / w, corners[corner, 1] / w
        x0, x1, y0, y1 = min(x0, x), max(x1, x), min(y0, y), max(y1, y)
        nearest, farthest = min(nearest, w), max(farthest, w)
    left, right = max(0.0, math.ceil(x0 - touch)), min(width - 1.0, math.floor(x1 + touch - 1.0))
    bottom, top = max(0.0, math.ceil(y0 - touch)), min(height - 1.0, math.floor(y1 + touch - 1.0))
    if left > right or bottom > top:
        return True
    wanted = 1.0 / nearest + depth_step + _DEPTH_SHARE * (1.0 / nearest - 1.0 / farthest)
    for row in range(int(bottom) // block, int(top) // block + 1):
        for column in range(int(left) // block, int(right) // block + 1):
            if not nearness[row, column] > wanted:
                return False
    return True


@kernel
def remove_hidden(
    items: I4,
    count: int,
    eye: F8,
    screen: F8,
    near: float,
    depth_step: float,
    block: int,
    reach: float,
    width: int,
    height: int,
    rows: I4,
    world: F8,
    middle: F8,
    half: F8,
    nearness: F8,
) -> int:
    """Take out what is hidden; what stays keeps its order.

    Args:
        items: In the frustum, [>= count], changed.
        count: How many.
        eye: World [m], [3].
        screen: World to X w, Y w [px] and w [m], from the eye, [3, 3].
        near: Distance of the near plane [m].
        depth_step: By how much 1/w has to differ to be distinguished for certain [1/m].
        block: Pixels along a side of a block.
        reach: Farthest a sample is from its pixel's middle, with the margin [px].
        width: Of the picture [px].
        height: The same.
        rows: Row of the node per item, [n].
        world: T_world_from_node per row.
        middle: Of the items' boxes in their nodes' frames [m], [n, >= 3].
        half: Half sizes of those boxes [m], [n, 3].
        nearness: 1/w of what is nearest per block [1/m], [rows, columns].

    Returns:
        How many stay.
    """
    corners = np.empty((_CORNERS, 3))
    touch = 0.5 + reach
    kept = 0
    for i in range(count):
        item = items[i]
        project_box(screen, eye, world, rows[item], middle, half, item, corners)
        if not _is_hidden(corners, near, depth_step, block, touch, width, height, nearness):
            items[kept] = item
            kept += 1
    return kept
