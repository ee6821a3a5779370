"""Draws the world into a target, view by view: what every picture of a frame has in common."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

from mimics_app.rendering.visual.drawing.draw_items import DrawItems
from mimics_app.rendering.visual.drawing.frame_buffers import DrawRun, FrameBuffers
from mimics_app.rendering.visual.drawing.mesh_arena import MeshArena
from mimics_app.rendering.visual.lighting import Lighting
from mimics_app.rendering.visual.materials.shader_library import ShaderLibrary
from mimics_app.rendering.visual.passes.ambient import AmbientPass
from mimics_app.rendering.visual.passes.cord import CordPass
from mimics_app.rendering.visual.passes.sky import SkyPass, flat_sky
from mimics_app.rendering.visual.passes.states import draw_runs
from mimics_app.rendering.visual.passes.volumes import VolumePass
from mimics_app.rendering.visual.pictures.live_picture import MirrorPicture
from mimics_app.rendering.visual.pictures.mirror_views import Reflection
from mimics_app.rendering.visual.settings import RenderSettings, StereoPasses
from mimics_app.rendering.visual.shadows.shadow_maps import ShadowPlan
from mimics_app.rendering.visual.stages.eye_pairs import eye_define, group_views
from mimics_app.rendering.visual.surfaces.raw_gl import CLIP_DISTANCE_0, EQUAL
from mimics_app.rendering.visual.view import Rect, View
from mimics_app.rendering.visual.view_block import ViewBlock
from mimics_app.world.world import World

if TYPE_CHECKING:
    import moderngl

    from mimics_app.rendering.visual.effects.projectors import BeamRuns
    from mimics_app.rendering.visual.effects.sprites import SpriteRun
    from mimics_app.rendering.visual.stages.effect_stage import EffectStage

__all__ = ["FrameScene", "ViewDraws", "WorldStage"]


@dataclass(frozen=True, eq=False)
class FrameScene:
    """What all pictures of a frame share.

    Attributes:
        world: What is drawn, after its update.
        items: Its sub-entities.
        lighting: What shines.
        plan: The shadow maps, drawn already.
        settings: Quality.
        ambient: True where the shaders ask how open the surroundings are, whatever the answer.
        lights: Features of shaders that the frame's light needs, without that.
        effects: Sprites and projectors; None in a world without.
    """

    world: World
    items: DrawItems
    lighting: Lighting
    plan: ShadowPlan
    settings: RenderSettings
    ambient: bool = False
    lights: frozenset[str] = frozenset()
    effects: EffectStage | None = None

    @property
    def by_stencil(self) -> bool:
        """True when the sun's shadows are volumes."""
        settings = self.settings
        return settings.shadows.startswith("stencil") and self.lighting.sun_casts_shadow and settings.shadow_size > 0


@dataclass(frozen=True, eq=False)
class ViewDraws:
    """A view with what is drawn in it.

    Attributes:
        view: From where.
        rectangle: Where in the target [px].
        opaque: Runs of draws, near to far.
        mirrors: Those seen in it, with the number of the view and what they show there.
        transparent: Sprites that are cut out, then sprites and blended surfaces, far to near.
        thrown: What projectors put onto the opaque ones.
        stereo: How this eye and the other one of its pair are drawn.
    """

    view: View
    rectangle: Rect
    opaque: list[DrawRun]
    transparent: Sequence[DrawRun | SpriteRun]
    mirrors: Sequence[tuple[MirrorPicture, int, Reflection | None]] = ()
    thrown: Sequence[BeamRuns] = ()
    stereo: StereoPasses = "two_pass"

    @property
    def blended(self) -> list[DrawRun]:
        """What is transparent without the sprites."""
        return [run for run in self.transparent if isinstance(run, DrawRun)]

    @property
    def materials(self) -> set[str]:
        """Names of all surfaces that are drawn."""
        return {run.look.material.name for run in (*self.opaque, *self.blended)}

    @property
    def triangles(self) -> int:
        """In all runs."""
        return sum(run.triangles for run in (*self.opaque, *self.transparent))


class WorldStage:
    """Per view: opaque with what is projected onto it, sky, stencil shadows, transparent."""

    def __init__(
        self,
        ctx: moderngl.Context,
        shaders: ShaderLibrary,
        arena: MeshArena,
        frame: FrameBuffers,
        settings: RenderSettings,
        longest_texture: int,
    ) -> None:
        self._ctx = ctx
        self._arena = arena
        self._frame = frame
        self._shaders = shaders
        self._block = ViewBlock(ctx, settings)
        self._other_block = ViewBlock(ctx, settings)
        self._volumes = VolumePass(ctx, shaders)
        self._ambient = AmbientPass(ctx, shaders, arena, frame)
        self._cords = CordPass(ctx, shaders)
        self.sky = SkyPass(ctx, shaders, longest_texture)

    def draw(self, target: moderngl.Framebuffer, samples: int, scene: FrameScene, views: Sequence[ViewDraws]) -> int:
        """Clear a target and draw the world in each view; the target stays in use.

        Args:
            target: Where to.
            samples: Of the target's pixels.
            scene: What.
            views: From where; their rectangles do not overlap.

        Returns:
            Draw calls made.
        """
        if scene.by_stencil:
            self._volumes.gl.attach_stencil(target, samples)
        target.use()
        background = flat_sky(scene.lighting, scene.settings)
        if background is None:
            self.sky.prepare(scene.world)
        target.clear(*(background or (0.0, 0.0, 0.0)), 1.0, depth=1.0)
        draws = 0
        for numbers in group_views([each.view for each in views]):
            eyes = [views[number] for number in numbers]
            if eyes[0].stereo == "two_pass":
                draws += sum(self._draw_view(target, scene, each, sky=background is None) for each in eyes)
            else:
                draws += self._draw_eyes(target, scene, eyes, sky=background is None)
        return draws

    def _draw_view(self, target: moderngl.Framebuffer, scene: FrameScene, drawn: ViewDraws, *, sky: bool) -> int:
        target.viewport = drawn.rectangle
        for mirror, number, reflection in drawn.mirrors:
            mirror.show(number, reflection, drawn.rectangle[:2])
        additive = scene.by_stencil and scene.settings.shadows == "stencil_additive"
        self.enter(scene, drawn.view, sun=not additive)
        draws = self._find_ambient(target, scene, drawn)
        draws += self._draw_opaque(target, scene, drawn)
        if sky:
            draws += self.sky.draw()
        if scene.by_stencil:
            draws += self._draw_stencil_shadows(target, scene, drawn, additive=additive)
        return draws + self._draw_transparent(target, scene, drawn)

    def _draw_eyes(
        self, target: moderngl.Framebuffer, scene: FrameScene, eyes: Sequence[ViewDraws], *, sky: bool
    ) -> int:
        """Draw two views over one queue: bodies in one pass, what each eye has of its own after it."""
        left, right = eyes
        defines = eye_define(left.stereo)
        blocks = (self._block, self._other_block)
        self._fill(blocks[0], scene, left.view, other=right.view)
        self._fill(blocks[1], scene, right.view)
        blocks[0].bind()
        with self._both_viewports(target, left, right):
            draws = self._draw_bodies(target, scene, left, defines)
        for each, block in zip(eyes, blocks, strict=True):
            target.viewport = each.rectangle
            block.bind()
            draws += self._throw(target, scene, each)
            draws += self.sky.draw() if sky else 0
            draws += self._draw_transparent(target, scene, each) if scene.effects is not None else 0
        if scene.effects is None and left.blended:
            blocks[0].bind()
            with self._both_viewports(target, left, right):
                variant = partial(self._shaders.also_with, defines=defines)
                draws += draw_runs(target, self._arena, self._frame, left.blended, variant)
        return draws

    @contextmanager
    def _both_viewports(self, target: moderngl.Framebuffer, left: ViewDraws, right: ViewDraws) -> Iterator[None]:
        """What is drawn meanwhile finds its eye's rectangle by itself."""
        if left.stereo == "viewports":
            self._volumes.gl.use_viewports([left.rectangle, right.rectangle])
            yield
            return
        x, y, width, height = left.rectangle
        target.viewport = (x, y, 2 * width, height)
        self._ctx.enable_direct(CLIP_DISTANCE_0)
        yield
        self._ctx.disable_direct(CLIP_DISTANCE_0)

    def _draw_opaque(self, target: moderngl.Framebuffer, scene: FrameScene, drawn: ViewDraws) -> int:
        return self._draw_bodies(target, scene, drawn) + self._throw(target, scene, drawn)

    def _draw_bodies(
        self, target: moderngl.Framebuffer, scene: FrameScene, drawn: ViewDraws, eyes: tuple[str, ...] = ()
    ) -> int:
        """Meshes and cords, with what their shaders get besides."""
        variant = partial(self._shaders.also_with, defines=eyes)
        draws = draw_runs(target, self._arena, self._frame, drawn.opaque, variant)
        if scene.world.cords:
            time_s = scene.world.effects.time
            draws += self._cords.draw(scene.world.cords, drawn.view, scene.lighting, scene.lights, time_s, eyes)
        return draws

    def _throw(self, target: moderngl.Framebuffer, scene: FrameScene, drawn: ViewDraws) -> int:
        if scene.effects is None:
            return 0
        return scene.effects.throw(target, self._arena, self._frame, drawn.view, drawn.thrown)

    def _draw_transparent(self, target: moderngl.Framebuffer, scene: FrameScene, drawn: ViewDraws) -> int:
        if scene.effects is not None:
            return scene.effects.draw_mixed(target, self._arena, self._frame, drawn.transparent)
        return draw_runs(target, self._arena, self._frame, drawn.blended)

    def _find_ambient(self, target: moderngl.Framebuffer, scene: FrameScene, drawn: ViewDraws) -> int:
        """Where lit shaders ask how open the surroundings are, have an answer ready."""
        if not scene.ambient:
            return 0
        if scene.settings.ambient_occlusion == 0.0:
            self._ambient.skip()
            return 0
        draws = self._ambient.draw(drawn.view, drawn.rectangle, drawn.opaque, scene.settings)
        target.use()
        return draws

    def enter(self, scene: FrameScene, view: View, *, sun: bool = True) -> None:
        """Pass where the view is from and what shines to the shaders."""
        self._fill(self._block, scene, view, sun=sun)
        self._block.bind()

    def _fill(
        self, block: ViewBlock, scene: FrameScene, view: View, *, sun: bool = True, other: View | None = None
    ) -> None:
        block.settings = scene.settings
        block.fill(view, scene.lighting, scene.plan, sun=sun, other=other)

    def _draw_stencil_shadows(
        self, target: moderngl.Framebuffer, scene: FrameScene, drawn: ViewDraws, *, additive: bool
    ) -> int:
        """Count the volumes; then add the sun where none covers what is seen, or darken where one does."""
        volumes = self._volumes
        draws = volumes.count(target, scene.world, scene.items, drawn.view, scene.lighting)
        if not additive:
            return draws + volumes.darken(scene.settings.shadow_tone)
        self.enter(scene, drawn.view, sun=True)
        volumes.gl.draw_where(EQUAL)
        self._ctx.depth_func = "=="
        draws += self._draw_opaque(target, scene, drawn)
        self._ctx.depth_func = "<"
        volumes.gl.draw_everywhere()
        return draws

    def release(self) -> None:
        """Free what belongs to the passes."""
        for part in (self.sky, self._cords, self._block, self._other_block, self._volumes, self._ambient):
            part.release()
