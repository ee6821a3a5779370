"""Shadow maps and their tiles in one atlas: those of the sun, and one per spot light."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.rendering.visual.drawing.shadow_casters import Casters
from mimics_app.rendering.visual.lighting import ShadowFrustum
from mimics_app.rendering.visual.view_matrices import TEXTURE_FROM_CLIP, compose_clip_from_view
from mimics_app.world.graph.light import Light

__all__ = [
    "MAX_SPOT_MAPS",
    "ShadowMap",
    "ShadowPlan",
    "fit_spot",
    "lay_out",
    "texture_from_world",
    "whole_map",
]


MAX_SPOT_MAPS = 4

_NEAR_OF_SPOT, _REACH_OF_SPOT = 0.05, 50.0


@dataclass(frozen=True, eq=False)
class ShadowMap:
    """One map of the atlas.

    Attributes:
        clip_from_world: Projection of the light, float64 [4, 4].
        origin: Origin of the casters' instance matrices, world [m], float64 [3].
        texel: Width of a texel [m]; for a spot light at 1 m.
        casters: Casters to draw.
        tile: Column and row in the atlas's grid of square tiles.
    """

    clip_from_world: F8
    origin: F8
    texel: float
    casters: Casters
    tile: tuple[int, int] = (0, 0)


@dataclass(eq=False)
class ShadowPlan:
    """All maps of a frame.

    Attributes:
        grid: Tiles along a side of the atlas.
        sun: Maps of the sun, the innermost first.
        spots: Maps of spot lights by the light's number in the view block.
    """

    grid: int
    sun: list[ShadowMap]
    spots: dict[int, ShadowMap]

    @property
    def maps(self) -> list[ShadowMap]:
        """All maps."""
        return [*self.sun, *self.spots.values()]

    @cached_property
    def figures(self) -> tuple[object, ...]:
        """Grid and projections, to be compared with those of another frame."""
        return self.grid, tuple(self.spots), *((each.texel, each.clip_from_world.tobytes()) for each in self.maps)

    def tile_of(self, shadow: ShadowMap) -> tuple[float, float, float]:
        """Return lower left corner and width of a map's tile in the atlas, in [0, 1]."""
        column, row = shadow.tile
        return column / self.grid, row / self.grid, 1.0 / self.grid


def texture_from_world(shadow: ShadowMap) -> F8:
    """Return the projection to coordinates in the map's own tile and depth, all in [0, 1]."""
    return np.asarray(TEXTURE_FROM_CLIP @ shadow.clip_from_world)


def lay_out(sun: Sequence[ShadowMap], spots: dict[int, ShadowMap]) -> ShadowPlan:
    """Assign each map a tile of the smallest square grid that holds them all, those of the sun in its first 2 x 2."""
    grid = max(1, math.ceil(math.sqrt(len(sun) + len(spots))))
    tiles = sorted(((number % grid, number // grid) for number in range(grid * grid)), key=max)
    pairs = zip([*sun, *spots.values()], tiles, strict=False)
    placed = [each if each.tile == tile else replace(each, tile=tile) for each, tile in pairs]
    return ShadowPlan(grid, placed[: len(sun)], dict(zip(spots, placed[len(sun) :], strict=True)))


def whole_map(frustum: ShadowFrustum, casters: Casters) -> ShadowMap:
    """Return the one map of the sun that covers every caster."""
    return ShadowMap(frustum.clip_from_world, frustum.centre, frustum.texel, casters)


def fit_spot(light: Light, casters: Casters, size: int) -> ShadowMap:
    """Return the map of a spot light's cone, `size` texels wide."""
    reach = light.range if math.isfinite(light.range) else _REACH_OF_SPOT
    slope = math.tan(min(light.outer_cone, 1.48))
    place, towards = light.position_world, light.direction_world
    world_from_light = light.node.world_matrix().copy()
    axes = world_from_light[:3, :3] / np.linalg.norm(world_from_light[:3, :3], axis=0)
    view_from_world = np.eye(4)
    view_from_world[:3, :3] = axes.T
    view_from_world[:3, 3] = -(axes.T @ place)
    along = (casters.centres - place) @ towards
    near = (along > -casters.radii) & (along < reach + casters.radii)
    kept = Casters(casters.items[near], casters.centres[near], casters.radii[near])
    # Four texels of margin for the filter.
    edge = slope * size / (size - 8)
    clip = compose_clip_from_view((-edge, edge, -edge, edge), _NEAR_OF_SPOT, reach) @ view_from_world
    return ShadowMap(clip, place, 2.0 * edge / size, kept)
