"""Draw order of the picked items, with scratch memory kept from frame to frame."""

from __future__ import annotations

import numpy as np

from mimics_app.contracts.arrays import F8, I4, U1
from mimics_app.rendering.visual.drawing.draw_items import DrawItems
from mimics_app.rendering.visual.kernels.order import Sorted, make_keys, sort_by_key

__all__ = ["DrawOrder"]


class DrawOrder:
    """Sorts by layer of distance, state, distance from near to far, and mesh.

    Args:
        items: The draw items.
    """

    def __init__(self, items: DrawItems) -> None:
        count = len(items.rows)
        self._items = items
        self._keys, self._spare_keys = np.zeros(count, np.uint64), np.zeros(count, np.uint64)
        self._spare_items = np.zeros(count, np.int32)
        self._away = np.zeros(count, np.float32)
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
        *,
        layered: bool,
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
            layered: False sorts by states first.
        """
        by = Sorted(centres, radii, states, mirrored, self._items.meshes)
        make_keys(picked, count, eye, by, layered, self._away, self._keys)
        sort_by_key(self._keys, picked, count, self._spare_keys, self._spare_items, self._digits)
