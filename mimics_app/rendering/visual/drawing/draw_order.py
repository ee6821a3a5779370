"""Draw order of the picked items, with scratch memory kept from frame to frame."""

from __future__ import annotations

import numpy as np

from mimics_app.contracts.arrays import F8, I4, U1
from mimics_app.rendering.visual.drawing.draw_items import DrawItems
from mimics_app.rendering.visual.kernels.order import make_keys, rank_states, sort_by_key

__all__ = ["DrawOrder"]


class DrawOrder:
    """Sorts by state, then from near to far, then by mesh.

    Args:
        items: The draw items.
    """

    def __init__(self, items: DrawItems) -> None:
        count, states = len(items.rows), 2 * max(len(items.of_state), len(items.of_shadow))
        self._items = items
        self._keys, self._spare_keys = np.zeros(count, np.uint64), np.zeros(count, np.uint64)
        self._spare_items = np.zeros(count, np.int32)
        self._away = np.zeros(count, np.float32)
        self._nearest, self._ranks = np.zeros(states), np.zeros(states, np.int32)
        self._digits = np.zeros((8, 256), np.int32)

    def sort(
        self,
        picked: I4,
        count: int,
        eye: F8,
        centres: F8,
        radii: F8,
        states: I4,
        mirrored: U1,
        ranks: I4 | None = None,
    ) -> None:
        """Sort the first `count` of `picked` in place.

        Args:
            picked: Numbers of items, [>= count].
            count: Number of items.
            eye: Origin of the distances, world [m], [3].
            centres: Centres of all items' spheres, world [m], [n, 3].
            radii: Their radii [m], [n].
            states: State of each item before mirroring, [n].
            mirrored: 1 where the winding of an item's faces is reversed, [n].
            ranks: Ranks of the states, see `rank`; None: those by these items.
        """
        if ranks is None:
            ranks = self.rank(picked, count, eye, centres, radii, states, mirrored)
        make_keys(
            picked,
            count,
            eye,
            centres,
            radii,
            states,
            mirrored,
            self._items.meshes,
            ranks,
            self._away,
            self._keys,
        )
        sort_by_key(self._keys, picked, count, self._spare_keys, self._spare_items, self._digits)

    def rank(self, picked: I4, count: int, eye: F8, centres: F8, radii: F8, states: I4, mirrored: U1) -> I4:
        """Return the ranks of the states by the nearest of some items, see `sort`; valid until the next call."""
        rank_states(picked, count, eye, centres, radii, states, mirrored, self._nearest, self._ranks)
        return self._ranks
