"""Everything a frame's picture depends on, for comparison with another frame."""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from mimics_app.contracts.arrays import B1, F8
from mimics_app.rendering.visual.drawing.draw_list import DrawList
from mimics_app.rendering.visual.effects.projectors import Beam
from mimics_app.rendering.visual.figures.hud import Hud
from mimics_app.rendering.visual.passes.cord import CORD_BLOCK, fill_cord_block
from mimics_app.rendering.visual.passes.hud import places_of, plane_of_views
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.shadows.shadow_maps import ShadowMap
from mimics_app.rendering.visual.stages.world_stage import FrameScene
from mimics_app.rendering.visual.view import Rect, View
from mimics_app.world.content.cords import Cord
from mimics_app.world.content.materials.material import TextureData
from mimics_app.world.content.world import World
from mimics_app.world.graph.render_list import RenderList

__all__ = ["FrameInputs", "Overlaid", "capture_frame", "may_keep"]


_MIN_PIXELS = 10_000
"""Number of pixels from which the search for changes costs less than drawing all of them."""

_NOWHERE = np.zeros((0, 4))

_PIECES = 16
"""Pieces of a cord: rectangles around pieces cover fewer pixels than one around all of it."""
_SWELL = 1.5
"""Largest radius of a rippled cord over its radius (see world/content/cords.py)."""


@dataclass(frozen=True, eq=False)
class Overlaid:
    """A projected texture or a cord: it changes the pixels within a place of its own.

    Attributes:
        state: Everything its pixels depend on, apart from light and surfaces.
        hulls: Convex hulls of points that it lies in, world [m], float64 [m, k, 3].
        reach: Distance around them [m].
    """

    state: object
    hulls: F8
    reach: float


@dataclass(frozen=True, eq=False)
class FrameInputs:
    """Everything a frame's picture depends on.

    Attributes:
        fixed: Values that affect the whole picture; equal to those of another frame where none of them changed.
        pictures: All textures.
        world: The world.
        view: The view.
        rectangle: Rectangle in the target [px].
        listed: Its draw list.
        shown: Items of the levels of detail that are drawn in the view or in shadow maps, [n].
        subentities: The world's render list that the draw list was built from.
        sprites: All fields of its sprites, one row each, float64 [n, m]; bounding spheres in the first four columns.
        lit: Sprites that are lit, [n].
        overlaid: Projected textures and cords that are shown, by index or name.
        sun: Unit vector towards the sun, [3]; None where it has no shadow map.
        maps: Shadow maps of the sun.
        cones: True where spot lights have shadow maps.
        renewed: Items that show a live picture which is drawn in this frame, [n].
        redrawn: Where mirrors show another reflection, as shares of the picture: left, right, bottom, top; [m, 4].
        spreads: True where a change reaches beyond itself and its shadow map: ambient occlusion darkens what is around
            it, and its shadow volume crosses the picture.
        board: Rectangles of the heads-up display where it is drawn into the kept picture, as shares of the picture:
            left, right, bottom, top, float64 [m, 4].
    """

    fixed: object
    pictures: list[TextureData]
    world: World
    view: View
    rectangle: Rect
    listed: DrawList
    shown: B1
    subentities: RenderList
    sprites: F8
    lit: B1
    overlaid: Mapping[int | str, Overlaid]
    sun: F8 | None
    maps: list[ShadowMap]
    cones: bool
    renewed: B1
    redrawn: F8
    spreads: bool
    board: F8


def may_keep(scene: FrameScene, views: Sequence[View], rectangle: Rect) -> bool:
    """Whether the last picture may be reused: one large view, without content `capture_frame` leaves out."""
    # Over a kept picture an inset is drawn after the samples are resolved: its border would be another one.
    sampled = bool(scene.world.insets) and scene.settings.msaa > 0
    return len(views) == 1 and rectangle[2] * rectangle[3] >= _MIN_PIXELS and not sampled


def capture_frame(
    scene: FrameScene,
    listed: DrawList,
    shaders: int,
    view: View,
    rectangle: Rect,
    key: Hashable,
    renewed: B1,
    redrawn: F8 = _NOWHERE,
    hud: Hud | None = None,
) -> FrameInputs:
    """Capture what a frame's picture depends on.

    Args:
        scene: World, light and settings of the frame.
        listed: Its draw list.
        shaders: Number of programs replaced by reloads so far.
        view: The view.
        rectangle: Rectangle in the target [px].
        key: Identifies the view from frame to frame, see `DrawList.batch_views`.
        renewed: Items that show a live picture which is drawn in this frame, [n].
        redrawn: Where mirrors show another reflection, see `FrameInputs`.
        hud: The heads-up display that is drawn into the kept picture, None where it is drawn over it.
    """
    plan, lighting, world = scene.plan, scene.lighting, scene.world
    fixed = (
        (world, scene.settings, shaders, world.environment, world.effects.revision, rectangle),
        (view.figures, lighting.figures, plan.figures),
    )
    shown = listed.shown_in(view, rectangle[2:], key)
    for shadow in plan.maps:
        shown[shadow.casters.items] = True
    return FrameInputs(
        fixed=fixed,
        pictures=list(world.textures.values()),
        world=world,
        view=view,
        rectangle=rectangle,
        listed=listed,
        shown=shown,
        subentities=world.subentities(),
        sprites=_NOWHERE if scene.effects is None else scene.effects.sprites,
        lit=np.zeros(0, np.bool_) if scene.effects is None else scene.effects.lit,
        overlaid=_overlaid(scene),
        sun=lighting.sun_direction if plan.sun else None,
        maps=plan.sun,
        cones=bool(plan.spots),
        renewed=renewed,
        redrawn=redrawn,
        spreads=scene.settings.ambient_occlusion > 0.0 or scene.by_stencil,
        board=_NOWHERE if hud is None else _places_on_board(hud, view, scene.settings),
    )


def _places_on_board(hud: Hud, view: View, settings: RenderSettings) -> F8:
    """Return where the rectangles of the display are, see `places_of`."""
    return places_of(hud.rows(), plane_of_views([view], settings.hud_depth, settings.hud_enlarged))


def _overlaid(scene: FrameScene) -> dict[int | str, Overlaid]:
    found: dict[int | str, Overlaid] = {}
    if scene.effects is not None:
        found |= {index: _of_beam(beam) for index, beam in scene.effects.beams.items()}
    time_s, sun = scene.world.effects.time, scene.lighting.sun_direction
    return found | {name: _of_cord(cord, sun, time_s) for name, cord in scene.world.cords.items() if cord.visible}


def _of_beam(beam: Beam) -> Overlaid:
    onto = None if beam.onto is None else beam.onto.tobytes()
    state = (beam.spec, beam.key, beam.texture_from_world.tobytes(), beam.towards.tobytes(), onto)
    return Overlaid(state, beam.corners[None], 0.0)


def _of_cord(cord: Cord, sun: F8, time_s: float) -> Overlaid:
    block = np.zeros((), CORD_BLOCK)
    fill_cord_block(block, cord, np.zeros(3), sun, time_s)
    curve = cord.curve
    points = curve.point(np.linspace(0.0, curve.length, _PIECES + 1))
    # An arc leaves the hull of its ends by at most its curvature times an eighth of its squared length.
    sag = 0.125 * curve.bend * (curve.length / _PIECES) ** 2
    return Overlaid(block.tobytes(), np.stack([points[:-1], points[1:]], axis=1), _SWELL * cord.shown_radius + sag)
