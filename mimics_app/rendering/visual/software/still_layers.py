"""Static layers of shadow maps: the depths of casters that have not moved for a while, kept from frame to frame."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mimics_app.contracts.arrays import F8, I4
from mimics_app.rendering.visual.drawing.draw_items import DrawItems
from mimics_app.rendering.visual.drawing.draw_list import DrawList
from mimics_app.rendering.visual.kernels.bounds import enclose
from mimics_app.rendering.visual.lighting import SHADOW_STEP, ShadowFrustum, fit_shadow_frustum, shadow_texel
from mimics_app.rendering.visual.shadows.shadow_layers import ShadowLayers, Split, SunBox, equal_bytes
from mimics_app.rendering.visual.shadows.shadow_maps import ShadowMap
from mimics_app.rendering.visual.software.kernels.screen_bounds import bound_in_map
from mimics_app.rendering.visual.software.kernels.shadow_prisms import find_moving
from mimics_app.rendering.visual.software.screen_places import parts_of
from mimics_app.rendering.visual.view import Rect

__all__ = ["QUIET_FRAMES", "SteadyBox", "StillLayers"]

_LARGEST_RATIO = SHADOW_STEP**3
"""Largest ratio of a box's width to the required one."""

_MIN_TEXELS = 1.5
"""Minimum distance of a caster from the border of the map, the reach of the filter [texel]."""


class SteadyBox(SunBox):
    """Keeps the box of the last frame: only an identical box allows its map to be reused in part.

    When a caster leaves the box, the new one is a step wider than required, so that it is not left at once again.
    """

    def __init__(self) -> None:
        self._sun = b""
        self._box: ShadowFrustum | None = None

    def fit(self, sun_direction: F8, centres: F8, radii: F8, size: int) -> ShadowFrustum | None:
        had, sun, room = self._box, sun_direction.tobytes(), 1.0
        if had is not None and had.size == size and self._sun == sun and len(radii):
            border = 1.0 - 2.0 * _MIN_TEXELS / size
            reach, inside = enclose(centres, radii, had.clip_from_world, np.array([border, border, 1.0]))
            if had.texel <= _LARGEST_RATIO * shadow_texel(reach, size):
                if inside:
                    return had
                room = SHADOW_STEP
        self._sun, self._box = sun, fit_shadow_frustum(sun_direction, centres, radii, size, room=room)
        return self._box


QUIET_FRAMES = 120
"""Frames without motion after which a caster counts as static."""


@dataclass(frozen=True, eq=False)
class _Layer:
    """Kept layer of a tile: grid size, projection, items, and the frame it was drawn in."""

    grid: int
    clip: F8
    items: I4
    frame: int


class StillLayers(ShadowLayers):
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
        self._layers.clear()

    def begin(self, listed: DrawList) -> None:
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

    def split(self, shadow: ShadowMap, grid: int, listed: DrawList, width: int) -> Split:
        casters, layer = shadow.casters.items, self._layers.get(shadow.tile)
        if layer is not None and layer.grid == grid and equal_bytes(layer.clip, shadow.clip_from_world):
            over, last = np.empty(len(casters), np.int32), self._frame - QUIET_FRAMES
            count = find_moving(casters, layer.items, self._moved_at, layer.frame, last, self._marks, over)
            if count >= 0:
                return Split(None, False, over[:count], _reach(shadow, listed, over[:count], width))
        self._layers.pop(shadow.tile, None)
        quiet = self._frame - self._moved_at[casters] >= QUIET_FRAMES
        if quiet.all() or not quiet.any():
            return Split(casters, False, casters[:0], [])
        still, moving = casters[quiet], casters[~quiet]
        self._layers[shadow.tile] = _Layer(grid, shadow.clip_from_world, still, self._frame)
        return Split(still, True, moving, _reach(shadow, listed, moving, width))


def _reach(shadow: ShadowMap, listed: DrawList, items: I4, width: int) -> list[Rect]:
    """Return the rectangles of a map that some items can cover [texel]; all of a spot light's map."""
    if not len(items):
        return []
    if shadow.clip_from_world[3, :3].any():
        return [(0, 0, width, width)]
    bounds = np.empty((len(items), 4))
    bound_in_map(shadow.clip_from_world, items, listed.centres, listed.radii, bounds)
    return parts_of(bounds, (width, width))
