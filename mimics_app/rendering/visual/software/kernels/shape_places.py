"""Places of shapes that changed: hulls of their boxes, before and after."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import B1, F8, I4, U1

__all__ = ["KNOWN", "MISSED", "FoundShapes", "ItemsOfFrame", "ShapeTable", "place_shapes"]

MISSED, KNOWN = 1, 2
"""States of a shape whose boxes were needed: not yet looked for, and looked for."""

_CORNERS = 8


class ItemsOfFrame(NamedTuple):
    """The items of a frame.

    Attributes:
        shown: Items that may be drawn, [n].
        boxes: The box of each in its node's frame [m], [n, 2, 3].
        world: T_world_from_node per row, [rows, 4, 4].
    """

    shown: B1
    boxes: F8
    world: F8


class ShapeTable(NamedTuple):
    """Shapes of items: all items of a node are one.

    Attributes:
        rows: Row of each item's node, int32 [n].
        shapes: Shape of each item, int32 [n].
        order: Items by shape, int32 [n].
        firsts: First place of each shape in `order`, and the number of items, int32 [shapes + 1].
        spans: First and end of each shape in `boxes`; equal where they are not known, int32 [shapes, 2].
        boxes: Least and greatest corner in the frame of the node [m], [boxes, 2, 3].
        corners: Corners of the boxes, world [m], [boxes, 8, 3]; changed.
        placed: 1 where `corners` are those of the last frame; changed, [shapes].
        missed: `MISSED` is written where boxes of a shape were not known, unless they are `KNOWN` not to be, [shapes].
    """

    rows: I4
    shapes: I4
    order: I4
    firsts: I4
    spans: I4
    boxes: F8
    corners: F8
    placed: U1
    missed: U1


class FoundShapes(NamedTuple):
    """Shapes that were found.

    Attributes:
        hulls: Written: corners of hulls, world [m], [capacity, 8, 3].
        starts: Written: first hull of each shape, and the number of hulls, int32 [shapes + 1].
        casts: Written: whether a shape casts shadows, [shapes].
    """

    hulls: F8
    starts: I4
    casts: B1


@kernel
def _place_box(box: F8, pose: F8, corners: F8) -> None:
    """Compute the corners in the world [8, 3] of a box in the frame of a node."""
    for corner in range(_CORNERS):
        x, y, z = box[corner & 1, 0], box[corner >> 1 & 1, 1], box[corner >> 2, 2]
        for r in range(3):
            corners[corner, r] = pose[r, 0] * x + pose[r, 1] * y + pose[r, 2] * z + pose[r, 3]


@kernel
def _place_items(items: I4, rows: I4, state: ItemsOfFrame, count: int, hulls: F8) -> int:
    """Store one box for each shown item while there is room; return the number of hulls with these."""
    shown, boxes, world = state.shown, state.boxes, state.world
    for item in items:
        if shown[item]:
            if count < hulls.shape[0]:
                _place_box(boxes[item], world[rows[item]], hulls[count])
            count += 1
    return count


@kernel
def _store(corners: F8, count: int, hulls: F8) -> int:
    """Store hulls while there is room; return the number of hulls with these."""
    for i in range(min(corners.shape[0], hulls.shape[0] - count)):
        hulls[count + i] = corners[i]
    return count + corners.shape[0]


@kernel
def _any_of(items: I4, flags: B1) -> bool:
    """Whether any of some items has a flag."""
    for item in items:
        if flags[item]:
            return True
    return False


@kernel
def _find_changed(changed: B1, shown: B1, order: I4, firsts: I4, numbers: I4) -> int:
    """Write the numbers of the shapes with changed items that are shown; return how many."""
    found = 0
    for shape in range(numbers.shape[0]):
        for item in order[firsts[shape] : firsts[shape + 1]]:
            if changed[item] and shown[item]:
                numbers[found] = shape
                found += 1
                break
    return found


@kernel
def place_shapes(
    changed: B1, was: ItemsOfFrame, now: ItemsOfFrame, casting: B1, table: ShapeTable, most: int, out: FoundShapes
) -> tuple[int, int]:
    """Store the hulls of the shapes of changed items, where they were and where they are.

    Args:
        changed: The items, [n].
        was: Items of the last frame.
        now: Those of this frame.
        casting: Items that cast shadows in either frame, [n].
        table: Their shapes.
        most: Number of shapes up to which each has several boxes.
        out: Written.

    Returns:
        Number of shapes, and of hulls; more than the capacity where they did not fit.
    """
    order, firsts, spans, rows, hulls = table.order, table.firsts, table.spans, table.rows, out.hulls
    numbers, count = np.empty(spans.shape[0], np.int32), 0
    found = _find_changed(changed, was.shown | now.shown, order, firsts, numbers)
    for i in range(found):
        shape = numbers[i]
        items, first, end = order[firsts[shape] : firsts[shape + 1]], spans[shape, 0], spans[shape, 1]
        out.starts[i], out.casts[i] = count, _any_of(items, casting)
        if table.placed[shape]:
            count = _store(table.corners[first:end], count, hulls)
        else:
            count = _place_items(items, rows, was, count, hulls)
        table.placed[shape] = first < end and found <= most and _any_of(items, now.shown)
        if table.placed[shape]:
            for box in range(first, end):
                _place_box(table.boxes[box], now.world[rows[items[0]]], table.corners[box])
            count = _store(table.corners[first:end], count, hulls)
        else:
            count = _place_items(items, rows, now, count, hulls)
            table.missed[shape] = max(table.missed[shape], MISSED)
    out.starts[found] = count
    return found, count
