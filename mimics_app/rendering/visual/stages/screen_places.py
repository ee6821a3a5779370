"""Where sets of points are on the screen, and few rectangles that hold all of them."""

from __future__ import annotations

import itertools

import numpy as np
from numpy.typing import NDArray

from mimics_app.rendering.visual.kernels.screen_bounds import bound_balls
from mimics_app.rendering.visual.kernels.screen_cover import cover_marks, mark_cells
from mimics_app.rendering.visual.view import Rect, View

__all__ = ["box_corners", "cover_of", "screen_bounds"]

F8 = NDArray[np.float64]

_SIGNS = np.array(list(itertools.product((-1.0, 1.0), repeat=3)))

_CELL = 16
"""Side of the squares that rectangles are made of [px]."""

_MOST_PARTS, _WORTH = 4, 0.04
"""More rectangles than these, or a cut that leaves out less of the picture, cost more by corners than they save."""

_MARGIN_PX = 2.0
"""About everything: samples of a pixel, and rounding."""


def box_corners(centres: F8, axes: F8) -> F8:
    """Corners of boxes [m], [n, 8, 3], by their middles [n, 3] and half edges, which are the columns of [n, 3, 3]."""
    return np.asarray(centres[:, None] + _SIGNS @ axes.transpose(0, 2, 1))


def screen_bounds(view: View, points: F8, radii: F8) -> F8:
    """Rectangles about the convex hulls of sets of balls, as shares of the picture: left, right, bottom, top; [m, 4].

    Hulls behind the near plane are left out; of one that reaches through it the rectangle may be far too large.

    Args:
        view: From where.
        points: Middles of each set's balls, world [m], [n, k, 3].
        radii: Of each set's balls [m], [n].
    """
    bounds = np.empty((len(points), 4))
    pose, tangents = np.ascontiguousarray(view.world_from_eye), np.array(view.tangents)
    return bounds[: bound_balls(np.ascontiguousarray(points), radii, pose, tangents, view.near, bounds)]


def cover_of(bounds: F8, size: tuple[int, int]) -> list[Rect]:
    """A few rectangles, of whole cells of the picture, that hold all of many and lie apart.

    Args:
        bounds: As shares of the picture: left, right, bottom, top; [n, 4].
        size: Of the picture [px].
    """
    width, height = size
    marked = np.zeros((-(-height // _CELL), -(-width // _CELL)), np.uint8)
    mark_cells(bounds, width, height, _MARGIN_PX, _CELL, marked)
    rects = np.zeros((_MOST_PARTS, 4), np.int32)
    covered = []
    for x, y, wide, high in rects[: cover_marks(marked, _WORTH * marked.size, rects)].tolist():
        left, bottom = x * _CELL, y * _CELL
        covered.append(
            (left, bottom, min(width, left + wide * _CELL) - left, min(height, bottom + high * _CELL) - bottom)
        )
    return covered
