"""Stage of the world: draws it into a target, view by view."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING

from mimics_app.rendering.visual.backdrop import Backdrop
from mimics_app.rendering.visual.changed_part import ChangedPart
from mimics_app.rendering.visual.drawing.draw_items import DrawItems
from mimics_app.rendering.visual.drawing.frame_buffers import DrawRun, FrameBuffers
from mimics_app.rendering.visual.lighting import Lighting
from mimics_app.rendering.visual.materials.shader_library import ShaderLibrary
from mimics_app.rendering.visual.passes.ambient import AmbientPass
from mimics_app.rendering.visual.passes.cord import CordPass
from mimics_app.rendering.visual.passes.eye_passes import EyePass, EyePasses, passes_of
from mimics_app.rendering.visual.passes.sky import SkyPass, flat_sky
from mimics_app.rendering.visual.passes.states import draw_runs
from mimics_app.rendering.visual.passes.volumes import VolumePass
from mimics_app.rendering.visual.pictures.live_picture import MirrorPicture
from mimics_app.rendering.visual.pictures.mirror_views import Reflection
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.shadows.shadow_maps import ShadowPlan
from mimics_app.rendering.visual.stages.eye_pairs import group_views
from mimics_app.rendering.visual.surfaces.rasteriser import rasteriser_of
from mimics_app.rendering.visual.surfaces.raw_gl import CLIP_DISTANCE_0, EQUAL
from mimics_app.rendering.visual.view import Rect, View
from mimics_app.rendering.visual.view_block import ViewBlock
from mimics_app.world.content.world import World

if TYPE_CHECKING:
    import moderngl

    from mimics_app.rendering.visual.effects.projectors import BeamRuns
    from mimics_app.rendering.visual.effects.sprites import SpriteRun
    from mimics_app.rendering.visual.stages.effect_stage import EffectStage

__all__ = ["FrameScene", "ViewDraws", "WorldStage"]


@dataclass(frozen=True, eq=False)
class FrameScene:
    """Input shared by all pictures of a frame.

    Attributes:
        world: The world, updated.
        items: Its sub-entities.
        lighting: Light of the frame.
        plan: The shadow maps, drawn already.
        settings: Quality.
        ambient: True where the shaders read ambient occlusion, which may be full visibility.
        lights: Shader features that the frame's light needs, without ambient occlusion.
        effects: Sprites and projectors; None in a world without any.
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
        """Whether the sun's shadows are stencil volumes."""
        settings = self.settings
        return settings.shadows.startswith("stencil") and self.lighting.sun_casts_shadow and settings.shadow_size > 0


@dataclass(frozen=True, eq=False)
class ViewDraws:
    """A view with its queued draws.

    Attributes:
        view: The view.
        rectangle: Rectangle in the target [px].
        opaque: Opaque runs, near to far.
        mirrors: Visible mirrors, with the number of the view and the reflection shown there.
        transparent: Masked sprites, then blended sprites and surfaces, far to near.
        projected: Projectors with the opaque surfaces they hit.
        passes: Passes of this eye and the other one of its pair.
        part: Part of the target that is drawn; None: all of it.
        behind: Sprites that belong to the backdrop, not to the transparent ones; None: there is no backdrop.
    """

    view: View
    rectangle: Rect
    opaque: list[DrawRun]
    transparent: Sequence[DrawRun | SpriteRun]
    mirrors: Sequence[tuple[MirrorPicture, int, Reflection | None]] = ()
    projected: Sequence[BeamRuns] = ()
    passes: EyePasses = "alone"
    part: ChangedPart | None = None
    behind: Sequence[SpriteRun] | None = None

    def latched(self, newer: View) -> ViewDraws:
        """Return these draws with a newer view; with mirrors they keep the pose they were queued with."""
        return self if self.mirrors else replace(self, view=self.view.latched(newer))

    @property
    def blended(self) -> list[DrawRun]:
        """The transparent runs without the sprites."""
        return [run for run in self.transparent if isinstance(run, DrawRun)]

    @property
    def tests_depth(self) -> bool:
        """Whether all meshes are drawn with a depth test."""
        return all(
            each.depth != "off" for run in (*self.opaque, *self.blended) for each in run.material_instance.passes
        )

    @property
    def materials(self) -> set[str]:
        """Names of all drawn materials."""
        return {run.material_instance.material.name for run in (*self.opaque, *self.blended)}

    @property
    def triangles(self) -> int:
        """Triangles of all runs."""
        return sum(run.triangles for run in (*self.opaque, *self.transparent))


class WorldStage:
    """Draws each view: opaque surfaces with projected textures, sky, stencil shadows, transparent surfaces."""

    def __init__(
        self,
        ctx: moderngl.Context,
        shaders: ShaderLibrary,
        frame: FrameBuffers,
        settings: RenderSettings,
        max_size: int,
    ) -> None:
        self._ctx = ctx
        self._frame = frame
        self._shaders = shaders
        self._blocks = (ViewBlock(ctx, settings), ViewBlock(ctx, settings))
        self._second = ViewBlock(ctx, settings)
        self._filled: tuple[FrameScene, list[View], bool] | None = None
        self._volumes = VolumePass(ctx, shaders)
        self._ambient = AmbientPass(ctx, shaders, frame)
        self._cords = CordPass(ctx, shaders)
        self.sky = SkyPass(ctx, shaders, max_size)
        self.backdrop = rasteriser_of(ctx).member(Backdrop)(ctx)

    def draw_parts(
        self, target: moderngl.Framebuffer, samples: int, scene: FrameScene, parts: Sequence[ViewDraws]
    ) -> int:
        """Redraw parts of a view; the target stays in use, and unchanged elsewhere.

        With several samples per pixel llvmpipe also draws into the pixels just left of and below a scissor rectangle:
        a part that these belong to has to come later, so that it is cleared.

        Returns:
            Draw calls made.
        """
        draws = 0
        for each in parts:
            draws += self.draw(target, samples, scene, [each])
        target.scissor = None  # type: ignore[assignment]  # disables it
        target.use()
        return draws

    def draw(self, target: moderngl.Framebuffer, samples: int, scene: FrameScene, views: Sequence[ViewDraws]) -> int:
        """Clear a target and draw the world in each view; the target stays in use.

        Args:
            target: Framebuffer to draw into.
            samples: Samples per pixel of the target.
            scene: Input of the frame.
            views: The views; their rectangles do not overlap.

        Returns:
            Draw calls made.
        """
        if views[0].behind is not None:
            return self._draw_over_backdrop(target, samples, scene, views[0])
        if scene.by_stencil:
            self._volumes.gl.attach_stencil(target, samples)
        target.use()
        background = flat_sky(scene.lighting, scene.settings)
        if background is None:
            self.sky.prepare(scene.world)
        _clear(target, background or (0.0, 0.0, 0.0), views[0])
        draws = 0
        for numbers in group_views([each.view for each in views]):
            eyes = [views[number] for number in numbers]
            together = [[each] for each in eyes] if eyes[0].passes == "alone" else [eyes]
            draws += sum(self._draw_eyes(target, scene, each, sky=background is None) for each in together)
        return draws

    def _draw_over_backdrop(
        self, target: moderngl.Framebuffer, samples: int, scene: FrameScene, drawn: ViewDraws
    ) -> int:
        behind = replace(drawn, transparent=drawn.behind or (), behind=None)
        draws = self.backdrop.draw(target, lambda: self.draw(target, samples, scene, [behind]))
        target.use()
        self._fill(scene, [drawn], sun=True)
        for _ in self._together(target, scene, [drawn]):
            draws += self._draw_transparent(target, scene, [drawn])
        return draws

    def _draw_eyes(
        self, target: moderngl.Framebuffer, scene: FrameScene, eyes: Sequence[ViewDraws], *, sky: bool
    ) -> int:
        """Draw a view, or two with a shared queue: meshes in common passes, sky and sprites per eye."""
        for seen in zip(*(each.mirrors for each in eyes), strict=True):
            corners = [each.rectangle[:2] for each in eyes]
            seen[0][0].show([(number, shown, at) for (_, number, shown), at in zip(seen, corners, strict=True)])
        additive = scene.by_stencil and scene.settings.shadows == "stencil_additive"
        self._fill(scene, eyes, sun=not additive)
        draws = self._find_ambient(target, scene, eyes)
        draws += sum(self._draw_opaque(target, scene, eyes[0], each) for each in self._together(target, scene, eyes))
        if sky:
            draws += sum(self.sky.draw() for _ in self._each_eye(target, scene, eyes))
        if scene.by_stencil:
            draws += self._draw_stencil_shadows(target, scene, eyes, additive=additive)
        return draws + self._draw_transparent(target, scene, eyes)

    def _together(
        self, target: moderngl.Framebuffer, scene: FrameScene, eyes: Sequence[ViewDraws]
    ) -> Iterator[EyePass]:
        """Yield the passes over a shared queue, with viewports, clipping and view block set for stereo shaders."""
        self._use_ambient(scene, range(len(eyes)))
        first = eyes[0]
        target.viewport = first.rectangle
        if first.passes.startswith("viewports"):
            self._volumes.gl.use_viewports([each.rectangle for each in eyes])
        halves = first.passes.startswith("halves")
        if halves:
            x, y, width, height = first.rectangle
            target.viewport = (x, y, 2 * width, height)
            self._ctx.enable_direct(CLIP_DISTANCE_0)
        for each in passes_of(first.passes):
            self._block_of(each).bind()
            yield each
        if halves:
            self._ctx.disable_direct(CLIP_DISTANCE_0)

    def _block_of(self, eye_pass: EyePass) -> ViewBlock:
        return self._second if eye_pass.eye == 1 else self._blocks[0]

    def _each_eye(
        self, target: moderngl.Framebuffer, scene: FrameScene, eyes: Sequence[ViewDraws]
    ) -> Iterator[ViewDraws]:
        """Yield each eye in turn, with its viewport and view block bound."""
        for number, (each, block) in enumerate(zip(eyes, self._blocks, strict=False)):
            if len(eyes) > 1:
                target.viewport = each.rectangle
                block.bind()
                self._use_ambient(scene, [number])
            yield each

    def _draw_opaque(self, target: moderngl.Framebuffer, scene: FrameScene, drawn: ViewDraws, eyes: EyePass) -> int:
        """Draw meshes and cords, and the textures projected onto them, for one eye or both."""
        variant = partial(self._shaders.also_with, defines=eyes.defines)
        draws = draw_runs(target, self._frame, drawn.opaque, variant)
        if scene.world.cords:
            time_s = scene.world.effects.time
            draws += self._cords.draw(scene.world.cords, drawn.view, scene.lighting, scene.lights, time_s, eyes)
        if scene.effects is None:
            return draws
        beams, whole = drawn.projected, drawn.part is None and not eyes.defines
        return draws + scene.effects.project(target, self._frame, drawn.view, beams, eyes.defines, whole=whole)

    def _draw_transparent(self, target: moderngl.Framebuffer, scene: FrameScene, eyes: Sequence[ViewDraws]) -> int:
        """Draw blended surfaces of both eyes in common passes; with sprites, each eye has its own order."""
        effects = scene.effects
        if effects is not None:
            turns = self._each_eye(target, scene, eyes)
            return sum(effects.draw_mixed(target, self._frame, each.transparent) for each in turns)
        if not eyes[0].blended:
            return 0
        draws = 0
        for each in self._together(target, scene, eyes):
            variant = partial(self._shaders.also_with, defines=each.defines)
            draws += draw_runs(target, self._frame, eyes[0].blended, variant)
        return draws

    def _find_ambient(self, target: moderngl.Framebuffer, scene: FrameScene, eyes: Sequence[ViewDraws]) -> int:
        """Compute ambient occlusion where it is enabled; return the draw calls."""
        if not scene.ambient or scene.settings.ambient_occlusion == 0.0:
            return 0
        views = [each.view for each in eyes]
        self._ambient.begin_depth([each.rectangle for each in eyes])
        draws = 0
        for each in passes_of(eyes[0].passes):
            self._block_of(each).bind()
            draws += self._ambient.draw_depth(views, eyes[0].opaque)
        for number, block in enumerate(self._blocks[: len(eyes)]):
            block.bind()
            draws += self._ambient.find(number, scene.settings)
        target.use()
        return draws

    def _use_ambient(self, scene: FrameScene, eyes: Sequence[int]) -> None:
        if not scene.ambient:
            return
        if scene.settings.ambient_occlusion == 0.0:
            self._ambient.skip()
        else:
            self._ambient.use(eyes)

    def enter(self, scene: FrameScene, drawn: ViewDraws) -> None:
        """Fill and bind the view block of a view."""
        self._fill(scene, [drawn], sun=True)
        self._blocks[0].bind()

    def _fill(self, scene: FrameScene, eyes: Sequence[ViewDraws], *, sun: bool) -> None:
        """Fill the view blocks of the eyes; the first one has both eyes. Parts of a view share the blocks."""
        views = [each.view for each in eyes]
        if self._filled == (scene, views, sun):
            return
        self._filled = scene, views, sun
        turns = passes_of(eyes[0].passes)
        for block, drawn, eye in (
            (self._blocks[0], views, turns[0].eye),
            (self._blocks[1], views[1:], -1),
            (self._second, views if len(turns) > 1 else [], 1),
        ):
            if drawn:
                block.settings = scene.settings
                block.fill(drawn[0], scene.lighting, scene.plan, drawn[-1], sun=sun, eye=eye)

    def _draw_stencil_shadows(
        self, target: moderngl.Framebuffer, scene: FrameScene, eyes: Sequence[ViewDraws], *, additive: bool
    ) -> int:
        """Count the volumes; then add the sun outside of them, or darken the picture inside."""
        volumes, views = self._volumes, [each.view for each in eyes]
        volumes.gl.clear_stencil()
        draws = 0
        for each in self._together(target, scene, eyes):
            draws += volumes.count(target, scene.world, scene.items, views, scene.lighting, each)
        if not additive:
            return draws + sum(volumes.darken(scene.settings.shadow_tone) for _ in self._each_eye(target, scene, eyes))
        self._fill(scene, eyes, sun=True)
        volumes.gl.draw_where(EQUAL)
        for each in self._together(target, scene, eyes):
            self._ctx.depth_func = "=="  # projectors reset it
            draws += self._draw_opaque(target, scene, eyes[0], each)
        self._ctx.depth_func = "<"
        volumes.gl.draw_everywhere()
        return draws

    def release(self) -> None:
        """Free the passes and view blocks."""
        for part in (self.sky, self.backdrop, self._cords, *self._blocks, self._second, self._volumes, self._ambient):
            part.release()


def _clear(target: moderngl.Framebuffer, colour: tuple[float, float, float], drawn: ViewDraws) -> None:
    """Clear a target, or the pieces of the part that is drawn, which becomes the scissor rectangle.

    The rest of the part becomes nearer than everything: a software driver does not shade what fails the depth test.
    """
    part = drawn.part
    if part is None:
        target.clear(*colour, 1.0, depth=1.0)
        return
    pieces = part.pieces if drawn.tests_depth else [part.rectangle]
    target.scissor = part.rectangle
    if pieces != [part.rectangle]:
        target.color_mask = False, False, False, False
        target.clear(depth=0.0)
        target.color_mask = True, True, True, True
    for piece in pieces:
        target.scissor = piece
        target.clear(*colour, 1.0, depth=1.0)
    target.scissor = part.rectangle
    target.use()
