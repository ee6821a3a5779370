"""Choice of the state that each item of a view is drawn in."""

from __future__ import annotations

from collections.abc import Hashable

from mimics_app.contracts.arrays import F8, I4
from mimics_app.rendering.visual.drawing.draw_items import DrawItems
from mimics_app.rendering.visual.view import View
from mimics_app.world.content.world import World

__all__ = ["StateChoice"]


class StateChoice:
    """On a graphics card each item has one state, however large its triangles are on the picture.

    Args:
        items: The draw items.
        world: Their world.

    Attributes:
        by_size: Whether items may have another state for small triangles.
        states: State of each item that was picked for the last choice, int32 [n].
        limit: Length of a side up to which triangles are small [px].
    """

    by_size = False

    def __init__(self, items: DrawItems, world: World) -> None:
        self.states = items.states.copy()
        self.limit = 0.0

    def choose(
        self, key: Hashable, view: View, size: tuple[int, int], picked: I4, count: int, centres: F8, radii: F8
    ) -> None:
        """Choose the states of the first `count` of `picked`.

        Args:
            key: Identifies the view from frame to frame.
            view: The view; a part of a picture has the states of the whole picture.
            size: Size as drawn [px].
            picked: Numbers of items, [>= count].
            count: Number of items.
            centres: Centres of the items' spheres, world [m], [n, 3].
            radii: Their radii [m], [n].
        """
