"""Choice of the state of each item in each view: triangles of a few pixels are lit at their vertices."""

from __future__ import annotations

import math
from collections.abc import Hashable

import numpy as np

from mimics_app.contracts.arrays import F8, I4, U1
from mimics_app.rendering.visual.drawing.draw_items import DrawItems
from mimics_app.rendering.visual.kernels.sides import choose_states
from mimics_app.rendering.visual.view import View

__all__ = ["SmallTriangles"]


class SmallTriangles:
    """States by view, with the last choice kept for hysteresis.

    Args:
        items: The draw items.

    Attributes:
        states: State of each item that was picked for the last choice, int32 [n].
        limit: Length of a side up to which triangles are small [px].
    """

    def __init__(self, items: DrawItems) -> None:
        self._items = items
        self._any = bool(items.sides.any())
        self._small: dict[Hashable, U1] = {}
        self.states = items.states.copy()
        self.limit = 0.0

    def choose(
        self, key: Hashable, view: View, size: tuple[int, int], picked: I4, count: int, centres: F8, radii: F8
    ) -> I4:
        """Choose the states of the first `count` of `picked`; return `states`.

        Args:
            key: Identifies the view from frame to frame.
            view: The view; a part of a picture has the states of the whole picture.
            size: Size as drawn [px].
            picked: Numbers of items, [>= count].
            count: Number of items.
            centres: Centres of the items' spheres, world [m], [n, 3].
            radii: Their radii [m], [n].
        """
        items = self._items
        if self._any:
            small = self._small.setdefault(key, np.zeros(len(items.rows), np.uint8))
            near = self.limit * math.sqrt(view.window / (size[0] * size[1] * view.parts))
            eye = np.ascontiguousarray(view.eye_world)
            spheres = (centres, radii, items.local)
            kinds = (items.sides, items.states, items.small_states)
            choose_states(picked, count, *spheres, *kinds, eye, near, small, self.states)
        return self.states
