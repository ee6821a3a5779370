"""Boxes along the sun's rays about the eyes, one in another: cascades of shadow maps."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.rendering.visual.drawing.draw_list import Casters
from mimics_app.rendering.visual.lighting import sun_axes
from mimics_app.rendering.visual.shadows.shadow_maps import ShadowMap
from mimics_app.rendering.visual.view import View

__all__ = ["MAX_CASCADES", "Cascades"]


MAX_CASCADES = 4

_AHEAD = 0.6
"""How far before the eye a cascade's middle lies, in its radii: most of what is behind the eye is not seen."""

_GROWTH = 3.5
"""Each cascade's radius over that of the one inside it."""

_WORTH, _MUST = 0.125, 0.5
"""How far a cascade may be off, in its radii, before it is worth moving, and before it has to be."""

_DEPTH_STEPS, _LEAST_DEPTH = 16, 1.0
"""Steps in which the depth of all cascades grows, to its power of two, and the least one [m]."""


class Cascades:
    """The boxes of a sun, from frame to frame; right for any number of views at once.

    Each box is of fixed size about a point before the eyes and moves by whole texels: neither turning nor walking makes
    edges crawl. It stays where it was while that is near enough, so that the map of a scene without motion is the
    same one, and of several only the one that is most off moves in a frame: a place that the inner box no longer holds
    is found in the next. All measure depth alike, from the farthest caster towards the sun to the lowest one: what lies
    below all of them is taken to be at the bottom, where it is in the same shadow.
    """

    def __init__(self) -> None:
        self._form: object = None
        self._casters: Casters | None = None
        self._middles: F8 | None = None
        self._maps: list[ShadowMap | None] = []

    def fit(
        self, sun_direction: F8, views: Sequence[View], casters: Casters, distance: float, count: int, size: int
    ) -> list[ShadowMap]:
        """The maps of a frame, the innermost first; one that need not change is the very one of the frame before.

        Args:
            sun_direction: Unit, towards the sun.
            views: Whose eyes.
            casters: All of them, `centres` and `radii` by `items`; the same object while nothing of them changes.
            distance: How far from the eyes shadows are seen [m].
            count: Boxes, 1 to MAX_CASCADES.
            size: Texels along a side of one map.
        """
        rotation = sun_axes(sun_direction)
        seen = distance / (1.0 + _AHEAD) * _GROWTH ** np.arange(1.0 - count, 1.0)
        radii = seen / (1.0 - _WORTH)
        self._take_over(rotation, casters, (rotation.tobytes(), distance, count, size))
        eye = rotation @ np.mean([view.eye_world for view in views], axis=0)
        forward = -(rotation @ np.mean([view.world_from_eye[:3, 2] for view in views], axis=0))
        texels = 2.0 * radii / size
        wanted = np.round((eye + _AHEAD * seen[:, None] * forward) / texels[:, None]) * texels[:, None]
        middles = _settle(wanted, radii, self._middles)
        for number, (middle, radius) in enumerate(zip(middles, radii.tolist(), strict=True)):
            if self._middles is not None and not np.array_equal(middle, self._middles[number]):
                self._maps[number] = None
            if self._maps[number] is None:
                self._maps[number] = self._make(rotation, casters, middle, radius, texel=2.0 * radius / size)
        self._middles = middles
        return [shadow for shadow in self._maps if shadow is not None]

    def _take_over(self, rotation: F8, casters: Casters, form: tuple[bytes, float, int, int]) -> None:
        """Forget what was made for other casters, and boxes of another form."""
        if form != self._form:
            self._form, self._casters, self._middles = form, None, None
        if casters is not self._casters:
            self._casters = casters
            self._placed = casters.centres @ rotation.T
            self._depth = _depth_of(self._placed[:, 2], casters.radii)
            self._maps = [None] * form[2]

    def _make(self, rotation: F8, casters: Casters, middle: F8, radius: float, texel: float) -> ShadowMap:
        near = np.abs(self._placed[:, :2] - middle[:2]).max(axis=1, initial=0.0) < radius + casters.radii
        kept = Casters(casters.items[near], casters.centres[near], casters.radii[near])
        return ShadowMap(_box(rotation, middle, radius, *self._depth), rotation.T @ middle, texel, kept)


def _settle(wanted: F8, radii: F8, before: F8 | None) -> F8:
    """Where the middles of boxes are to be [m], [n, 3]."""
    if before is None:
        return wanted
    off = np.abs(wanted - before)[:, :2].max(axis=1) / radii
    moves = (off > _MUST) | ((off > _WORTH) & (np.arange(len(off)) == off.argmax()))
    return np.where(moves[:, None], wanted, before)


def _depth_of(heights: F8, radii: F8) -> tuple[float, float]:
    """Height of the caster farthest towards the sun and of the lowest [m], in steps that moving casters rarely leave.

    Args:
        heights: Of the casters' middles towards the sun [m], [n].
        radii: Their bounding radii [m], [n].
    """
    if len(heights) == 0:
        return _LEAST_DEPTH, 0.0
    top, bottom = float((heights + radii).max()), float((heights - radii).min())
    step = 2.0 ** math.ceil(math.log2(max(top - bottom, _LEAST_DEPTH))) / _DEPTH_STEPS
    return step * (math.floor(top / step) + 1), step * math.floor(bottom / step)


def _box(rotation: F8, middle: F8, radius: float, top: float, bottom: float) -> F8:
    """Orthographic projection: `radius` about the middle across, from `top` towards the sun down to `bottom`."""
    clip = np.eye(4)
    half, centre = 0.5 * (top - bottom), 0.5 * (top + bottom)
    clip[:2, :3], clip[2, :3] = rotation[:2] / radius, -rotation[2] / half
    clip[:2, 3] = -middle[:2] / radius
    clip[2, 3] = centre / half
    return clip
