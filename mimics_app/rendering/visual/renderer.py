"""The visual renderer: one entry, `draw(views)`."""

from __future__ import annotations

import math
from collections.abc import Hashable, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Unpack

from mimics_app.contracts.clock import Clock, MonotonicClock
from mimics_app.contracts.errors import Issue, UsageError
from mimics_app.rendering.visual.changed_part import ChangedPart
from mimics_app.rendering.visual.drawing.draw_list import DrawList
from mimics_app.rendering.visual.drawing.frame_buffers import FrameBuffers
from mimics_app.rendering.visual.drawing.levels import fewer_pixels
from mimics_app.rendering.visual.drawing.mesh_arena import MeshArena
from mimics_app.rendering.visual.figures.hud import Hud, LayOut
from mimics_app.rendering.visual.frame_stats import FrameStats
from mimics_app.rendering.visual.lighting import KeptLighting
from mimics_app.rendering.visual.materials.materials import MaterialStore
from mimics_app.rendering.visual.materials.shader_library import FEW_PIXELS, ShaderLibrary
from mimics_app.rendering.visual.passes.eye_passes import AT_ONCE, EyePasses
from mimics_app.rendering.visual.passes.hud import HudPass
from mimics_app.rendering.visual.settings import QualityChanges, RenderSettings, SkinBy
from mimics_app.rendering.visual.stages.board_copy import BoardCopy
from mimics_app.rendering.visual.stages.eye_pairs import eye_passes, group_views, see_from_between
from mimics_app.rendering.visual.stages.picture_stage import PictureStage
from mimics_app.rendering.visual.stages.redraw import Redraw
from mimics_app.rendering.visual.stages.shadow_stage import ShadowStage, light_features
from mimics_app.rendering.visual.stages.world_stage import FrameScene, ViewDraws, WorldStage
from mimics_app.rendering.visual.surfaces.capabilities import read_capabilities
from mimics_app.rendering.visual.surfaces.driver_threads import DriverThreads
from mimics_app.rendering.visual.surfaces.rasteriser import rasteriser_of
from mimics_app.rendering.visual.surfaces.surface import Surface
from mimics_app.rendering.visual.targets import PictureTarget
from mimics_app.rendering.visual.view import Latch, Rect, View
from mimics_app.world.content.world import World

if TYPE_CHECKING:
    import moderngl

    from mimics_app.rendering.visual.drawing.draw_list import DrawList
    from mimics_app.rendering.visual.drawing.feedback import FeedbackSkinning
    from mimics_app.rendering.visual.drawing.skinning import ProcessorSkinning
    from mimics_app.rendering.visual.overlay.layers import Layer
    from mimics_app.rendering.visual.overlay.overlay import Overlay
    from mimics_app.rendering.visual.overlay.stage_times import StageTimes
    from mimics_app.rendering.visual.stages.effect_stage import EffectStage

__all__ = ["Renderer"]


class MeshSkinning:
    """Skins meshes by the requested method, which is loaded with the first skinned body.

    Attributes:
        skinning: The method in use; None before the first skinned body.
    """

    def __init__(self, ctx: moderngl.Context, shaders: ShaderLibrary, arena: MeshArena, by: SkinBy) -> None:
        self._ctx, self._shaders, self._arena, self._by = ctx, shaders, arena, by
        self.skinning: ProcessorSkinning | FeedbackSkinning | None = None

    def skin(self, world: World, listed: DrawList) -> None:
        """Skin those of a world's meshes that are queued in this frame and not skinned yet; the tally counts them."""
        if not world.motion.bodies:
            return
        if self.skinning is None and self._by == "feedback":
            from mimics_app.rendering.visual.drawing.feedback import FeedbackSkinning

            self.skinning = FeedbackSkinning(self._ctx, self._shaders, self._arena)
        elif self.skinning is None:
            from mimics_app.rendering.visual.drawing.skinning import ProcessorSkinning

            self.skinning = ProcessorSkinning(self._arena, listed.bent)
        listed.tally.bent += self.skinning.skin(world, listed.drawn_meshes())

    def release(self) -> None:
        """Free the GPU objects."""
        if self.skinning is not None:
            self.skinning.release()


class Renderer:
    """Draws a world on a surface.

    Stages of a frame: shadow maps, the world in every view, the heads-up display. Light is computed linearly and
    encoded for the display by the shaders, so that all backends agree; blending and multisampling mix display values.

    Attributes:
        world: The world to draw; may be exchanged between frames.
        hud: The heads-up display; its content stays until `hud.clear()`.
        settings: The present quality: as given, until `set_quality` changes it.
        timing: True times the stages of every frame even while the frame graph is hidden.

    Args:
        surface: Surface to draw on; owned by the caller.
        world: The world to draw.
        settings: Quality.
        clock: Clock for `FrameStats`.
        shader_folder: Folder of the shaders; None: the installation's.
        sparse: True for single pictures of a session: parts of the last one are reused from the second on.
    """

    def __init__(
        self,
        surface: Surface,
        world: World,
        settings: RenderSettings | None = None,
        *,
        clock: Clock | None = None,
        shader_folder: Path | None = None,
        sparse: bool = False,
    ) -> None:
        self.world, self.settings = world, settings or RenderSettings()
        self._surface, self._clock = surface, clock or MonotonicClock()
        self._shader_folder, self._sparse = shader_folder, sparse
        self.hud, self.timing = Hud(), False
        self._overlay: Overlay | None = None
        self._make_stages()

    def _make_stages(self) -> None:
        """Create all objects of the surface's context."""
        surface, ctx = self._surface, self._surface.ctx
        self._shaders = ShaderLibrary(ctx, self._shader_folder)
        self._arena = MeshArena(ctx)
        self._has, member = read_capabilities(ctx), rasteriser_of(ctx).member
        self._materials = MaterialStore(ctx, self._shaders, self._has)
        self._list = DrawList(self._arena, self._materials, rasteriser_of(ctx))
        self._frame = FrameBuffers(ctx, self._arena)
        self._skinning = MeshSkinning(ctx, self._shaders, self._arena, self.settings.skinning)
        self._picture = PictureTarget(surface, self._shaders, self.settings, board_within=self._sparse)
        self._shadows = ShadowStage(ctx, self.settings.shadow_size)
        self._world = WorldStage(ctx, self._shaders, self._frame, self.settings, self._has.texture_size)
        self._effects: EffectStage | None = None
        self._hud_pass = HudPass(ctx, self._shaders)
        self._board = member(BoardCopy)(surface, self._hud_pass)
        self._pictures, self._threads = PictureStage(ctx, self._shaders), member(DriverThreads)()
        self._redraw = member(Redraw)(self._list, self._frame, self._pictures, sparse=self._sparse)
        self._lighting = KeptLighting()
        self._materials.live = self._pictures.pictures
        # Once requested, the shaders keep reading it: a governor's step compiles nothing.
        self._ambient = False
        self._timer = ctx.query(time=True) if self.settings.timer else None

    @property
    def overlay(self) -> Overlay:
        """The developer's overlay; created on first use."""
        if self._overlay is None:
            from mimics_app.rendering.visual.overlay.overlay import Overlay

            self._overlay = Overlay(self._surface.ctx, self._shaders, self._frame, self._clock)
        return self._overlay

    def shows(self, layer: Layer) -> bool:
        """Whether a layer of the overlay is on."""
        return self._overlay is not None and layer in self._overlay.layers

    def renew(self) -> None:
        """Create all GPU objects again on the surface's present context, after the last one was lost.

        World, settings, heads-up display and the state of the overlay stay as they are.
        """
        before, self._overlay = self._overlay, None
        self._make_stages()
        if before is not None:
            self.overlay.take_over(before)

    def draw(self, views: Sequence[View], latch: Latch | None = None, lay_out: LayOut | None = None) -> FrameStats:
        """Draw one frame into the surface's framebuffer; `surface.swap()` shows it.

        Args:
            views: One view per eye; at least one.
            latch: Called just before the world is drawn, for views of the newest head pose; None without tracking.
            lay_out: Called when the world is submitted, while the driver draws it; None: `hud` is filled.

        Raises:
            UsageError: `views` is empty.
            SceneError: a shader does not compile.
        """
        return self._measure(views, latch, lay_out, finish=False)

    def draw_finished(
        self, views: Sequence[View], latch: Latch | None = None, lay_out: LayOut | None = None
    ) -> FrameStats:
        """Draw one frame and wait until the driver has finished: `cpu_ms` is the frame's whole cost; see `draw`."""
        return self._measure(views, latch, lay_out, finish=True)

    def set_quality(self, **changes: Unpack[QualityChanges]) -> None:
        """Change some settings from the next frame on; the others stay as they are.

        Args:
            changes: Fields of `RenderSettings`.

        Raises:
            UsageError: a value is out of range.
        """
        self.settings = replace(self.settings, **changes)
        self._shadows.resize(self.settings.shadow_size)
        self._picture.settings = self.settings

    @property
    def shaders_replaced(self) -> int:
        """Number of programs that `reload_shaders` has replaced; a picture drawn before the last one is out of date."""
        return self._shaders.replaced

    def forget_picture(self) -> None:
        """Draw the next frame as a whole, without reusing parts of the last one."""
        self._redraw.forget()

    def reload_shaders(self) -> list[Issue]:
        """Recompile changed shaders; return their errors. A program that fails to compile stays in use as it was."""
        return self._shaders.reload()

    def take_issues(self) -> list[Issue]:
        """Return what could not be drawn as the world requires since the last call; each fault is reported once."""
        taken = [*self._materials.issues, *self._world.sky.issues, *self._pictures.issues]
        self._materials.issues, self._world.sky.issues, self._pictures.issues = [], [], []
        return taken if self._effects is None else [*taken, *self._effects.take_issues()]

    def release(self) -> None:
        """Free everything but the surface."""
        if self._overlay is not None:
            self._overlay.release()
            self._overlay = None
        parts = (self._pictures, self._hud_pass, self._world, self._shadows, self._picture, self._frame)
        effects = () if self._effects is None else (self._effects,)
        for part in (*parts, *effects, self._materials, self._arena, self._skinning):
            part.release()

    def _measure(
        self, views: Sequence[View], latch: Latch | None, lay_out: LayOut | None, *, finish: bool
    ) -> FrameStats:
        if not views:
            raise UsageError("a frame without a view cannot be drawn", "give at least one View")
        started = self._clock.now_ns()
        timer = None if self.times is not None else self._timer  # timer queries cannot be nested
        with timer or nullcontext():
            triangles, draws = self._draw(views, latch, lay_out)
        if finish:
            self._surface.ctx.finish()
        cpu_ms, tally = (self._clock.now_ns() - started) * 1e-6, self._list.tally.figures
        if self.times is not None:
            self.times.count(*tally[:3])
        return FrameStats(cpu_ms, timer.elapsed * 1e-6 if timer else None, triangles, draws, *tally)

    @property
    def times(self) -> StageTimes | None:
        """Recorder of the stage times; None while they are neither shown nor requested.

        A caller with stages of its own before those of the renderer begins the frame; otherwise `draw` does.
        """
        return self.overlay.times if self.timing or self.shows("graph") else None

    def _timed(self, stage: str) -> AbstractContextManager[None]:
        return nullcontext() if self.times is None else self.times.stage(stage)

    def _draw(self, views: Sequence[View], latch: Latch | None, lay_out: LayOut | None) -> tuple[int, int]:
        """Run the stages of a frame in order; return triangles and draw calls."""
        times = self.times
        if times is not None and not times.begun:
            times.begin()
        if lay_out is not None and self._sparse:  # it is drawn into the kept picture and compared with the last one
            lay_out()
        with self._timed("prepare"):
            scene = self._prepare(views)
        draws = self._draw_shadows()  # the driver does so while the views are culled
        with self._timed("cull"):
            parts = self._changed_parts(scene, views if latch is None else ())
            target = self._picture.begin()
            parts = parts if self._picture.holds else None
            split = (
                self._world.backdrop.begin(same=self._redraw.only_sprites and not scene.by_stencil) and parts is None
            )
            drawn = self._batch_all(scene, views, split) if parts is None else self._batch_parts(scene, views[0], parts)
            self._upload()
            if scene.effects is not None:
                scene.effects.upload()
        with self._timed("mirrors"):
            draws += self._pictures.draw(self._world, scene, self._picture.samples)
        with self._timed("submit"):
            if latch is not None:
                drawn = [each.latched(newer) for each, newer in zip(drawn, latch(), strict=True)]
            draw = self._world.draw if parts is None else self._world.draw_parts
            with self._threads.submitting(placed=self.settings.place_threads and not self._frame.few_pixels):
                draws += draw(target, self._picture.samples, scene, drawn)
            self._picture.holds = self._picture.keep
        if self._overlay is not None and self._overlay.shows:
            with self._timed("overlay"):
                draws += self._overlay.draw_in_world(target, scene, self._list, drawn, self._world)
        if lay_out is not None and not self._sparse:
            self._frame.flush()
            lay_out()
        with self._timed("post"):
            draws += self._draw_over(views, parts)
        self._threads.free()
        if times is not None:
            times.begun = False
        return self._shadows.triangles + self._pictures.triangles + sum(each.triangles for each in drawn), draws

    def _upload(self) -> None:
        """Skin and upload what was queued since the last call."""
        self._skinning.skin(self.world, self._list)
        self._frame.upload()

    def _draw_shadows(self) -> int:
        with self._timed("shadows"):
            self._upload()
            return self._shadows.draw(self._frame)

    def _batch_all(self, scene: FrameScene, views: Sequence[View], split: bool) -> list[ViewDraws]:
        """Queue what is visible in the views and in the mirrors, screens and insets within them."""
        places = [self._picture.rectangle(view.rectangle) for view in views]
        self._list.drawn[:] = False
        queued: dict[int, ViewDraws] = {}
        for numbers in group_views(views):
            eyes, within = zip(*((views[number], places[number]) for number in numbers), strict=True)
            queued |= zip(numbers, self._batch(scene, eyes, numbers[0], within, split=split), strict=True)
        drawn = [queued[number] for number in range(len(views))]
        return self._pictures.queue(self.world, drawn, partial(self._batch_inside, scene), self.settings.mirror_scale)

    def _changed_parts(self, scene: FrameScene, views: Sequence[View]) -> list[ChangedPart] | None:
        """Return the parts in which the picture changed; None: draw all of it."""
        place = self._picture.rectangle(views[0].rectangle if views else (0, 0, 0, 0))
        compared = () if self._overlay is not None and self._overlay.shows else views
        parts = self._redraw.find(scene, compared, place, self._shaders.replaced, self.hud)
        self._picture.keep = self._redraw.keeps
        return parts

    def _batch_parts(self, scene: FrameScene, view: View, parts: Sequence[ChangedPart]) -> list[ViewDraws]:
        """Queue what is visible in parts of a view, and in what changed of the pictures within it."""
        place = self._picture.rectangle(view.rectangle)
        return self._redraw.queue(scene, view, place, parts, self._picture.samples, self._batch_inside)

    def _prepare(self, views: Sequence[View]) -> FrameScene:
        """Update lighting and draw list from the world, and queue the shadow casters."""
        lighting, settings = self._lighting.of(self.world), self.settings
        self._pictures.update(self.world)
        self._ambient = self._ambient or settings.ambient_occlusion > 0.0
        lights = light_features(lighting, settings)
        features = lights | self._picture.features | ({"AMBIENT_OCCLUSION"} if self._ambient else frozenset())
        fates = self._overlay is not None and self._overlay.needs_fates
        self._list.update(self.world, settings, light_features=features, fates=fates, sparse=self._sparse)
        self._frame.begin(few_pixels=FEW_PIXELS in features)
        sizes = [self._picture.rectangle(view.rectangle)[2:] for view in views]
        coarser = math.sqrt(min(map(fewer_pixels, views, sizes)))
        self._shadows.prepare(lighting, views, self._list, self._frame, settings, coarser)
        effects, plan = self._prepare_effects(features), self._shadows.plan
        return FrameScene(self.world, self._list.items, lighting, plan, settings, self._ambient, lights, effects)

    def _prepare_effects(self, lights: frozenset[str]) -> EffectStage | None:
        """Return the stage of sprites and projectors, updated for this frame; None in a world without any."""
        if self.world.effects.empty:
            return None
        if self._effects is None:
            from mimics_app.rendering.visual.stages.effect_stage import EffectStage

            self._effects = EffectStage(self._surface.ctx, self._shaders, self._has.texture_size)
        self._effects.prepare(self.world, lights, self.settings)
        return self._effects

    def _batch(
        self, scene: FrameScene, views: Sequence[View], key: Hashable, places: Sequence[Rect], *, split: bool = False
    ) -> list[ViewDraws]:
        """Queue what is visible in a view, or in both views of a stereo pair; `split`: for and over a backdrop."""
        eyes = list(views) if len(views) == 1 else see_from_between(*views)
        sizes, samples = [place[2:] for place in places], self._picture.samples
        opaque, blended, away = self._list.batch_views(self._frame, views, eyes[0].eye_world, sizes, samples, key)
        alone = len(places) != 2 or (self._overlay is not None and self._overlay.shows)
        passes: EyePasses = "alone" if alone else eye_passes(self.settings, self._has, [*opaque, *blended], places)
        at_once = passes in AT_ONCE
        if at_once:
            self._frame.double(opaque)
            if scene.effects is None:
                self._frame.double(blended)
        drawn = [ViewDraws(eye, place, opaque, blended, passes=passes) for eye, place in zip(eyes, places, strict=True)]
        if scene.effects is None:
            return drawn
        projected = scene.effects.meet(eyes, self._list, self._frame)
        if at_once:
            for beam in projected:
                self._frame.double(beam.runs)
        mixed = [scene.effects.mix(each.view, each.rectangle[3], blended, away, split=split) for each in drawn]
        opaque = [] if split and self._world.backdrop.use(scene.effects.behind) else opaque
        return [
            replace(each, opaque=opaque, transparent=own, projected=projected, behind=behind)
            for each, (own, behind) in zip(drawn, mixed, strict=True)
        ]

    def _batch_inside(self, scene: FrameScene, view: View, key: Hashable) -> ViewDraws:
        """Queue what is visible in a mirror, screen or inset, in the view's own rectangle."""
        return self._batch(scene, [view], key, [view.rectangle])[0]

    def _draw_over(self, views: Sequence[View], parts: list[ChangedPart] | None) -> int:
        """Filter and show the world's picture; draw insets and heads-up display over it at full resolution."""
        picture, within = self._picture, self._picture.takes_board
        draws = self._draw_hud(views) if within else 0
        filtered, written = picture.finish([view.rectangle for view in views], parts)
        alone = not (within or self.world.insets or (self._overlay is not None and self._overlay.layers))
        over = (self.hud, views[0], self.settings.hud_depth, self.settings.hud_enlarged)
        if (drawn := self._board.draw(picture.finished, written if alone else None, *over)) is None:
            picture.show(picture.finished)
            self._surface.note_changed(None)
            drawn = 0 if within else self._draw_hud(views)
        return draws + filtered + drawn

    def _draw_hud(self, views: Sequence[View]) -> int:
        draws, huds = self._pictures.draw_insets(self.world, views, self.settings.hud_depth), [self.hud]
        if self._overlay is not None and self._overlay.layers:
            draws += self._overlay.draw_atlas(self._surface.framebuffer, self._shadows)
            self._overlay.lay_out(self.hud.width, self.hud.height)
            huds.append(self._overlay.hud)
        return draws + self._hud_pass.draw_over(huds, views, self.settings.hud_depth, self.settings.hud_enlarged)
