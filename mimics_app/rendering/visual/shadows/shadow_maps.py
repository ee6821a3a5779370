"""Where shadow maps look and where they lie: cascades of the sun and one map per spot light, in one atlas."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mimics_app.rendering.visual.drawing.draw_list import Casters
from mimics_app.rendering.visual.lighting import ShadowFrustum, sun_axes
from mimics_app.rendering.visual.view import View, compose_clip_from_view
from mimics_app.world.light import Light

__all__ = [
    "MAX_CASCADES",
    "MAX_SPOT_MAPS",
    "ShadowMap",
    "ShadowPlan",
    "fit_cascades",
    "fit_spot",
    "lay_out",
    "texture_from_world",
    "whole_map",
]

F8 = NDArray[np.float64]

MAX_CASCADES = 4
MAX_SPOT_MAPS = 4

_AHEAD = 0.6
"""How far before the eye a cascade's middle lies, in its radii: most of what is behind the eye is not seen."""

_GROWTH = 3.5
"""Each cascade's radius over that of the one inside it."""

_WORTH, _MUST = 0.125, 0.5
"""How far a cascade may be off, in its radii, before it is worth moving, and before it has to be."""

_DEPTH_STEPS, _LEAST_DEPTH = 16, 1.0
"""Steps in which the depth of all cascades grows, to its power of two, and the least one [m]."""

_NEAR_OF_SPOT, _REACH_OF_SPOT = 0.05, 50.0
_TO_TEXTURE = np.array([[0.5, 0.0, 0.0, 0.5], [0.0, 0.5, 0.0, 0.5], [0.0, 0.0, 0.5, 0.5], [0.0, 0.0, 0.0, 1.0]])


@dataclass(frozen=True, eq=False)
class ShadowMap:
    """One map of the atlas.

    Attributes:
        clip_from_world: From the light, float64 [4, 4].
        origin: Point near which its casters are placed, world [m], float64 [3].
        texel: Width of a texel [m]; of a spot's at 1 m.
        casters: What it has to draw.
        tile: Column and row in the atlas's grid of squares.
        middle: Of a cascade's box, along the sun's axes [m], float64 [3].
    """

    clip_from_world: F8
    origin: F8
    texel: float
    casters: Casters
    tile: tuple[int, int] = (0, 0)
    middle: F8 | None = None


@dataclass(eq=False)
class ShadowPlan:
    """All maps of a frame.

    Attributes:
        grid: Tiles along a side of the atlas.
        sun: The sun's, the innermost first.
        spots: By the number of the light in the view block.
    """

    grid: int
    sun: list[ShadowMap]
    spots: dict[int, ShadowMap]

    @property
    def maps(self) -> list[ShadowMap]:
        """All of them."""
        return [*self.sun, *self.spots.values()]

    def tile_of(self, shadow: ShadowMap) -> tuple[float, float, float]:
        """Lower left corner and width of a map's tile in the atlas, in [0, 1]."""
        column, row = shadow.tile
        return column / self.grid, row / self.grid, 1.0 / self.grid


def texture_from_world(shadow: ShadowMap) -> F8:
    """Projection to coordinates of the map's own tile and depth, all in [0, 1]."""
    return np.asarray(_TO_TEXTURE @ shadow.clip_from_world)


def lay_out(sun: Sequence[ShadowMap], spots: dict[int, ShadowMap]) -> ShadowPlan:
    """Give each map its tile: the smallest square grid that holds them all."""
    grid = max(1, math.ceil(math.sqrt(len(sun) + len(spots))))
    placed = [
        replace(each, tile=(number % grid, number // grid)) for number, each in enumerate([*sun, *spots.values()])
    ]
    return ShadowPlan(grid, placed[: len(sun)], dict(zip(spots, placed[len(sun) :], strict=True)))


def whole_map(frustum: ShadowFrustum, casters: Casters) -> ShadowMap:
    """The one map that holds every caster."""
    return ShadowMap(frustum.clip_from_world, frustum.centre, frustum.texel, casters)


def fit_cascades(
    sun_direction: F8,
    views: Sequence[View],
    casters: Casters,
    distance: float,
    count: int,
    size: int,
    before: Sequence[ShadowMap] = (),
) -> list[ShadowMap]:
    """Boxes along the sun's rays about the eyes, one in another; right for any number of views at once.

    Each box is of fixed size about a point before the eyes and moves by whole texels: neither turning nor walking makes
    edges crawl. It stays where it was while that is near enough, so that the map of a scene that stands still is the
    same one, and of several only the one that is most off moves in a frame: a place that the inner box no longer holds
    is found in the next. All tell depth alike, from the farthest caster towards the sun to the lowest one: what lies
    below all of them is told as if it lay at the bottom, where it is in the same shadow.

    Args:
        sun_direction: Unit, towards the sun.
        views: Whose eyes.
        casters: All of them, `centres` and `radii` by `items`.
        distance: How far from the eyes shadows are seen [m].
        count: Boxes, 1 to MAX_CASCADES.
        size: Texels along a side of one map.
        before: Those of the frame before.
    """
    rotation = sun_axes(sun_direction)
    eye = rotation @ np.mean([view.eye_world for view in views], axis=0)
    forward = -(rotation @ np.mean([view.world_from_eye[:3, 2] for view in views], axis=0))
    seen = distance / (1.0 + _AHEAD) * _GROWTH ** np.arange(1.0 - count, 1.0)
    radii = seen / (1.0 - _WORTH)
    texels = 2.0 * radii / size
    wanted = np.round((eye + _AHEAD * seen[:, None] * forward) / texels[:, None]) * texels[:, None]
    middles = _settle(wanted, radii, _middles(before, rotation, radii))
    placed = casters.centres @ rotation.T
    top, bottom = _depth_of(placed[:, 2], casters.radii)
    maps = []
    for middle, radius, texel in zip(middles, radii.tolist(), texels.tolist(), strict=True):
        near = np.abs(placed[:, :2] - middle[:2]).max(axis=1, initial=0.0) < radius + casters.radii
        kept = Casters(casters.items[near], casters.centres[near], casters.radii[near])
        clip = _box(rotation, middle, radius, top, bottom)
        maps.append(ShadowMap(clip, rotation.T @ middle, texel, kept, middle=middle))
    return maps


def _middles(before: Sequence[ShadowMap], rotation: F8, radii: F8) -> F8 | None:
    """Where the middles of boxes were along the sun's axes [m], [n, 3]; None where those were other boxes."""
    middles = [shadow.middle for shadow in before if shadow.middle is not None]
    if len(middles) != len(radii):
        return None
    axes = rotation[:2] / radii[:, None, None]
    alike = np.array_equal([shadow.clip_from_world[:2, :3] for shadow in before], axes)
    return np.array(middles) if alike else None


def _settle(wanted: F8, radii: F8, before: F8 | None) -> F8:
    """Where the middles of boxes are to be [m], [n, 3]."""
    if before is None:
        return wanted
    off = np.abs(wanted - before)[:, :2].max(axis=1) / radii
    moves = (off > _MUST) | ((off > _WORTH) & (np.arange(len(off)) == off.argmax()))
    return np.where(moves[:, None], wanted, before)


def fit_spot(light: Light, casters: Casters, size: int) -> ShadowMap:
    """The cone of a spot light."""
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
