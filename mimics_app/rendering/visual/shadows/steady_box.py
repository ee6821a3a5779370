"""The one box of a sun whose map holds all casters, kept from frame to frame while they stay in it."""

from __future__ import annotations

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.rendering.visual.lighting import SHADOW_STEP, ShadowFrustum, fit_shadow_frustum

__all__ = ["SteadyBox"]


_WIDEST = SHADOW_STEP**3
"""How many times as wide as it would have to be a box may be before it is made smaller."""

_LEAST_TEXELS = 1.5
"""Between a caster and the border of the map: as far as the filter reaches."""


class SteadyBox:
    """Remembers the box of the last frame: its map can be kept in part only where it stays exactly the same.

    A caster that leaves it gets a box one step wider than need be, so that the next one does not leave it at once.
    """

    def __init__(self) -> None:
        self._sun = b""
        self._box: ShadowFrustum | None = None

    def fit(self, sun_direction: F8, centres: F8, radii: F8, size: int) -> ShadowFrustum | None:
        """The box of this frame; arguments and result as of `fit_shadow_frustum`."""
        fitted, had = fit_shadow_frustum(sun_direction, centres, radii, size), self._box
        alike = had is not None and had.size == size and self._sun == sun_direction.tobytes()
        if fitted is not None and had is not None and alike:
            narrow = had.texel <= _WIDEST * fitted.texel
            if narrow and _holds(had, centres, radii):
                return had
            if narrow:
                fitted = fit_shadow_frustum(sun_direction, centres, radii, size, room=SHADOW_STEP)
        self._sun, self._box = sun_direction.tobytes(), fitted
        return fitted


def _holds(box: ShadowFrustum, centres: F8, radii: F8) -> bool:
    """Whether all spheres are in a box."""
    clip = box.clip_from_world
    half = 0.5 * box.size * box.texel
    reach = np.abs(centres @ clip[:3, :3].T + clip[:3, 3]) + radii[:, None] / half
    inside = np.array([*[1.0 - 2.0 * _LEAST_TEXELS / box.size] * 2, 1.0])
    return bool((reach <= inside).all())
