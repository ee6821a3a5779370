"""Partial redraw: the parts of a picture where something moved, appeared, vanished, or casts a shadow."""

from __future__ import annotations

from dataclasses import dataclass
from operator import is_

import numpy as np

from mimics_app.contracts.arrays import B1, F8
from mimics_app.rendering.visual.changed_part import ChangedPart
from mimics_app.rendering.visual.lighting import sun_axes
from mimics_app.rendering.visual.software.frame_inputs import FrameInputs, Overlaid
from mimics_app.rendering.visual.software.kernels.shadow_prisms import (
    FIGURES,
    cut_prisms,
    cut_prisms_on_items,
    slice_casters,
)
from mimics_app.rendering.visual.software.placed_shapes import PlacedItems, PlacedShapes, Shapes, place_items
from mimics_app.rendering.visual.software.screen_places import cell_tangent, cover_of, screen_bounds
from mimics_app.rendering.visual.software.shape_boxes import ShapeBoxes

__all__ = ["PictureChanges"]


_STEADY_FRAMES = 2
"""Successive comparable frames before their picture is kept."""

_RESTLESS_FRAMES = 30
"""Successive frames without reuse before keeping ends."""

_WHOLE = 0.6
"""Changed share of a picture from which all of it is redrawn."""

_MAX_HULLS = 16_384
"""Number of hulls of changed shapes and their shadows up to which locating them costs less than a redraw."""

_MAX_ITEMS = 4000
"""Number of items up to which the search for changes pays off where any of them moves."""

_MAX_SPRITES = 300
"""Number of changed sprites up to which locating them costs less than a redraw."""


_REACH_TEXELS = 4.0
"""Margin around a shadow: reach of the filter and of the lookup's offsets."""

_MAX_SLICES = 6
"""Most slices of a shape, where it was and where it is, across the sun's rays: its shadow is narrower than its bounding
rectangle. None is seen narrower than a cell."""

_MAX_SPRITES = 300
"""Number of sprites up to which each counts by itself."""


def _find_shadow_places(
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


@dataclass(eq=False)
class _Before:
    """State of the last frame; without places while the camera moves, and without shapes where it was not searched."""

    seen: FrameInputs | None = None
    placed: PlacedItems | None = None
    shapes: PlacedShapes | None = None


class PictureChanges:
    """Finds the parts of a frame that differ from the last one.

    While camera, light and most bodies do not move, most pixels equal those of the last frame, to the bit.

    Args:
        sparse: True where frames are far apart in time: the first one is kept already.

    Attributes:
        keeps: True while frames are kept: the camera does not move.
        only_sprites: True where frames are kept, and nothing but sprites has changed since the last one.
    """

    def __init__(self, *, sparse: bool = False) -> None:
        self.keeps, self.only_sprites = sparse, False
        self._steady = self._restless = 0
        self._boxes: ShapeBoxes | None = None
        self._hulls, self._points = np.empty((_MAX_HULLS, 8, 3)), np.zeros(_MAX_HULLS)
        self._before = _Before()

    def forget(self) -> None:
        """Discard the last frame."""
        self.keeps, self.only_sprites, self._steady, self._before = False, False, 0, _Before()

    def parts(self, seen: FrameInputs) -> list[ChangedPart] | None:
        """Return the parts in which a frame differs from the last one; None: redraw all of it."""
        before, listed = self._before, seen.listed
        sprites = _changed_sprites(before.seen, seen)
        at_rest = listed.moved is not None and not listed.moved.any()
        few = at_rest or len(listed.radii) <= _MAX_ITEMS
        changed = _changed_items(before, seen) if few else None
        only_sprites = changed is not None and _differ_in_sprites(before.seen, seen, changed)
        many = len(sprites) > _MAX_SPRITES
        if many and not only_sprites:
            changed = None
        self._count(alike=changed is not None)
        self.only_sprites = only_sprites and self.keeps
        if changed is None and not self.keeps:
            self._before = _Before(seen)
            return None
        placed = place_items(listed, seen.shown)
        self._before = _Before(seen, placed)
        if changed is None or many or before.seen is None or before.placed is None or not self.keeps:
            return None
        shapes = self._before.shapes = self._shapes_of(before, seen)
        changed |= before.placed.shown != placed.shown
        hulls = self._find(before.placed, placed, shapes, seen, changed)
        places = [before.seen.board, seen.board, seen.redrawn]
        overlaid = _changed_overlaid(before.seen, seen)
        return None if hulls is None else self._cover(seen, hulls, sprites, overlaid, places)

    def _shapes_of(self, before: _Before, seen: FrameInputs) -> PlacedShapes:
        """Return the shapes of a frame, placed as in the last one where they are the same."""
        if self._boxes is None or self._boxes.world is not seen.world:
            self._boxes = ShapeBoxes(seen.world, seen.listed.bent)
        shapes = before.shapes
        if shapes is None or shapes.items is not seen.listed.items:
            shapes = PlacedShapes(seen.listed.items, self._boxes)
        shapes.follow(seen.shown, seen.listed.rewritten)
        return shapes

    def _count(self, *, alike: bool) -> None:
        """Update `keeps`, which starts after some comparable frames and ends after many others."""
        self._steady = self._steady + 1 if alike else 0
        self._restless = 0 if alike else self._restless + 1
        if self._steady >= _STEADY_FRAMES:
            self.keeps = True
        elif self._restless >= _RESTLESS_FRAMES:
            self.keeps = False

    def _find(
        self, was: PlacedItems, now: PlacedItems, shapes: PlacedShapes, seen: FrameInputs, changed: B1
    ) -> F8 | None:
        """Return hulls [n, 8, 3] of changed items, before and after, and of their shadows; None: too many to find."""
        found = shapes.place(was, now, changed, self._hulls)
        if found is None or (seen.cones and found.casting.any()):
            return None
        count = len(found.corners)
        receiving = seen.listed.drawn & now.shown & ~changed
        count += _find_shadow_places(seen, found, now, receiving, shapes, self._hulls[count:])
        shapes.compute_missed(now.shown)
        return self._hulls[:count] if count <= len(self._hulls) else None

    def _cover(
        self, seen: FrameInputs, hulls: F8, sprites: F8, overlaid: list[Overlaid], places: list[F8]
    ) -> list[ChangedPart] | None:
        """Return parts around hulls of points, sprites (by spheres), what is overlaid, and places in the picture."""
        view, (x, y, width, height) = seen.view, seen.rectangle
        bounds = [screen_bounds(view, hulls, self._points[: len(hulls)])]
        if len(sprites):
            bounds.append(screen_bounds(view, sprites[:, None, :3], sprites[:, 3].copy()))
        bounds += [screen_bounds(view, each.hulls, np.full(len(each.hulls), each.reach)) for each in overlaid]
        parts = cover_of(np.concatenate([*bounds, *places]), (width, height))
        drawn = [piece for part in parts for piece in part.pieces]
        most = 0.0 if seen.spreads else _WHOLE
        if sum(wide * high for _, _, wide, high in drawn) > most * width * height:
            return None
        return [part.moved(x, y) for part in parts]


def _changed_items(before: _Before, seen: FrameInputs) -> B1 | None:
    """Return the items that moved or changed their material; None where more changed, or it is unknown."""
    listed, last = seen.listed, before.seen
    if last is None or listed.moved is None or listed.remade or last.fixed != seen.fixed:
        return None
    if len(last.pictures) != len(seen.pictures) or not all(map(is_, last.pictures, seen.pictures)):
        return None
    was, now = last.subentities, seen.subentities
    changed = listed.moved | seen.renewed
    if was is now:
        return changed
    if not (np.array_equal(was.row, now.row) and np.array_equal(was.entity, now.entity)):
        return None
    changed |= was.casts_shadow != now.casts_shadow
    pairs = zip(was.mesh, was.material, now.mesh, now.material, strict=True)
    changed |= np.array([a != c or b != d for a, b, c, d in pairs], np.bool_)
    return changed


def _differ_in_sprites(last: FrameInputs | None, seen: FrameInputs, changed: B1) -> bool:
    """Whether a frame differs from a comparable one in nothing but sprites, given its changed items.

    Mirrors show sprites, too.
    """
    if last is None or changed.any() or seen.world.mirrors:
        return False
    return np.array_equal(last.shown, seen.shown) and not _changed_overlaid(last, seen)


def _changed_sprites(last: FrameInputs | None, seen: FrameInputs) -> F8:
    """Return bounding spheres of the changed sprites, before and after, [n, 4]."""
    now = seen.sprites
    before = now[:0] if last is None else last.sprites
    if before.shape != now.shape:
        return np.concatenate([before[:, :4], now[:, :4]])
    other = (before != now).any(axis=1)
    return np.concatenate([before[other, :4], now[other, :4]])


def _changed_overlaid(last: FrameInputs, seen: FrameInputs) -> list[Overlaid]:
    """Return the projected textures and cords that changed, before and after."""
    was, now = last.overlaid, seen.overlaid
    kept = {name for name in was.keys() & now.keys() if was[name].state == now[name].state}
    return [each for overlaid in (was, now) for name, each in overlaid.items() if name not in kept]
