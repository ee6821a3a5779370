"""A few rectangles that cover all marked cells of a grid: the bounding one, split repeatedly where that saves most."""

from __future__ import annotations

import math

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import F8, I4, U1

__all__ = ["cover_marks", "mark_cells"]


@kernel
def mark_cells(bounds: F8, width: int, height: int, margin: float, cell: int, marked: U1) -> None:
    """Mark the cells of a picture that rectangles overlap.

    Args:
        bounds: Rectangles as shares of the picture: left, right, bottom, top; [n, 4].
        width: Width of the picture [px].
        height: Height of the picture [px].
        margin: Margin around each rectangle [px].
        cell: Width of a square cell [px].
        marked: Set to 1, [rows, columns].
    """
    for i in range(bounds.shape[0]):
        left, right = bounds[i, 0] * width - margin, bounds[i, 1] * width + margin
        bottom, top = bounds[i, 2] * height - margin, bounds[i, 3] * height + margin
        if not (left < width and right > 0.0 and bottom < height and top > 0.0):
            continue
        first, last = math.floor(max(left, 0.0) / cell), math.floor(min(right, width - 1.0) / cell)
        low, high = math.floor(max(bottom, 0.0) / cell), math.floor(min(top, height - 1.0) / cell)
        for row in range(low, high + 1):
            for column in range(first, last + 1):
                marked[row, column] = 1


@kernel
def _trim(marked: U1, rect: I4) -> None:
    """Shrink a rectangle (x, y, width, height) to the marks in it; there must be at least one."""
    x, y, width, height = rect[0], rect[1], rect[2], rect[3]
    left, right, bottom, top = width, -1, height, -1
    for row in range(height):
        for column in range(width):
            if marked[y + row, x + column]:
                left, right = min(left, column), max(right, column)
                bottom, top = min(bottom, row), max(top, row)
    rect[0], rect[1], rect[2], rect[3] = x + left, y + bottom, right + 1 - left, top + 1 - bottom


@kernel
def _spans(marked: U1, rect: I4, low: I4, high: I4, columns: bool) -> None:
    """Write first and end mark of each column or row of a rectangle; its length and 0 where it has none."""
    x, y, width, height = rect[0], rect[1], rect[2], rect[3]
    lines, across = (width, height) if columns else (height, width)
    low[:lines], high[:lines] = across, 0
    for row in range(height):
        for column in range(width):
            if marked[y + row, x + column]:
                line, place = (column, row) if columns else (row, column)
                low[line], high[line] = min(low[line], place), max(high[line], place + 1)


@kernel
def _best_cut(low: I4, high: I4, lines: int, across: int, before: I4) -> tuple[int, int]:
    """Return the line before which a cut of a trimmed rectangle saves most cells, and how many it saves.

    Args:
        low: First mark of each line, [>= lines].
        high: End mark of each line, [>= lines].
        lines: Number of lines.
        across: Cells per line.
        before: Scratch, [>= lines].
    """
    lower, upper, last = across, 0, -1
    for line in range(lines):
        lower, upper = min(lower, low[line]), max(upper, high[line])
        last = line if high[line] else last
        before[line] = (last + 1) * (upper - lower)
    lower, upper, first = across, 0, lines
    best, fewest = 0, lines * across
    for line in range(lines - 1, 0, -1):
        lower, upper = min(lower, low[line]), max(upper, high[line])
        first = line if high[line] else first
        total = before[line - 1] + (lines - first) * (upper - lower)
        if total <= fewest:
            best, fewest = line, total
    return best, lines * across - fewest


@kernel
def _find_cut(marked: U1, rect: I4, spare: I4, cut: I4) -> None:
    """Write the best cut of a rectangle: the cells saved, its line, and 1 for a cut between columns."""
    _spans(marked, rect, spare[0], spare[1], True)
    across, saved_across = _best_cut(spare[0], spare[1], rect[2], rect[3], spare[2])
    _spans(marked, rect, spare[0], spare[1], False)
    along, saved_along = _best_cut(spare[0], spare[1], rect[3], rect[2], spare[2])
    if saved_across >= saved_along:
        cut[0], cut[1], cut[2] = saved_across, across, 1
    else:
        cut[0], cut[1], cut[2] = saved_along, along, 0


@kernel
def cover_marks(marked: U1, worth: float, rects: I4) -> int:
    """Cover all marks by rectangles of cells.

    Args:
        marked: 1 where a cell is marked, [rows, columns].
        worth: Minimum number of cells that a cut has to save.
        rects: Written: x, y, width, height [cells]; each wholly to the left of or below every one before it,
            [capacity, 4].

    Returns:
        Number of rectangles, at most `len(rects)`.
    """
    rows, columns = marked.shape
    if not marked.any():
        return 0
    spare, cuts = np.zeros((3, max(rows, columns)), np.int32), np.zeros((rects.shape[0], 3), np.int32)
    rects[0, 0], rects[0, 1], rects[0, 2], rects[0, 3] = 0, 0, columns, rows
    _trim(marked, rects[0])
    _find_cut(marked, rects[0], spare, cuts[0])
    count = 1
    while count < rects.shape[0]:
        number = np.argmax(cuts[:count, 0])
        saved, at, upright = cuts[number]
        if saved < worth:
            return count
        side = 0 if upright else 1
        for place in range(count, number, -1):
            rects[place], cuts[place] = rects[place - 1], cuts[place - 1]
        rects[number, side] += at
        rects[number, side + 2] -= at
        rects[number + 1, side + 2] = at
        for half in (number, number + 1):
            _trim(marked, rects[half])
            _find_cut(marked, rects[half], spare, cuts[half])
        count += 1
    return count
