"""Screen rectangles of sets of points, and a few rectangles that cover all of them."""

from __future__ import annotations

import itertools

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.rendering.visual.kernels.screen_bounds import bound_balls
from mimics_app.rendering.visual.kernels.screen_cover import cover_marks, mark_cells
from mimics_app.rendering.visual.view import Rect, View

__all__ = ["box_corners", "cover_of", "screen_bounds"]


_SIGNS = np.array(list(itertools.product((-1.0, 1.0), repeat=3)))

_CELL = 16
"""Width of the square cells that rectangles consist of [px]."""

_MAX_PARTS, _WORTH = 4, 0.04
"""Maximum number of rectangles, and minimum share of the picture that a cut has to save: beyond these, vertex
processing costs more than the pixels saved."""

_MARGIN_PX = 2.0
"""Margin for the samples of a pixel and for rounding."""


def box_corners(centres: F8, axes: F8) -> F8:
    """Return the corners of boxes [m], [n, 8, 3], given centres [n, 3] and half edges as columns of [n, 3, 3]."""
    return np.asarray(centres[:, None] + _SIGNS @ axes.transpose(0, 2, 1))


def screen_bounds(view: View, points: F8, radii: F8) -> F8:
    """Return left, right, bottom, top of the convex hulls of sets of balls, as shares of the picture; [m, 4].

    Hulls behind the near plane are left out; the rectangle of one that crosses it may be far too large.

    Args:
        view: The view.
        points: Centres of each set's balls, world [m], [n, k, 3].
        radii: Radius of each set's balls [m], [n].
    """
    bounds = np.empty((len(points), 4))
    pose, tangents = np.ascontiguousarray(view.world_from_eye), np.array(view.tangents)
    return bounds[: bound_balls(np.ascontiguousarray(points), radii, pose, tangents, view.near, bounds)]


def cover_of(bounds: F8, size: tuple[int, int]) -> list[Rect]:
    """Return a few disjoint rectangles of whole cells that cover many rectangles [px].

    Args:
        bounds: Rectangles as shares of the picture: left, right, bottom, top; [n, 4].
        size: Size of the picture [px].
    """
    width, height = size
    marked = np.zeros((-(-height // _CELL), -(-width // _CELL)), np.uint8)
    mark_cells(bounds, width, height, _MARGIN_PX, _CELL, marked)
    rects = np.zeros((_MAX_PARTS, 4), np.int32)
    covered = []
    for x, y, wide, high in rects[: cover_marks(marked, _WORTH * marked.size, rects)].tolist():
        left, bottom = x * _CELL, y * _CELL
        covered.append(
            (left, bottom, min(width, left + wide * _CELL) - left, min(height, bottom + high * _CELL) - bottom)
        )
    return covered
