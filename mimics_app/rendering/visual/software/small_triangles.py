"""Choice of the state of each item in each view: triangles of a few pixels are lit at their vertices."""

from __future__ import annotations

import math
from collections.abc import Hashable

import numpy as np

from mimics_app.contracts.arrays import F8, I4, U1
from mimics_app.rendering.visual.drawing.draw_items import DrawItems
from mimics_app.rendering.visual.drawing.state_choice import StateChoice
from mimics_app.rendering.visual.software.kernels.sides import Spheres, StatesBySize, choose_states, measure_sides
from mimics_app.rendering.visual.view import View
from mimics_app.world.content.world import World

__all__ = ["SmallTriangles"]


class SmallTriangles(StateChoice):
    """States by view, with the last choice kept for hysteresis."""

    by_size = True

    def __init__(self, items: DrawItems, world: World) -> None:
        super().__init__(items, world)
        self._items, self._sides = items, _sides_of(items, world)
        self._any = bool(self._sides.any())
        self._small: dict[Hashable, U1] = {}

    def choose(
        self, key: Hashable, view: View, size: tuple[int, int], picked: I4, count: int, centres: F8, radii: F8
    ) -> None:
        items = self._items
        if self._any:
            small = self._small.setdefault(key, np.zeros(len(items.rows), np.uint8))
            near = self.limit * math.sqrt(view.window / (size[0] * size[1] * view.parts))
            eye = np.ascontiguousarray(view.eye_world)
            spheres = Spheres(centres, radii, items.local)
            states = StatesBySize(self._sides, items.states, items.small_states)
            choose_states(picked[:count], spheres, states, eye, near, small, self.states)


def _sides_of(items: DrawItems, world: World) -> F8:
    """Return the length of the sides of each item's triangles [m], [n]; 0 where it has one state, see `measure_sides`.

    A length is in the frame of the item's node.
    """
    sides, length = np.zeros(len(items.rows)), dict[int, float]()
    for item in np.flatnonzero(items.small_states >= 0).tolist():
        mesh = int(items.meshes[item])
        if mesh not in length:
            data = world.meshes[items.mesh_names[mesh]]
            length[mesh] = measure_sides(data.positions, data.indices)
        sides[item] = length[mesh]
    return sides
