"""Static layers of shadow maps: the depths of casters that have not moved for a while, kept from frame to frame."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import F8, I4
from mimics_app.rendering.visual.drawing.draw_items import DrawItems
from mimics_app.rendering.visual.drawing.draw_list import DrawList
from mimics_app.rendering.visual.kernels.still_casters import find_moving
from mimics_app.rendering.visual.shadows.shadow_maps import ShadowMap

__all__ = ["QUIET_FRAMES", "Split", "StillLayers", "equal_bytes"]


QUIET_FRAMES = 120
"""Frames without motion after which a caster counts as static."""


@dataclass(frozen=True, eq=False)
class Split:
    """Casters of a map: the static ones, drawn first, and the moving ones.

    Attributes:
        still: Numbers of items to draw into the cleared map; None where its kept layer is restored instead.
        keep: True where the depths of `still` are to be kept.
        moving: Numbers of items to draw over them.
    """

    still: I4 | None
    keep: bool
    moving: I4


@dataclass(frozen=True, eq=False)
class _Layer:
    """Kept layer of a tile: grid size, projection, items, and the frame it was drawn in."""

    grid: int
    clip: F8
    items: I4
    frame: int


class StillLayers:
    """Records when each item last moved, and the items in the layer of each tile.

    The nearest depth does not depend on the drawing order, for dithered casters too: with a layer a map has the same
    depths as without.
    """

    def __init__(self) -> None:
        self._items: DrawItems | None = None
        self._moved_at, self._marks = np.zeros(0, np.int64), np.zeros(0, np.uint8)
        self._frame = 0
        self._layers: dict[tuple[int, int], _Layer] = {}

    def forget(self) -> None:
        """Discard all layers."""
        self._layers.clear()

    def begin(self, listed: DrawList) -> None:
        """Record the items that moved since the last frame."""
        self._frame += 1
        if listed.items is not self._items:
            self._items = listed.items
            self._moved_at = np.full(len(listed.items.rows), self._frame - QUIET_FRAMES)
            self._marks = np.zeros(len(listed.items.rows), np.uint8)
            self.forget()
        if listed.moved is None:
            self.forget()
        else:
            self._moved_at[listed.moved] = self._frame

    def split(self, shadow: ShadowMap, grid: int) -> Split:
        """Split the casters of a map that has changed, in one of grid x grid tiles."""
        casters, layer = shadow.casters.items, self._layers.get(shadow.tile)
        if layer is not None and layer.grid == grid and equal_bytes(layer.clip, shadow.clip_from_world):
            over, last = np.empty(len(casters), np.int32), self._frame - QUIET_FRAMES
            count = find_moving(casters, layer.items, self._moved_at, layer.frame, last, self._marks, over)
            if count >= 0:
                return Split(None, False, over[:count])
        self._layers.pop(shadow.tile, None)
        quiet = self._frame - self._moved_at[casters] >= QUIET_FRAMES
        if quiet.all() or not quiet.any():
            return Split(casters, False, casters[:0])
        still = casters[quiet]
        self._layers[shadow.tile] = _Layer(grid, shadow.clip_from_world, still, self._frame)
        return Split(still, True, casters[~quiet])


def equal_bytes(one: NDArray[Any], other: NDArray[Any]) -> bool:
    """Whether two arrays of one type and shape are equal, in a tenth of the time of `np.array_equal`."""
    return one is other or one.tobytes() == other.tobytes()
