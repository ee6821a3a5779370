"""Where sets of points are on the screen, and few rectangles that hold all of them."""

from __future__ import annotations

import itertools

import numpy as np
from numpy.typing import NDArray

from mimics_app.rendering.visual.view import Rect, View

__all__ = ["balls_about", "box_corners", "cover_of", "screen_bounds"]

F8 = NDArray[np.float64]

_SIGNS = np.array(list(itertools.product((-1.0, 1.0), repeat=3)))
_OCTAHEDRON = 3.0**0.5 * np.concatenate([np.eye(3), -np.eye(3)])
"""Corners of the one that holds the unit ball."""

_CELL = 16
"""Side of the squares that rectangles are made of [px]."""

_MOST_PARTS, _WORTH = 4, 0.04
"""More rectangles than these, or a cut that leaves out less of the picture, cost more by corners than they save."""

_MARGIN_PX = 2.0
"""About everything: samples of a pixel, and rounding."""


def box_corners(centres: F8, axes: F8) -> F8:
    """Corners of boxes [m], [n, 8, 3], by their middles [n, 3] and half edges, which are the columns of [n, 3, 3]."""
    return np.asarray(centres[:, None] + np.einsum("nij,kj->nki", axes, _SIGNS))


def balls_about(points: F8, radii: F8) -> F8:
    """Points whose convex hull holds balls about the points of each set [m], [n, 6 k, 3].

    Args:
        points: [n, k, 3].
        radii: Of each set's balls, [n].
    """
    around = points[:, :, None] + radii[:, None, None, None] * _OCTAHEDRON
    return np.asarray(around.reshape(len(points), 6 * points.shape[1], 3))


def screen_bounds(view: View, points: F8) -> F8:
    """Rectangles about the convex hulls of sets of points, as shares of the picture: left, right, bottom, top; [m, 4].

    Hulls behind the near plane are left out; of one that reaches through it the rectangle may be far too large.

    Args:
        view: From where.
        points: World [m], [n, k, 3].
    """
    left, right, bottom, top = view.tangents
    seen = (points - view.world_from_eye[:3, 3]) @ view.world_from_eye[:3, :3]
    away = -seen[..., 2]
    before = away.max(axis=1) >= view.near
    seen, away = seen[before], away[before]
    through = away.min(axis=1) < view.near
    least, most = seen[..., :2].min(axis=1), seen[..., :2].max(axis=1)
    ends = np.stack([np.full(len(away), view.near), away.max(axis=1, initial=view.near)], axis=1)
    low = (least[:, None] / ends[..., None]).min(axis=1)
    high = (most[:, None] / ends[..., None]).max(axis=1)
    shown = seen[..., :2] / np.maximum(away, view.near)[..., None]
    low = np.where(through[:, None], low, shown.min(axis=1))
    high = np.where(through[:, None], high, shown.max(axis=1))
    bounds = np.stack([low[:, 0], high[:, 0], low[:, 1], high[:, 1]], axis=1)
    shares = (bounds - [left, left, bottom, bottom]) / [right - left, right - left, top - bottom, top - bottom]
    return np.asarray(shares)


def cover_of(bounds: F8, size: tuple[int, int]) -> list[Rect]:
    """A few rectangles, of whole cells of the picture, that hold all of many and lie apart.

    Args:
        bounds: As shares of the picture: left, right, bottom, top; [n, 4].
        size: Of the picture [px].
    """
    width, height = size
    pixels = bounds * [width, width, height, height] + _MARGIN_PX * np.array([-1.0, 1.0, -1.0, 1.0])
    inside = (pixels[:, 0] < width) & (pixels[:, 1] > 0.0) & (pixels[:, 2] < height) & (pixels[:, 3] > 0.0)
    ends = [width - 1.0, width - 1.0, height - 1.0, height - 1.0]
    cells = np.floor(np.clip(pixels[inside], 0.0, ends) / _CELL).astype(int)
    marked = np.zeros((-(-height // _CELL), -(-width // _CELL)), np.bool_)
    for first, last, low, high in np.unique(cells, axis=0).tolist():
        marked[low : high + 1, first : last + 1] = True
    covered = []
    for x, y, wide, high in _cover(marked):
        left, bottom = x * _CELL, y * _CELL
        covered.append(
            (left, bottom, min(width, left + wide * _CELL) - left, min(height, bottom + high * _CELL) - bottom)
        )
    return covered


def _cover(marked: NDArray[np.bool_]) -> list[Rect]:
    """Rectangles of cells about all marks: the one about all, cut in two where that leaves out most, and so on."""
    if not marked.any():
        return []
    found = [_trimmed(marked, (0, 0, marked.shape[1], marked.shape[0]))]
    while len(found) < _MOST_PARTS:
        cuts = [_best_cut(marked, rect) for rect in found]
        best = max(range(len(found)), key=lambda number: cuts[number][0])
        gain, halves = cuts[best]
        if gain < _WORTH * marked.size:
            break
        found[best : best + 1] = halves
    return found


def _best_cut(marked: NDArray[np.bool_], rect: Rect) -> tuple[int, list[Rect]]:
    """How many cells a cut of a rectangle leaves out at most, and the two halves; none where it leaves out nothing."""
    x, y, width, height = rect
    inside = marked[y : y + height, x : x + width]
    across, saved_across = _cut(inside)
    along, saved_along = _cut(inside.T)
    if max(saved_across, saved_along) <= 0:
        return 0, []
    if saved_across >= saved_along:
        halves = [(x, y, across, height), (x + across, y, width - across, height)]
    else:
        halves = [(x, y, width, along), (x, y + along, width, height - along)]
    return max(saved_across, saved_along), [_trimmed(marked, half) for half in halves]


def _cut(inside: NDArray[np.bool_]) -> tuple[int, int]:
    """Before which column a cut leaves out most of a trimmed rectangle, and how many cells that is."""
    rows, columns = inside.shape
    if columns < 2:
        return 0, 0
    some, numbers = inside.any(axis=0), np.arange(columns)
    low = np.where(some, inside.argmax(axis=0), rows)
    high = np.where(some, rows - inside[::-1].argmax(axis=0), 0)
    last = np.maximum.accumulate(np.where(some, numbers, -1))
    first = np.minimum.accumulate(np.where(some, numbers, columns)[::-1])[::-1]
    before = (last + 1) * (np.maximum.accumulate(high) - np.minimum.accumulate(low))
    upper, lower = np.maximum.accumulate(high[::-1])[::-1], np.minimum.accumulate(low[::-1])[::-1]
    behind = (columns - first) * (upper - lower)
    total = before[:-1] + behind[1:]
    best = int(np.argmin(total))
    return best + 1, int(rows * columns - total[best])


def _trimmed(marked: NDArray[np.bool_], rect: Rect) -> Rect:
    """The smallest rectangle about the marks in one."""
    x, y, width, height = rect
    inside = marked[y : y + height, x : x + width]
    columns, rows = np.flatnonzero(inside.any(axis=0)), np.flatnonzero(inside.any(axis=1))
    left, bottom = int(columns[0]), int(rows[0])
    return x + left, y + bottom, int(columns[-1]) + 1 - left, int(rows[-1]) + 1 - bottom
