"""Partial redraw: the parts of a picture where something moved, appeared, vanished, or casts a shadow."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from operator import is_

import numpy as np

from mimics_app.contracts.arrays import B1, F8
from mimics_app.rendering.visual.drawing.draw_list import DrawList
from mimics_app.rendering.visual.stages.screen_places import box_corners, cover_of, screen_bounds
from mimics_app.rendering.visual.stages.seen_frame import Overlaid, SeenFrame
from mimics_app.rendering.visual.view import Rect

__all__ = ["StillPicture"]


_STEADY_FRAMES = 2
"""Successive comparable frames before their picture is kept."""

_RESTLESS_FRAMES = 30
"""Successive frames without reuse before keeping ends."""

_WHOLE = 0.6
"""Changed share of a picture from which all of it is redrawn."""

_REACH_TEXELS = 4.0
"""Margin around a shadow: reach of the filter and of the lookup's offsets."""

_MAX_ITEMS = 4000
"""Number of items up to which the search for changes pays off where any of them moves."""

_MAX_SPRITES = 300
"""Number of changed sprites up to which locating them costs less than a redraw."""

_SEGMENTS = 4
"""Segments of a body's path along the sun's rays: an oblique path is much smaller than its bounding rectangle."""

_LOWEST_SUN = 0.05
"""Sine of the sun's elevation below which shadows are taken to be everywhere."""


@dataclass(frozen=True, eq=False)
class _Boxes:
    """Oriented boxes of the items: centres [m], [n, 3], and half edges as columns of [n, 3, 3]."""

    centres: F8
    axes: F8

    def corners(self, which: B1) -> F8:
        """Return the corners of some boxes [m], [m, 8, 3]."""
        return box_corners(self.centres[which], self.axes[which])


@dataclass(eq=False)
class _Before:
    """State of the last frame; without boxes while the camera moves."""

    seen: SeenFrame | None = None
    shown: B1 | None = None
    boxes: _Boxes | None = None


class StillPicture:
    """Finds the parts of a frame that differ from the last one.

    While camera, light and most bodies do not move, most pixels equal those of the last frame, to the bit.

    Attributes:
        keeps: True while frames are kept: the camera does not move.
    """

    def __init__(self) -> None:
        self.keeps = False
        self._steady = self._restless = 0
        self._lowest = 0.0
        self._before = _Before()

    def forget(self) -> None:
        """Discard the last frame."""
        self.keeps, self._steady, self._before = False, 0, _Before()

    def parts(self, seen: SeenFrame) -> list[Rect] | None:
        """Return the rectangles in which a frame differs from the last one [px]; None: redraw all of it."""
        before, listed = self._before, seen.listed
        sprites = _changed_sprites(before.seen, seen)
        at_rest = listed.moved is not None and not listed.moved.any()
        few = (at_rest or len(listed.radii) <= _MAX_ITEMS) and len(sprites) <= _MAX_SPRITES
        changed = _changed_items(before, seen) if few else None
        self._count(alike=changed is not None)
        if changed is None and not self.keeps:
            self._before = _Before(seen)
            return None
        shown, boxes = listed.shown, _boxes_of(listed)
        self._before = _Before(seen, shown, boxes)
        if changed is None or before.seen is None or before.shown is None or before.boxes is None or not self.keeps:
            self._lowest = _lowest_of(boxes, shown)
            return None
        changed |= before.shown != shown
        was, now = changed & before.shown, changed & shown
        touched = np.concatenate([before.boxes.corners(was), boxes.corners(now)])
        casting = np.concatenate([listed.items.casting[was], listed.items.casting[now]])
        return self._places(seen, touched, touched[casting], sprites, _changed_overlaid(before.seen, seen))

    def _count(self, *, alike: bool) -> None:
        """Update `keeps`, which starts after some comparable frames and ends after many others."""
        self._steady = self._steady + 1 if alike else 0
        self._restless = 0 if alike else self._restless + 1
        if self._steady >= _STEADY_FRAMES:
            self.keeps = True
        elif self._restless >= _RESTLESS_FRAMES:
            self.keeps = False

    def _places(
        self, seen: SeenFrame, touched: F8, casters: F8, sprites: F8, overlaid: list[Overlaid]
    ) -> list[Rect] | None:
        """Return rectangles around boxes (by corners), their shadows, sprites (by spheres) and what is overlaid."""
        view, (x, y, width, height) = seen.view, seen.rectangle
        if len(casters) and (seen.cones or (seen.sun is not None and seen.sun[1] < _LOWEST_SUN)):
            return None
        bounds = [screen_bounds(view, touched, np.zeros(len(touched)))]
        bounds.append(screen_bounds(view, sprites[:, None, :3], sprites[:, 3].copy()))
        bounds += [screen_bounds(view, each.hulls, np.full(len(each.hulls), each.reach)) for each in overlaid]
        if seen.sun is not None and seen.maps and len(casters):
            reach = _REACH_TEXELS * max(each.texel for each in seen.maps)
            ends = self._shadow_ends(seen.sun, casters)
            cuts = [casters + share * (ends - casters) for share in np.linspace(0.0, 1.0, _SEGMENTS + 1)]
            segments = np.concatenate([np.concatenate(pair, axis=1) for pair in itertools.pairwise(cuts)])
            bounds.append(screen_bounds(view, segments, np.full(len(segments), reach)))
        covered = cover_of(np.concatenate(bounds), (width, height))
        if sum(wide * high for _, _, wide, high in covered) > _WHOLE * width * height:
            return None
        return [(x + left, y + bottom, wide, high) for left, bottom, wide, high in covered]

    def _shadow_ends(self, sun: F8, corners: F8) -> F8:
        """Return where the shadow rays of corners reach the scene's lowest height [m], [n, 8, 3]."""
        self._lowest = min(self._lowest, float(corners[..., 1].min()))
        return np.asarray(corners - ((corners[..., 1] - self._lowest) / sun[1])[..., None] * sun)


def _changed_items(before: _Before, seen: SeenFrame) -> B1 | None:
    """Return the items that moved or changed their look; None where more changed, or it is unknown."""
    listed, last = seen.listed, before.seen
    if last is None or listed.moved is None or listed.remade or last.fixed != seen.fixed:
        return None
    if len(last.pictures) != len(seen.pictures) or not all(map(is_, last.pictures, seen.pictures)):
        return None
    was, now = last.subentities, seen.subentities
    changed = listed.moved.copy()
    if was is now:
        return changed
    if not (np.array_equal(was.row, now.row) and np.array_equal(was.entity, now.entity)):
        return None
    changed |= was.casts_shadow != now.casts_shadow
    pairs = zip(was.mesh, was.material, now.mesh, now.material, strict=True)
    changed |= np.array([a != c or b != d for a, b, c, d in pairs], np.bool_)
    return changed


def _changed_sprites(last: SeenFrame | None, seen: SeenFrame) -> F8:
    """Return bounding spheres of the changed sprites, before and after, [n, 4]."""
    now = seen.sprites
    before = now[:0] if last is None else last.sprites
    if before.shape != now.shape:
        return np.concatenate([before[:, :4], now[:, :4]])
    other = (before != now).any(axis=1)
    return np.concatenate([before[other, :4], now[other, :4]])


def _changed_overlaid(last: SeenFrame, seen: SeenFrame) -> list[Overlaid]:
    """Return the projected textures and cords that changed, before and after."""
    was, now = last.overlaid, seen.overlaid
    kept = {name for name in was.keys() & now.keys() if was[name].state == now[name].state}
    return [each for overlaid in (was, now) for name, each in overlaid.items() if name not in kept]


def _boxes_of(listed: DrawList) -> _Boxes:
    turned = listed.matrices[listed.items.rows][:, :3, :3]
    return _Boxes(listed.centres.copy(), turned * listed.items.half[:, None])


def _lowest_of(boxes: _Boxes, shown: B1) -> float:
    """Return the lowest height of the boxes of shown items [m]; infinite without any."""
    bottoms = boxes.centres[:, 1] - np.abs(boxes.axes[:, 1]).sum(axis=1)
    return float(bottoms[shown].min(initial=np.inf))
