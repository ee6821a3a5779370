"""Places on which the shadows of shapes may fall."""

from __future__ import annotations

import numpy as np

from mimics_app.contracts.arrays import B1, F8
from mimics_app.rendering.visual.lighting import sun_axes
from mimics_app.rendering.visual.software.frame_inputs import FrameInputs
from mimics_app.rendering.visual.software.kernels.shadow_prisms import (
    FIGURES,
    cut_prisms,
    cut_prisms_on_items,
    slice_casters,
)
from mimics_app.rendering.visual.software.placed_shapes import PlacedItems, PlacedShapes, Shapes
from mimics_app.rendering.visual.software.screen_places import cell_tangent

__all__ = ["find_shadow_places"]

_REACH_TEXELS = 4.0
"""Margin around a shadow: reach of the filter and of the lookup's offsets."""

_MAX_SLICES = 6
"""Most slices of a shape, where it was and where it is, across the sun's rays: its shadow is narrower than its bounding
rectangle. None is seen narrower than a cell."""

_MAX_SPRITES = 300
"""Number of sprites up to which each counts by itself."""


def find_shadow_places(
    seen: FrameInputs, cast: Shapes, placed: PlacedItems, receiving: B1, shapes: PlacedShapes, hulls: F8
) -> int:
    """Write hulls of the places where the sun's shadows of shapes may fall.

    Args:
        seen: The frame.
        cast: The shapes, before and after they moved.
        placed: Its items.
        receiving: Items on which shadows may fall; lit sprites and what is overlaid always count, [n].
        shapes: Shapes of the items.
        hulls: Written: points of each hull, world [m], [capacity, 8, 3].

    Returns:
        Number of hulls; more than the capacity where they did not fit.
    """
    if seen.sun is None or not seen.maps or not cast.casting.any():
        return 0
    rays = sun_axes(seen.sun)
    eye, least = rays @ seen.view.world_from_eye[:3, 3], cell_tangent(seen.view, seen.rectangle[2])
    casters = np.empty((len(cast.casting) * _MAX_SLICES, FIGURES))
    slices = slice_casters(cast.corners, cast.starts, cast.casting, rays, eye, least, _MAX_SLICES, casters)
    casters = casters[:slices]
    reach = _REACH_TEXELS * max(each.texel for each in seen.maps)
    count = cut_prisms_on_items(casters, rays, reach, receiving, placed.compiled, shapes.table, hulls)
    apart = _boxes_apart(seen)
    if len(apart):
        still, fallen = np.zeros(len(apart), np.int32), np.zeros(len(apart), np.uint8)
        count += cut_prisms(casters, rays, reach, apart, still, np.eye(4)[None], hulls[count:], fallen)
    return count


def _boxes_apart(seen: FrameInputs) -> F8:
    """Return boxes in the world of lit sprites, or one around many, and of what is overlaid [m], [n, 2, 3]."""
    if not (len(seen.sprites) or seen.overlaid):
        return np.zeros((0, 2, 3))
    spheres = seen.sprites[seen.lit]
    middle, radii = spheres[:, :3], spheres[:, 3:4]
    found = [np.stack([middle - radii, middle + radii], axis=1)]
    if len(middle) > _MAX_SPRITES:
        found = [np.stack([found[0][:, 0].min(axis=0), found[0][:, 1].max(axis=0)])[None]]
    for each in seen.overlaid.values():
        found.append(np.stack([each.hulls.min(axis=1) - each.reach, each.hulls.max(axis=1) + each.reach], axis=1))
    return np.concatenate(found)
