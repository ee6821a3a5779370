"""All that a frame's picture depends on, to be compared with that of another frame."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.rendering.visual.drawing.draw_list import DrawList
from mimics_app.rendering.visual.shadows.shadow_maps import ShadowMap
from mimics_app.rendering.visual.stages.world_stage import FrameScene
from mimics_app.rendering.visual.view import Rect, View
from mimics_app.world.materials.material import TextureData
from mimics_app.world.render_list import RenderList

__all__ = ["SeenFrame", "look_at", "may_keep"]


_LEAST_PIXELS = 10_000
"""Of a picture of fewer, looking for what changed costs more than drawing them."""

_NO_SPRITES = np.zeros((0, 4))


@dataclass(frozen=True, eq=False)
class SeenFrame:
    """All that a frame's picture depends on.

    Attributes:
        fixed: What changes all of it: anything that compares equal to that of another frame where that is the same.
        pictures: All textures.
        view: From where.
        rectangle: Where in the target [px].
        listed: Its bodies.
        subentities: The world's list they were made of.
        sprites: Places [m], sizes and looks of its sprites, one row each, float64 [n, m]; the first four columns are a
            sphere about it.
        sun: Direction to the sun, unit, [3]; None where it casts no shadow.
        maps: Shadow maps of the sun.
        cones: True where spot lights have shadow maps.
    """

    fixed: object
    pictures: list[TextureData]
    view: View
    rectangle: Rect
    listed: DrawList
    subentities: RenderList
    sprites: F8
    sun: F8 | None
    maps: list[ShadowMap]
    cones: bool


def may_keep(scene: FrameScene, views: Sequence[View], rectangle: Rect) -> bool:
    """Whether one eye sees bodies and sprites alone, lit by nothing but lights and maps, in pixels worth saving.

    That is what `look_at` knows of.
    """
    world = scene.world
    living = world.mirrors or world.screens or world.insets or world.cords or world.effects.projectors
    plain = scene.settings.ambient_occlusion == 0.0 and not scene.by_stencil
    return len(views) == 1 and rectangle[2] * rectangle[3] >= _LEAST_PIXELS and plain and not living


def look_at(scene: FrameScene, view: View, rectangle: Rect, listed: DrawList, shaders: int) -> SeenFrame:
    """What a frame sees.

    Args:
        scene: Its world, light and settings, all up to date.
        view: From where.
        rectangle: Where in the target [px].
        listed: Its bodies.
        shaders: How many programs were replaced so far.
    """
    plan, lighting, world = scene.plan, scene.lighting, scene.world
    fixed = (
        (world, scene.settings, shaders, world.environment, world.effects.revision, rectangle),
        (view.world_from_eye.tobytes(), view.tangents, view.near, view.far),
        (lighting.figures, plan.grid, *(each.clip_from_world.tobytes() for each in plan.maps)),
    )
    return SeenFrame(
        fixed=fixed,
        pictures=list(world.textures.values()),
        view=view,
        rectangle=rectangle,
        listed=listed,
        subentities=world.subentities(),
        sprites=_NO_SPRITES if scene.effects is None else scene.effects.sprites,
        sun=lighting.sun_direction if plan.sun else None,
        maps=plan.sun,
        cones=bool(plan.spots),
    )
