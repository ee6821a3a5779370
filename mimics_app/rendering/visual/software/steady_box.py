"""The box of the sun's one shadow map around all casters, kept while they stay inside."""

from __future__ import annotations

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.rendering.visual.kernels.bounds import enclose
from mimics_app.rendering.visual.lighting import SHADOW_STEP, ShadowFrustum, fit_shadow_frustum, shadow_texel
from mimics_app.rendering.visual.shadows.shadow_layers import SunBox

__all__ = ["SteadyBox"]


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
