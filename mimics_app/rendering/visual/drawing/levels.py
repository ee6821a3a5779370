"""Which level of detail each view shows of each body."""

from __future__ import annotations

import math
from collections.abc import Hashable

import numpy as np

from mimics_app.contracts.arrays import F8, I4, U1
from mimics_app.rendering.visual.drawing.draw_items import DrawItems
from mimics_app.rendering.visual.kernels.levels import choose_levels, show_levels
from mimics_app.rendering.visual.view import View
from mimics_app.world.levels import COVERED_PICTURE
from mimics_app.world.world import World

__all__ = ["Levels", "fewer_pixels"]

_LEAST_PIXELS = 480.0 * 270.0
"""Of a picture of fewer, levels are as wrong in pixels as in one of so many: coverages are shares of a picture, and
the same share of a small one has fewer pixels to be wrong by."""

_FILTER = 2.0
"""Width of the filter of shadows (shaders/common/shadow.glsl): of its 3 x 3 weights half lie within [texel]."""


def fewer_pixels(view: View, size: tuple[int, int]) -> float:
    """How many times as many pixels as a picture has the smallest one whose levels go by shares alone; >= 1.

    Args:
        view: The picture, or a part of it.
        size: As it is drawn [px].
    """
    return max(1.0, _LEAST_PIXELS / (size[0] * size[1] * view.parts))


class Levels:
    """Remembers for each view what it showed last.

    Args:
        world: Whose bodies.
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

    @property
    def any(self) -> bool:
        """True when some body has levels."""
        return len(self._counts) > 0

    def show(
        self, key: Hashable, view: View, size: tuple[int, int], shown: U1, centres: F8, radii: F8, detail: float
    ) -> U1:
        """What may be drawn in a view, [n]; good until the next call.

        Args:
            key: Of the view, the same from frame to frame.
            view: From where; a part of a picture shows what the whole of it would.
            size: As it is drawn [px].
            shown: 1 where an item may be drawn at all, [n].
            centres: Of the items' spheres, world [m], [n, 3].
            radii: Of the same [m], [n].
            detail: Distances at which levels change, over those that the bodies' authors gave.
        """
        if not self.any:
            return shown
        chosen = self._chosen.setdefault(key, np.full(len(self._counts), -1, np.int32))
        eye = np.ascontiguousarray(view.eye_world)
        window = view.window / detail**2
        smaller = fewer_pixels(view, size)
        choose_levels(self._leads, centres, radii, self._counts, self._coverages, eye, window, smaller, chosen)
        show_levels(shown, self._items.levels, self._items.families, chosen, self._shown)
        return self._shown

    def show_for_texels(self, shown: U1, radii: F8, texel: float) -> U1:
        """What may be drawn into a map whose texels are so wide [m]: each body as coarse as its shadow does not show.

        Good until the next call. A body's coverages say from where a level is wrong by no more than a pixel or so of
        a picture of `COVERED_PICTURE`; the same body covers as much of such a picture whose pixels are as wide as what
        the filter of shadows blurs.
        """
        if not self.any:
            return shown
        radius = np.where(self._leads >= 0, radii[self._leads], 0.0)
        covered = math.pi * (radius / (_FILTER * texel)) ** 2 / (COVERED_PICTURE[0] * COVERED_PICTURE[1])
        coarser = (covered[:, None] < self._coverages).sum(axis=1)
        chosen = np.minimum(coarser, self._counts - 1).astype(np.int32)
        show_levels(shown, self._items.levels, self._items.families, chosen, self._shown)
        return self._shown

    def show_finest(self, shown: U1) -> U1:
        """What may be drawn where no view counts, as in a shadow map: each body's finest level.

        Of what bends it is the finest that a view showed last: another one would have to be bent for its shadow alone.
        """
        if not self.any:
            return shown
        finest = np.zeros(len(self._counts), np.int32)
        if self._chosen and self._bends.any():
            seen = np.minimum.reduce([np.where(each < 0, 0, each) for each in self._chosen.values()])
            finest[self._bends] = np.minimum(seen, self._counts - 1)[self._bends]
        show_levels(shown, self._items.levels, self._items.families, finest, self._shown)
        return self._shown
