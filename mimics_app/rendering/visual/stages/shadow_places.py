"""Places on which the shadows of shapes may fall."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from mimics_app.contracts.arrays import B1, F8, I4
from mimics_app.rendering.visual.kernels.shadow_prisms import FIGURES, LEAST, cut_prisms, slice_casters
from mimics_app.rendering.visual.stages.placed_shapes import PlacedItems, Shapes
from mimics_app.rendering.visual.stages.seen_frame import SeenFrame
from mimics_app.rendering.visual.stages.shape_boxes import ShapeBoxes

__all__ = ["find_shadow_places"]

_REACH_TEXELS = 4.0
"""Margin around a shadow: reach of the filter and of the lookup's offsets."""

_SLICES = 6
"""Slices of a shape across the sun's rays: its shadow is narrower than its bounding rectangle."""

_MAX_PRISMS = 8192
"""Number of prisms up to which locating them costs less than a redraw."""

_MAX_SPRITES = 300
"""Number of sprites up to which each counts by itself."""


def find_shadow_places(
    seen: SeenFrame, cast: Sequence[Shapes], placed: PlacedItems, receiving: B1, shapes: ShapeBoxes
) -> F8 | None:
    """Return hulls of the places where the sun's shadows of shapes may fall.

    Args:
        seen: The frame.
        cast: The shapes, before and after they moved.
        placed: Its items.
        receiving: Items on which shadows may fall; lit sprites and what is overlaid always count, [n].
        shapes: Boxes of the shapes of the world.

    Returns:
        Points of each hull, world [m], [m, 8, 3]; None where there are too many.
    """
    prisms = np.empty((_MAX_PRISMS, 8, 3))
    if seen.sun is None or not seen.maps or not any(each.casting.any() for each in cast):
        return prisms[:0]
    rays = _frame_of(seen.sun)
    given = (_casters_of(cast, rays), rays, _REACH_TEXELS * max(each.texel for each in seen.maps))

    numbers = np.flatnonzero(receiving).astype(np.int32)
    fallen = np.zeros(len(numbers), np.uint8)
    cut_prisms(*given, placed.boxes[numbers], numbers, placed.world, prisms[:0], fallen)
    boxes, nodes = _divide(placed, numbers[fallen > 0], seen.listed.rewritten, shapes)
    fallen = np.zeros(len(boxes), np.uint8)
    count = cut_prisms(*given, boxes, nodes, placed.world, prisms, fallen)

    apart = _boxes_apart(seen)
    still, fallen = np.zeros(len(apart), np.int32), np.zeros(len(apart), np.uint8)
    count += cut_prisms(*given, apart, still, np.eye(4)[None], prisms[count:], fallen)
    return prisms[:count] if count <= _MAX_PRISMS else None


def _casters_of(cast: Sequence[Shapes], rays: F8) -> F8:
    """Return the figures of slices of shapes, each slice with the one where the shape was before, [n, `FIGURES`]."""
    found = []
    for each in cast:
        slices = np.empty((len(each.casting), _SLICES, FIGURES))
        slice_casters(each.corners, each.starts, rays, _SLICES, slices.reshape(-1, FIGURES))
        found.append(slices[each.casting].reshape(-1, FIGURES))
    if len({len(each) for each in found}) > 1:
        return np.concatenate(found)
    both = np.max(found, axis=0)
    both[:, LEAST] = np.min(found, axis=0)[:, LEAST]
    return np.asarray(both)


def _divide(placed: PlacedItems, numbers: I4, rewritten: B1, shapes: ShapeBoxes) -> tuple[F8, I4]:
    """Return the boxes of the shapes of some items, [n, 2, 3], and the item of each, [n]."""
    items = placed.items
    found = [placed.boxes[:0]]
    for number in numbers.tolist():
        names = [items.mesh_names[items.meshes[number]]]
        known = None if rewritten[number] else shapes.of(names, placed.revisions)
        found.append(placed.boxes[number : number + 1] if known is None else known)
    return np.concatenate(found), np.repeat(numbers, [len(each) for each in found[1:]])


def _frame_of(sun: F8) -> F8:
    """Return a frame whose last axis points towards the sun, as rows, [3, 3]."""
    across = np.cross(sun, np.eye(3)[np.argmin(np.abs(sun))])
    across /= np.linalg.norm(across)
    return np.stack([across, np.cross(sun, across), sun])


def _boxes_apart(seen: SeenFrame) -> F8:
    """Return boxes in the world of lit sprites, or one around many, and of what is overlaid [m], [n, 2, 3]."""
    spheres = seen.sprites[seen.lit]
    middle, radii = spheres[:, :3], spheres[:, 3:4]
    found = [np.stack([middle - radii, middle + radii], axis=1)]
    if len(middle) > _MAX_SPRITES:
        found = [np.stack([found[0][:, 0].min(axis=0), found[0][:, 1].max(axis=0)])[None]]
    for each in seen.overlaid.values():
        found.append(np.stack([each.hulls.min(axis=1) - each.reach, each.hulls.max(axis=1) + each.reach], axis=1))
    return np.concatenate(found)
