"""Hierarchical frustum culling by the scene graph: one test culls everything below a group that is outside.

The tree is a list in depth-first order: the entries below a group follow it, up to its skip index. Long rows of
siblings are split into groups of spatial neighbours.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import F8, I4, U1
from mimics_app.rendering.visual.kernels.frustum import is_seen

__all__ = ["Bounds", "Entries", "build_tree", "count_below", "cull_tree", "refit_tree"]


_FAN_OUT = 8
"""Maximum number of siblings in a group before it is split."""

_NODE, _ROW, _OPEN, _CLOSE = 0, 1, 2, 3


class Entries(NamedTuple):
    """The tree as a list.

    Attributes:
        items: An item, or -1 - group, [count].
        skips: Index after the last entry below each entry, [count].
        boxes: Bounding boxes of the groups, see `refit_tree`.
    """

    items: I4
    skips: I4
    boxes: F8


class Bounds(NamedTuple):
    """Where the items are.

    Attributes:
        centres: Centres of the spheres, world [m], [n, 3].
        radii: Their radii [m], [n].
        half: Half extents of the boxes around the same centres, in their nodes' frames [m], [n, 3].
    """

    centres: F8
    radii: F8
    half: F8


@kernel
def count_below(parents: I4, items_of: I4, out: I4) -> None:
    """Count the items on each row and below it; parents come before their children.

    Args:
        parents: Row of each row's parent, -1: none; [rows].
        items_of: Items on each row itself, [rows].
        out: Written, [rows].
    """
    out[:] = items_of
    for row in range(parents.shape[0] - 1, -1, -1):
        if parents[row] >= 0:
            out[parents[row]] += out[row]


@kernel
def _push_siblings(children: I4, below: I4, a: int, b: int, stack: I4, height: int) -> int:
    """Push siblings onto the stack, one by one or, if many, in groups; return the stack's height."""
    if b - a > _FAN_OUT:
        step = (b - a + _FAN_OUT - 1) // _FAN_OUT
        for part in range(a, b, step):
            stack[height, 0], stack[height, 1], stack[height, 2] = _OPEN, part, min(part + step, b)
            height += 1
        return height
    for k in range(a, b):
        if below[children[k]]:
            stack[height, 0], stack[height, 1] = _NODE, children[k]
            height += 1
    return height


@kernel
def build_tree(
    children: I4,
    first_child: I4,
    items: I4,
    first_item: I4,
    below: I4,
    stack: I4,
    entries: I4,
    skips: I4,
    above: I4,
) -> tuple[int, int]:
    """Build the list of entries.

    Args:
        children: Rows sorted by parent, then by position, roots first; [rows].
        first_child: Index in `children` of each row's first child, roots at 0; [rows + 2].
        items: Items sorted by row, [n].
        first_item: Index in `items` of each row's first item, [rows + 1].
        below: Number of items on each row and below it, [rows].
        stack: Scratch, [>= 4 rows + 64, 3].
        entries: Written: an item, or -1 - group; [>= n + groups].
        skips: Written: index after the last entry below each entry, [>= n + groups].
        above: Written: enclosing group of each group, -1: none; [>= groups].

    Returns:
        Number of entries and of groups.
    """
    count = groups = 0
    current = -1
    stack[0, 0], stack[0, 1], stack[0, 2] = _ROW, first_child[0], first_child[1]
    height = 1
    starts = np.zeros(above.shape[0], np.int32)
    while height:
        height -= 1
        kind, a, b = stack[height, 0], stack[height, 1], stack[height, 2]
        if kind == _CLOSE:
            skips[starts[a]] = count
            current = above[a]
        elif kind == _ROW:
            height = _push_siblings(children, below, a, b, stack, height)
        else:
            grouped = kind == _OPEN or below[a] > 1
            if grouped:
                entries[count], above[groups], starts[groups] = -1 - groups, current, count
                current = groups
                count, groups = count + 1, groups + 1
                stack[height, 0], stack[height, 1] = _CLOSE, current
                height += 1
            if kind == _NODE:
                for k in range(first_item[a], first_item[a + 1]):
                    entries[count], skips[count] = items[k], count + 1
                    count += 1
                b = first_child[a + 2]
                a = first_child[a + 1]
            stack[height, 0], stack[height, 1], stack[height, 2] = _ROW, a, b
            height += 1
    return count, groups


@kernel
def refit_tree(entries: I4, count: int, above: I4, groups: int, holders: I4, centres: F8, radii: F8, boxes: F8) -> None:
    """Compute the groups' bounding boxes in the world from the spheres of the items below.

    Args:
        entries: See `build_tree`.
        count: Number of entries.
        above: Enclosing group of each group.
        groups: Number of groups.
        holders: Innermost group of each entry, -1: none; [>= count].
        centres: Centres of the items' spheres, world [m], [n, 3].
        radii: Their radii [m], [n].
        boxes: Written: minimum and maximum corner [m], [>= groups, 2, 3].
    """
    for group in range(groups):
        for k in range(3):
            boxes[group, 0, k], boxes[group, 1, k] = math.inf, -math.inf
    for e in range(count):
        item, group = entries[e], holders[e]
        if item >= 0 and group >= 0:
            for k in range(3):
                boxes[group, 0, k] = min(boxes[group, 0, k], centres[item, k] - radii[item])
                boxes[group, 1, k] = max(boxes[group, 1, k], centres[item, k] + radii[item])
    for group in range(groups - 1, -1, -1):
        upper = above[group]
        if upper >= 0:
            for k in range(3):
                boxes[upper, 0, k] = min(boxes[upper, 0, k], boxes[group, 0, k])
                boxes[upper, 1, k] = max(boxes[upper, 1, k], boxes[group, 1, k])


@kernel
def _classify(planes: F8, boxes: F8, group: int) -> int:
    """Return -1 for a box wholly outside one plane, 1 for one inside all, 0 otherwise."""
    inside = 1
    for p in range(planes.shape[0]):
        depth, reach = planes[p, 3], 0.0
        for k in range(3):
            depth += 0.5 * planes[p, k] * (boxes[group, 0, k] + boxes[group, 1, k])
            reach += 0.5 * abs(planes[p, k]) * (boxes[group, 1, k] - boxes[group, 0, k])
        if depth < -reach:
            return -1
        if not depth >= reach:
            inside = 0
    return inside


@kernel
def cull_tree(planes: F8, shown: U1, rows: I4, world: F8, bounds: Bounds, entries: Entries, out: I4) -> tuple[int, int]:
    """Cull groups first: items of a group outside are skipped, those of a group inside are accepted without a test.

    Args:
        planes: Unit normals inwards and offsets, [k, 4].
        shown: 1 where the item may be drawn at all, [n].
        rows: Row of the node per item, [n].
        world: T_world_from_node per row, [rows, 4, 4].
        bounds: Where the items are.
        entries: The tree.
        out: Written: numbers of the items not wholly outside, [n].

    Returns:
        Number of items, and of tests.
    """
    centres, radii, half = bounds
    items, skips, boxes = entries
    found = tests = 0
    e = within = 0
    while e < items.shape[0]:
        item = items[e]
        if item < 0:
            if e < within:
                e += 1
                continue
            tests += 1
            where = _classify(planes, boxes, -1 - item)
            if where < 0:
                e = skips[e]
                continue
            if where > 0:
                within = skips[e]
        elif shown[item]:
            seen = e < within
            if not seen:
                tests += 1
                seen = is_seen(planes, item, rows[item], centres, radii, half, world)
            if seen:
                out[found] = item
                found += 1
        e += 1
    return found, tests
