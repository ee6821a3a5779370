"""Frustum culling: every item on its own, or groups of the scene graph first."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from mimics_app.contracts.arrays import F8, I4, I8, U1
from mimics_app.rendering.visual.drawing.draw_items import DrawItems
from mimics_app.rendering.visual.kernels.frustum import cull_flat
from mimics_app.rendering.visual.kernels.tree import Bounds, Entries, build_tree, count_below, cull_tree, refit_tree
from mimics_app.rendering.visual.settings import Culling

__all__ = ["Culler", "FlatCuller", "TreeCuller", "make_culler"]


_TREE_FROM = 20_000
"""Number of items from which the tree is faster than testing all, where most are outside (chart "culling")."""

_MORTON_BITS = 10


class Culler(Protocol):
    """Finds the items in a frustum.

    Attributes:
        tests: Frustum tests of items and groups since `moved` was last called.
    """

    tests: int

    def moved(self, items: int, centres: F8, radii: F8) -> None:
        """Called once per frame with the number of items that moved, and all bounding spheres, world [m]."""

    def cull(self, planes: F8, shown: U1, world: F8, centres: F8, radii: F8, out: I4) -> int:
        """Write the numbers of the items that are not wholly outside; return how many.

        Args:
            planes: Unit normals inwards and offsets, [k, 4].
            shown: 1 where the item may be drawn at all, [n].
            world: T_world_from_node per row, [rows, 4, 4].
            centres: Centres of the items' spheres, world [m], [n, 3].
            radii: Their radii [m], [n].
            out: Written: numbers of items, [n].
        """
        ...


class FlatCuller(Culler):
    """Tests every item."""

    def __init__(self, items: DrawItems) -> None:
        self._items = items
        self.tests = 0

    def moved(self, items: int, centres: F8, radii: F8) -> None:
        self.tests = 0

    def cull(self, planes: F8, shown: U1, world: F8, centres: F8, radii: F8, out: I4) -> int:
        self.tests += int(np.count_nonzero(shown))
        return cull_flat(planes, shown, self._items.rows, world, centres, radii, self._items.half, out)


class TreeCuller(Culler):
    """Tests groups of the scene graph first.

    Args:
        items: The draw items.
        parents: Row of each row's parent, less than the own row; -1: none; int32 [rows].
        places: Position of each row's node in the world, float64 [rows, 3]: neighbours are grouped together.
    """

    def __init__(self, items: DrawItems, parents: I4, places: F8) -> None:
        self._items = items
        self.tests = 0
        rows, count = len(parents), len(items.rows)
        items_of = np.bincount(items.rows, minlength=rows).astype(np.int32)
        by_row = np.argsort(items.rows, kind="stable").astype(np.int32)
        first_item = np.concatenate([[0], np.cumsum(items_of)]).astype(np.int32)
        below = np.zeros(rows, np.int32)
        count_below(parents, items_of, below)
        children = np.lexsort((_morton(places), parents)).astype(np.int32)
        first_child = np.searchsorted(parents[children], np.arange(-1, rows + 1)).astype(np.int32)
        capacity = 2 * rows + count + 64
        entries, skips, above = (np.zeros(capacity, np.int32) for _ in range(3))
        stack = np.zeros((2 * capacity, 3), np.int32)
        built = build_tree(children, first_child, by_row, first_item, below, stack, entries, skips, above)
        self._count, self._groups = built
        self._entries, self._skips = entries[: self._count].copy(), skips[: self._count].copy()
        self._above = above[: self._groups].copy()
        self._holders = _holders(self._entries, self._skips, self._above)
        self._boxes = np.zeros((self._groups, 2, 3))
        self._fitted = False

    def moved(self, items: int, centres: F8, radii: F8) -> None:
        self.tests = 0
        if items or not self._fitted:
            self._fitted = True
            refit_tree(
                self._entries, self._count, self._above, self._groups, self._holders, centres, radii, self._boxes
            )

    def cull(self, planes: F8, shown: U1, world: F8, centres: F8, radii: F8, out: I4) -> int:
        count, tests = cull_tree(
            planes,
            shown,
            self._items.rows,
            world,
            Bounds(centres, radii, self._items.half),
            Entries(self._entries, self._skips, self._boxes),
            out,
        )
        self.tests += tests
        return count


def make_culler(wanted: Culling, items: DrawItems, parents: I4, places: F8) -> Culler:
    """Return the requested culler; "auto" chooses by the number of items."""
    if wanted == "tree" or (wanted == "auto" and len(items.rows) >= _TREE_FROM):
        return TreeCuller(items, parents, places)
    return FlatCuller(items)


def _holders(entries: I4, skips: I4, above: I4) -> I4:
    """Return the innermost group of each entry that is an item, -1: none."""
    holders = np.full(len(entries), -1, np.int32)
    starts = np.flatnonzero(entries < 0)
    # Inner groups come later and overwrite the number of their outer group.
    for start in starts.tolist():
        holders[start + 1 : skips[start]] = -1 - entries[start]
    return holders


def _morton(places: F8) -> I8:
    """Return Morton codes of positions, [n]: bits of x, y and z interleaved (Morton 1966)."""
    lower = places.min(axis=0, initial=np.inf)
    extent = np.maximum(places.max(axis=0, initial=-np.inf) - lower, 1e-300)
    steps = np.clip((places - lower) / extent * (2**_MORTON_BITS - 1), 0, 2**_MORTON_BITS - 1).astype(np.int64)
    code = np.zeros(len(places), np.int64)
    for bit in range(_MORTON_BITS):
        for axis in range(3):
            code |= ((steps[:, axis] >> bit) & 1) << (3 * bit + axis)
    return code
