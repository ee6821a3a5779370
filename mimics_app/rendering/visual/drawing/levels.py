"""Choice of the level of detail of each body in each view."""

from __future__ import annotations

from collections.abc import Hashable

import numpy as np

from mimics_app.contracts.arrays import F8, I4, U1
from mimics_app.rendering.visual.drawing.draw_items import DrawItems
from mimics_app.rendering.visual.kernels.levels import choose_for_texels, choose_levels, show_levels
from mimics_app.rendering.visual.view import View
from mimics_app.world.content.world import World
from mimics_app.world.graph.levels import COVERED_PICTURE

__all__ = ["Levels", "fewer_pixels"]

_MIN_PIXELS = 480.0 * 270.0
"""Pixels from which levels go by coverage alone; in a smaller picture the same coverage has fewer pixels, and levels
are chosen with the error in pixels of a picture of this size."""

_FILTER = 2.0
"""Width of the shadow filter (shaders/common/shadow.glsl) that has half the weight of its 3 x 3 texels [texel]."""


def fewer_pixels(view: View, size: tuple[int, int]) -> float:
    """Return `_MIN_PIXELS` over the pixels of the whole picture, at least 1.

    Args:
        view: View of the picture, or of a part of it.
        size: Size as drawn [px].
    """
    return max(1.0, _MIN_PIXELS / (size[0] * size[1] * view.parts))


class Levels:
    """Levels of detail by view, with the last choice kept for hysteresis.

    Args:
        world: The world.
        items: Its sub-entities.
    """

    def __init__(self, world: World, items: DrawItems) -> None:
        table = world.content.levels
        self._items = items
        self._counts = table.column("count").copy()
        self._coverages = table.column("coverages").copy()
        self._leads = np.full(len(self._counts), -1, np.int32)
        finest = np.flatnonzero((items.levels == 0) & (items.families >= 0))[::-1]
        self._leads[items.families[finest]] = finest
        self._chosen: dict[Hashable, I4] = {}
        bends = np.array([name in world.motion.body_of for name in items.mesh_names], np.bool_)[items.meshes]
        self._bends = np.isin(np.arange(len(self._counts)), items.families[bends])
        self._shown = np.zeros(len(items.rows), np.uint8)
        self._shown_in: Hashable = None

    def begin(self) -> None:
        """Begin a frame: bodies and eyes may have moved."""
        self._shown_in = None

    @property
    def bodies(self) -> int:
        """Number of bodies with levels."""
        return len(self._counts)

    def show(
        self, key: Hashable, view: View, size: tuple[int, int], shown: U1, centres: F8, radii: F8, detail: float
    ) -> U1:
        """Return 1 for each item of the chosen levels that may be drawn, [n]; valid until the next call.

        Args:
            key: Identifies the view from frame to frame; one view has one choice in a frame, in all of its parts.
            view: The view, or a part of it.
            size: Size as drawn [px].
            shown: 1 where an item may be drawn at all, [n].
            centres: Centres of the items' spheres, world [m], [n, 3].
            radii: Their radii [m], [n].
            detail: Factor on the authored distances at which levels change.
        """
        if not self.bodies:
            return shown
        if self._shown_in == key:
            return self._shown
        chosen = self._chosen.setdefault(key, np.full(len(self._counts), -1, np.int32))
        eye = np.ascontiguousarray(view.eye_world)
        window = view.window / detail**2
        smaller = fewer_pixels(view, size)
        choose_levels(self._leads, centres, radii, self._counts, self._coverages, eye, window, smaller, chosen)
        return self._show(shown, chosen, key)

    def show_for_texels(self, shown: U1, radii: F8, texel: float) -> U1:
        """Return 1 for each item of the coarsest levels that suffice for a shadow map of a texel width [m], [n].

        Valid until the next call. From its coverage on, a level deviates by about a pixel in a picture of
        `COVERED_PICTURE` pixels; here the coverage is that of a picture whose pixels are as wide as the shadow filter.
        """
        if not self.bodies:
            return shown
        chosen = np.empty(len(self._counts), np.int32)
        window = (_FILTER * texel) ** 2 * COVERED_PICTURE[0] * COVERED_PICTURE[1]
        choose_for_texels(self._leads, radii, self._counts, self._coverages, window, chosen)
        return self._show(shown, chosen)

    def show_finest(self, shown: U1) -> U1:
        """Return 1 for each item of the finest levels that may be drawn, [n]; valid until the next call.

        A skinned body has the finest level that a view showed last: another one would be skinned for its shadow alone.
        """
        if not self.bodies:
            return shown
        finest = np.zeros(len(self._counts), np.int32)
        if self._chosen and self._bends.any():
            seen = np.minimum.reduce([np.where(each < 0, 0, each) for each in self._chosen.values()])
            finest[self._bends] = np.minimum(seen, self._counts - 1)[self._bends]
        return self._show(shown, finest)

    def _show(self, shown: U1, chosen: I4, key: Hashable = None) -> U1:
        show_levels(shown, self._items.levels, self._items.families, chosen, self._shown)
        self._shown_in = key
        return self._shown
