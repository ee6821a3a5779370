"""Stage of shadow maps: choice of the maps, their casters, and their drawing into the atlas."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from mimics_app.contracts.arrays import F8, I4
from mimics_app.rendering.visual.drawing.draw_items import DrawItems
from mimics_app.rendering.visual.drawing.draw_list import DrawList
from mimics_app.rendering.visual.drawing.frame_buffers import FrameBuffers
from mimics_app.rendering.visual.lighting import Lighting
from mimics_app.rendering.visual.passes.shadow import MapWork, draw_shadows
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.shadows.cascades import Cascades
from mimics_app.rendering.visual.shadows.shadow_layers import ShadowLayers, SunBox, equal_bytes
from mimics_app.rendering.visual.shadows.shadow_maps import (
    MAX_SPOT_MAPS,
    ShadowMap,
    ShadowPlan,
    fit_spot,
    lay_out,
    whole_map,
)
from mimics_app.rendering.visual.shadows.shadow_target import ShadowTarget
from mimics_app.rendering.visual.surfaces.rasteriser import rasteriser_of
from mimics_app.rendering.visual.view import View

if TYPE_CHECKING:
    import moderngl

__all__ = ["ShadowStage", "light_features"]


def light_features(lighting: Lighting, settings: RenderSettings) -> frozenset[str]:
    """Return the shader features that a frame's light needs, each "NAME" or "NAME=NUMBER"."""
    maps = _sun_maps(lighting, settings)
    wanted = {
        f"PLACED_LIGHTS={len(lighting.places)}": bool(lighting.places),
        f"SUN_SHADOW={maps}": maps > 0,
        "SPOT_SHADOWS": settings.shadow_size > 0 and bool(_spots(lighting)),
        "HAZE": (lighting.fog.density if lighting.fog else settings.fog_density) > 0.0,
        "TONED": settings.tone_map == "neutral",
    }
    return frozenset(feature for feature, has in wanted.items() if has)


class ShadowStage:
    """The shadow atlas and its content.

    Attributes:
        plan: The maps of the frame.
        work: Draws of each of its maps; None for an unchanged one.
    """

    def __init__(self, ctx: moderngl.Context, size: int) -> None:
        self._ctx = ctx
        self._target = ShadowTarget(ctx, size)
        self.plan = ShadowPlan(1, [], {})
        member = rasteriser_of(ctx).member
        self._cascades, self._box, self._layers = Cascades(), member(SunBox)(), member(ShadowLayers)()
        self.work: list[MapWork | None] = []
        self._drawn: dict[tuple[int, int], _Drawn] = {}

    def resize(self, size: int) -> None:
        """Change the width of the atlas [texel]; 0 leaves it as it is, unused."""
        if size not in (0, self._target.size):
            self._target.release()
            self._target = ShadowTarget(self._ctx, size)
            self._drawn.clear()
            self._layers.forget()

    def prepare(
        self,
        lighting: Lighting,
        views: Sequence[View],
        listed: DrawList,
        frame: FrameBuffers,
        settings: RenderSettings,
        coarser: float = 1.0,
    ) -> None:
        """Choose the frame's maps and queue the casters of those that have changed.

        Args:
            lighting: Light of the frame.
            views: The views.
            listed: The draw list.
            frame: Buffers of the frame.
            settings: Quality.
            coarser: Factor on the texel width by which casters' levels of detail are chosen, for small pictures.
        """
        sun_maps = _sun_maps(lighting, settings)
        spots = _spots(lighting) if settings.shadow_size else []
        tile = settings.shadow_size // max(1, math.ceil(math.sqrt(sun_maps + len(spots))))
        sun: list[ShadowMap] = []
        if sun_maps and settings.shadow_distance > 0.0:
            casters = listed.casters(math.inf)
            distance = settings.shadow_distance
            sun = self._cascades.fit(lighting.sun_direction, views, casters, distance, sun_maps, tile)
        elif sun_maps:
            casters = listed.casters(settings.shadow_reach)
            frustum = self._box.fit(lighting.sun_direction, casters.centres, casters.radii, tile)
            sun = [whole_map(frustum, casters)] if frustum is not None else []
        sun = [replace(each, casters=listed.coarser(each.casters, coarser * each.texel)) for each in sun]
        every = listed.casters(math.inf) if spots else None
        cones = {number: fit_spot(lighting.places[number], every, tile) for number in spots if every is not None}
        self.plan = lay_out(sun, cones)
        self._layers.begin(listed)
        self.work = [
            self._queue(each, listed, frame) if self._is_stale(each, listed) else None for each in self.plan.maps
        ]

    @property
    def triangles(self) -> int:
        """Triangles drawn into the maps of the frame."""
        return sum(work.triangles for work in self.work if work is not None)

    def draw(self, frame: FrameBuffers) -> int:
        """Draw the changed maps and bind the atlas; return the draw calls."""
        draws = draw_shadows(self._ctx, frame, self._target, self.plan, self.work)
        self._target.bind()
        return draws

    def bind(self, binding: int) -> None:
        """Bind the atlas's depths as a texture."""
        self._target.bind(binding)

    def release(self) -> None:
        """Free the atlas."""
        self._target.release()

    def _queue(self, shadow: ShadowMap, listed: DrawList, frame: FrameBuffers) -> MapWork:
        """Queue the casters of a map; no static ones where their depths were kept."""
        width = self._target.size // self.plan.grid
        split, casters = self._layers.split(shadow, self.plan.grid, listed, width), shadow.casters
        still, moving = (
            None if items is None else listed.batch_casters(frame, casters.only(items), shadow.origin)
            for items in (split.still, split.moving)
        )
        return MapWork(still, split.keep, moving or [], split.reach)

    def _is_stale(self, shadow: ShadowMap, listed: DrawList) -> bool:
        """Whether a map has to be redrawn; records its present content."""
        was = self._drawn.get(shadow.tile)
        now = _Drawn(self.plan.grid, listed.items, shadow.clip_from_world, shadow.casters.items)
        self._drawn[shadow.tile] = now
        return (
            was is None or not was.same(now) or listed.moved is None or bool(listed.moved[shadow.casters.items].any())
        )


@dataclass(frozen=True, eq=False)
class _Drawn:
    """Content of a tile: grid size, draw items, projection and casters."""

    grid: int
    items: DrawItems
    clip: F8
    casters: I4

    def same(self, other: _Drawn) -> bool:
        """Whether both have the same depths, if no caster has moved."""
        alike = self.grid == other.grid and self.items is other.items
        return alike and equal_bytes(self.clip, other.clip) and equal_bytes(self.casters, other.casters)


def _sun_maps(lighting: Lighting, settings: RenderSettings) -> int:
    """Return the number of the sun's maps: one around all casters, or cascades."""
    if not (lighting.sun_casts_shadow and settings.shadow_size and settings.shadows.startswith("texture")):
        return 0
    return settings.cascades if settings.shadow_distance > 0.0 else 1


def _spots(lighting: Lighting) -> list[int]:
    """Return the numbers of the spot lights that have maps."""
    casting = [i for i, light in enumerate(lighting.places) if light.kind == "spot" and light.casts_shadow]
    return casting[:MAX_SPOT_MAPS]
