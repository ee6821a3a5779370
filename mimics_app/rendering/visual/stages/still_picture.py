"""What of a picture has to be drawn again: where something moved, came, went, or casts its shadow."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from operator import is_

import numpy as np
from numpy.typing import NDArray

from mimics_app.rendering.visual.drawing.draw_list import DrawList
from mimics_app.rendering.visual.stages.screen_places import box_corners, cover_of, screen_bounds
from mimics_app.rendering.visual.stages.seen_frame import SeenFrame
from mimics_app.rendering.visual.view import Rect

__all__ = ["StillPicture"]

F8 = NDArray[np.float64]

_STEADY_FRAMES = 2
"""Frames that see the same before what they drew is kept."""

_RESTLESS_FRAMES = 30
"""Frames that all see something else before keeping is given up."""

_WHOLE = 0.6
"""Share of a picture from which it is drawn as a whole."""

_REACH_TEXELS = 4.0
"""About a shadow: how far the filter and the offsets of the look-up reach."""

_MOST_ITEMS = 4000
"""In a world of more, looking for what changed costs more than is likely to be saved."""

_MOST_SPRITES = 300
"""Of more that changed, finding out where they are costs more than drawing the picture, as of a fountain of dots."""

_PIECES = 4
"""In which a body's way along the sun's rays is looked at: aslant on the screen, it is not the rectangle about it."""

_LOWEST_SUN = 0.05
"""Height of a sun, as the sine of its angle, below which shadows are taken to be everywhere."""


@dataclass(frozen=True, eq=False)
class _Boxes:
    """About the items: middles [m], [n, 3], and half edges as the columns of [n, 3, 3]."""

    centres: F8
    axes: F8

    def corners(self, which: NDArray[np.bool_]) -> F8:
        """Of some of them [m], [m, 8, 3]."""
        return box_corners(self.centres[which], self.axes[which])


@dataclass(eq=False)
class _Before:
    """What the last frame saw; where its bodies were unless the eye moves anyway."""

    seen: SeenFrame | None = None
    shown: NDArray[np.bool_] | None = None
    boxes: _Boxes | None = None


class StillPicture:
    """Compares each frame with the one before.

    Where eye, light and most bodies stand still, all pixels but a few are those of the frame before, to the bit.

    Attributes:
        keeps: True while frames are worth being kept: the eye stands still.
    """

    def __init__(self) -> None:
        self.keeps = False
        self._steady = self._restless = 0
        self._lowest = 0.0
        self._before = _Before()

    def forget(self) -> None:
        """A frame of which nothing can be kept was drawn."""
        self.keeps, self._steady, self._before = False, 0, _Before()

    def parts(self, seen: SeenFrame) -> list[Rect] | None:
        """Rectangles outside of which a frame is as the one before [px]; None where nothing is known of that one."""
        before, listed = self._before, seen.listed
        sprites = _changed_sprites(before.seen, seen)
        few = len(listed.radii) <= _MOST_ITEMS and len(sprites) <= _MOST_SPRITES
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
        return self._places(seen, touched, touched[casting], sprites)

    def _count(self, *, alike: bool) -> None:
        """Whether the eye stands still has to hold for some frames before it counts, and to fail for more."""
        self._steady = self._steady + 1 if alike else 0
        self._restless = 0 if alike else self._restless + 1
        if self._steady >= _STEADY_FRAMES:
            self.keeps = True
        elif self._restless >= _RESTLESS_FRAMES:
            self.keeps = False

    def _places(self, seen: SeenFrame, touched: F8, casters: F8, sprites: F8) -> list[Rect] | None:
        """Where boxes by their corners, their shadows, and sprites by spheres are in the picture."""
        view, (x, y, width, height) = seen.view, seen.rectangle
        if len(casters) and (seen.cones or (seen.sun is not None and seen.sun[1] < _LOWEST_SUN)):
            return None
        bounds = [screen_bounds(view, touched, np.zeros(len(touched)))]
        bounds.append(screen_bounds(view, sprites[:, None, :3], sprites[:, 3].copy()))
        if seen.sun is not None and seen.maps and len(casters):
            reach = _REACH_TEXELS * max(each.texel for each in seen.maps)
            ends = self._shadow_ends(seen.sun, casters)
            cuts = [casters + share * (ends - casters) for share in np.linspace(0.0, 1.0, _PIECES + 1)]
            pieces = np.concatenate([np.concatenate(pair, axis=1) for pair in itertools.pairwise(cuts)])
            bounds.append(screen_bounds(view, pieces, np.full(len(pieces), reach)))
        covered = cover_of(np.concatenate(bounds), (width, height))
        if sum(wide * high for _, _, wide, high in covered) > _WHOLE * width * height:
            return None
        return [(x + left, y + bottom, wide, high) for left, bottom, wide, high in covered]

    def _shadow_ends(self, sun: F8, corners: F8) -> F8:
        """Where the shadows of corners leave the scene through its lowest point [m], [n, 8, 3]."""
        self._lowest = min(self._lowest, float(corners[..., 1].min()))
        return np.asarray(corners - ((corners[..., 1] - self._lowest) / sun[1])[..., None] * sun)


def _changed_items(before: _Before, seen: SeenFrame) -> NDArray[np.bool_] | None:
    """Items that moved or look otherwise; None where more changed, or that is not known."""
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
    """Spheres about sprites that are others now, where they were and where they are, [n, 4]."""
    now = seen.sprites
    before = now[:0] if last is None else last.sprites
    if before.shape != now.shape:
        return np.concatenate([before[:, :4], now[:, :4]])
    other = (before != now).any(axis=1)
    return np.concatenate([before[other, :4], now[other, :4]])


def _boxes_of(listed: DrawList) -> _Boxes:
    turned = listed.matrices[listed.items.rows][:, :3, :3]
    return _Boxes(listed.centres.copy(), turned * listed.items.half[:, None])


def _lowest_of(boxes: _Boxes, shown: NDArray[np.bool_]) -> float:
    """Lowest point of the boxes of what is shown [m]; infinite where nothing is."""
    bottoms = boxes.centres[:, 1] - np.abs(boxes.axes[:, 1]).sum(axis=1)
    return float(bottoms[shown].min(initial=np.inf))
