"""Cascaded shadow maps: nested boxes along the sun's rays around the camera."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.rendering.visual.drawing.shadow_casters import Casters
from mimics_app.rendering.visual.lighting import sun_axes
from mimics_app.rendering.visual.shadows.shadow_maps import ShadowMap
from mimics_app.rendering.visual.view import View

__all__ = ["MAX_CASCADES", "Cascades"]


MAX_CASCADES = 4

_AHEAD = 0.6
"""Distance of a cascade's centre in front of the camera, in its radii: little behind the camera is visible."""

_GROWTH = 3.5
"""Ratio of the radii of successive cascades."""

_WORTH, _MUST = 0.125, 0.5
"""Offset of a cascade, in its radii, from which it may move, and from which it must."""

_DEPTH_STEPS, _MIN_DEPTH = 16, 1.0
"""Steps per power of two in which the depth range of the cascades grows, and its minimum [m]."""


class Cascades:
    """The cascades of the sun, kept from frame to frame, for any number of views.

    Each box has a fixed size around a point in front of the camera and moves by whole texels: neither rotation nor
    translation of the camera makes edges crawl. It stays while it is near enough, so that the map of a static scene is
    not redrawn, and per frame only the box with the largest offset moves: a point that has left the inner box is found
    in the next one. All have the same depth range, from the caster nearest to the sun to the lowest one: a point below
    all casters counts as at the bottom, where it is in the same shadow.
    """

    def __init__(self) -> None:
        self._form: object = None
        self._casters: Casters | None = None
        self._centres: F8 | None = None
        self._maps: list[ShadowMap | None] = []

    def fit(
        self, sun_direction: F8, views: Sequence[View], casters: Casters, distance: float, count: int, size: int
    ) -> list[ShadowMap]:
        """Return the maps of a frame, the innermost first; an unchanged one is the same object as before.

        Args:
            sun_direction: Unit vector towards the sun.
            views: The views.
            casters: All casters, `centres` and `radii` by `items`; the same object while none of them changes.
            distance: Distance from the camera up to which there are shadows [m].
            count: Number of cascades, 1 to MAX_CASCADES.
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
        centres = _stabilise(wanted, radii, self._centres)
        for number, (centre, radius) in enumerate(zip(centres, radii.tolist(), strict=True)):
            if self._centres is not None and not np.array_equal(centre, self._centres[number]):
                self._maps[number] = None
            if self._maps[number] is None:
                self._maps[number] = self._make(rotation, casters, centre, radius, texel=2.0 * radius / size)
        self._centres = centres
        return [shadow for shadow in self._maps if shadow is not None]

    def _take_over(self, rotation: F8, casters: Casters, form: tuple[bytes, float, int, int]) -> None:
        """Discard maps of other casters, and boxes of another sun, distance, count or size."""
        if form != self._form:
            self._form, self._casters, self._centres = form, None, None
        if casters is not self._casters:
            self._casters = casters
            self._rotated = casters.centres @ rotation.T
            self._depth = _depth_of(self._rotated[:, 2], casters.radii)
            self._maps = [None] * form[2]

    def _make(self, rotation: F8, casters: Casters, centre: F8, radius: float, texel: float) -> ShadowMap:
        near = np.abs(self._rotated[:, :2] - centre[:2]).max(axis=1, initial=0.0) < radius + casters.radii
        kept = Casters(casters.items[near], casters.centres[near], casters.radii[near])
        return ShadowMap(_box(rotation, centre, radius, *self._depth), rotation.T @ centre, texel, kept)


def _stabilise(wanted: F8, radii: F8, before: F8 | None) -> F8:
    """Return the new centres of the boxes [m], [n, 3]."""
    if before is None:
        return wanted
    off = np.abs(wanted - before)[:, :2].max(axis=1) / radii
    moves = (off > _MUST) | ((off > _WORTH) & (np.arange(len(off)) == off.argmax()))
    return np.where(moves[:, None], wanted, before)


def _depth_of(heights: F8, radii: F8) -> tuple[float, float]:
    """Return top and bottom of the casters along the sun's direction [m], rounded to steps against small motions.

    Args:
        heights: Coordinates of the casters' centres towards the sun [m], [n].
        radii: Their bounding radii [m], [n].
    """
    if len(heights) == 0:
        return _MIN_DEPTH, 0.0
    top, bottom = float((heights + radii).max()), float((heights - radii).min())
    step = 2.0 ** math.ceil(math.log2(max(top - bottom, _MIN_DEPTH))) / _DEPTH_STEPS
    return step * (math.floor(top / step) + 1), step * math.floor(bottom / step)


def _box(rotation: F8, centre: F8, radius: float, top: float, bottom: float) -> F8:
    """Return the orthographic projection of a box: `radius` around its centre, from `top` down to `bottom`."""
    clip = np.eye(4)
    half, level = 0.5 * (top - bottom), 0.5 * (top + bottom)
    clip[:2, :3], clip[2, :3] = rotation[:2] / radius, -rotation[2] / half
    clip[:2, 3] = -centre[:2] / radius
    clip[2, 3] = level / half
    return clip
