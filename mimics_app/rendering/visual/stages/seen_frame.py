"""Everything a frame's picture depends on, for comparison with another frame."""

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

__all__ = ["SeenFrame", "capture_frame", "may_keep"]


_MIN_PIXELS = 10_000
"""Number of pixels from which the search for changes costs less than drawing all of them."""

_NO_SPRITES = np.zeros((0, 4))


@dataclass(frozen=True, eq=False)
class SeenFrame:
    """Everything a frame's picture depends on.

    Attributes:
        fixed: Values that affect the whole picture; equal to those of another frame where none of them changed.
        pictures: All textures.
        view: The view.
        rectangle: Rectangle in the target [px].
        listed: Its draw list.
        subentities: The world's render list that the draw list was built from.
        sprites: All fields of its sprites, one row each, float64 [n, m]; bounding spheres in the first four columns.
        sun: Unit vector towards the sun, [3]; None where it has no shadow map.
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
    """Whether parts of the last picture may be reused: one large view, without content `capture_frame` leaves out."""
    world = scene.world
    living = world.mirrors or world.screens or world.insets or world.cords or world.effects.projectors
    plain = scene.settings.ambient_occlusion == 0.0 and not scene.by_stencil
    return len(views) == 1 and rectangle[2] * rectangle[3] >= _MIN_PIXELS and plain and not living


def capture_frame(scene: FrameScene, view: View, rectangle: Rect, listed: DrawList, shaders: int) -> SeenFrame:
    """Capture what a frame's picture depends on.

    Args:
        scene: World, light and settings of the frame.
        view: The view.
        rectangle: Rectangle in the target [px].
        listed: Its draw list.
        shaders: Number of programs replaced by reloads so far.
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
