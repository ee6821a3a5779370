"""Screen rectangles of sets of points, and a few rectangles that cover all of them."""

from __future__ import annotations

import numpy as np

from mimics_app.contracts.arrays import F8, U1
from mimics_app.rendering.visual.changed_part import ChangedPart
from mimics_app.rendering.visual.software.kernels.screen_bounds import bound_balls
from mimics_app.rendering.visual.software.kernels.screen_cover import cover_marks, mark_cells
from mimics_app.rendering.visual.view import Rect, View

__all__ = ["cell_tangent", "cover_of", "mark_cells_of", "parts_of", "pieces_of", "screen_bounds"]


_CELL = 16
"""Width of the square cells that rectangles consist of [px]."""

_MAX_PARTS, _WORTH = 4, 0.04
"""Maximum number of rectangles, and minimum share of the picture that a cut has to save: beyond these, vertex
processing costs more than the pixels saved."""

_MAX_PIECES, _WORTH_OF_PIECE = 24, 0.002
"""Likewise for the pieces of all rectangles, beyond which filling them costs more than the pixels saved."""

_MARGIN_PX = 3.0
"""Margin for the samples of a pixel, for rounding, and for the edges beside what changed."""


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


def cell_tangent(view: View, width: int) -> float:
    """Return the width at distance 1 of a cell of a view's picture, which is `width` wide [px]."""
    return _CELL * (view.tangents[1] - view.tangents[0]) / width


def cover_of(bounds: F8, size: tuple[int, int]) -> list[ChangedPart]:
    """Return a few disjoint rectangles of whole cells that cover many rectangles, with the pieces of each.

    Each rectangle is wholly to the left of or below every one before it.

    Args:
        bounds: Rectangles as shares of the picture: left, right, bottom, top; [n, 4].
        size: Size of the picture [px].
    """
    marked = mark_cells_of(bounds, size)
    parts, pieces = _cover(marked, _MAX_PARTS, _WORTH, size), pieces_of(marked, size)
    # Pieces are cut out of the parts: the cuts that save most come first.
    return [ChangedPart(part, [piece for piece in pieces if _holds(part, piece)]) for part in parts]


def parts_of(bounds: F8, size: tuple[int, int]) -> list[Rect]:
    """Return the rectangles of `cover_of` alone."""
    return _cover(mark_cells_of(bounds, size), _MAX_PARTS, _WORTH, size)


def pieces_of(marked: U1, size: tuple[int, int]) -> list[Rect]:
    """Return the pieces of `cover_of` alone, given the cells that they cover."""
    return _cover(marked, _MAX_PIECES, _WORTH_OF_PIECE, size)


def mark_cells_of(bounds: F8, size: tuple[int, int]) -> U1:
    """Return 1 for each cell that rectangles overlap, see `cover_of`; uint8 [rows, columns]."""
    width, height = size
    marked = np.zeros((-(-height // _CELL), -(-width // _CELL)), np.uint8)
    mark_cells(bounds, width, height, _MARGIN_PX, _CELL, marked)
    return marked


def _cover(marked: U1, most: int, worth: float, size: tuple[int, int]) -> list[Rect]:
    """Return rectangles within the picture that cover all marks, see `cover_marks`."""
    rects, (across, up) = np.zeros((most, 4), np.int32), size
    found = rects[: cover_marks(marked, worth * marked.size, rects)] * _CELL
    return [(x, y, min(wide, across - x), min(high, up - y)) for x, y, wide, high in found.tolist()]


def _holds(part: Rect, piece: Rect) -> bool:
    return part[0] <= piece[0] < part[0] + part[2] and part[1] <= piece[1] < part[1] + part[3]
