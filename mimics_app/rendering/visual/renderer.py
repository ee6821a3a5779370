"""The visual renderer: one entry, `draw(views)`."""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Unpack

from mimics_app.contracts.clock import Clock, MonotonicClock
from mimics_app.contracts.errors import Issue, UsageError
from mimics_app.rendering.visual.drawing.bending import Bending
from mimics_app.rendering.visual.drawing.draw_list import DrawList
from mimics_app.rendering.visual.drawing.frame_buffers import DrawRun, FrameBuffers
from mimics_app.rendering.visual.drawing.levels import fewer_pixels
from mimics_app.rendering.visual.drawing.mesh_arena import MeshArena
from mimics_app.rendering.visual.figures.hud import Hud
from mimics_app.rendering.visual.frame_stats import FrameStats
from mimics_app.rendering.visual.lighting import gather_lighting
from mimics_app.rendering.visual.materials.materials import MaterialStore
from mimics_app.rendering.visual.materials.shader_library import ShaderLibrary
from mimics_app.rendering.visual.passes.eye_passes import AT_ONCE, EyePasses
from mimics_app.rendering.visual.passes.hud import HudPass, plane_of_views
from mimics_app.rendering.visual.settings import QualityChanges, RenderSettings
from mimics_app.rendering.visual.stages.eye_pairs import eye_passes, group_views, see_from_between
from mimics_app.rendering.visual.stages.picture_stage import PictureStage
from mimics_app.rendering.visual.stages.seen_frame import look_at, may_keep
from mimics_app.rendering.visual.stages.shadow_stage import ShadowStage, light_features
from mimics_app.rendering.visual.stages.still_picture import StillPicture
from mimics_app.rendering.visual.stages.world_stage import FrameScene, ViewDraws, WorldStage
from mimics_app.rendering.visual.surfaces.capabilities import read_capabilities
from mimics_app.rendering.visual.surfaces.surface import Surface
from mimics_app.rendering.visual.targets import PictureTarget
from mimics_app.rendering.visual.view import Rect, View
from mimics_app.world.world import World

if TYPE_CHECKING:
    import moderngl

    from mimics_app.rendering.visual.overlay.layers import Layer
    from mimics_app.rendering.visual.overlay.overlay import Overlay
    from mimics_app.rendering.visual.overlay.stage_times import StageTimes
    from mimics_app.rendering.visual.stages.effect_stage import EffectStage

__all__ = ["Latch", "Renderer"]

Latch = Callable[[], Sequence[View]]
"""Says where the eyes are now: as many views as were queued, in their order."""


class Renderer:
    """Draws a world on a surface.

    Stages of a frame: shadow maps, the world in every view, the heads-up display. Light is computed linearly and
    encoded for the display by the shaders themselves, so that all backends agree; blending and multisampling mix
    display values.

    Attributes:
        world: What is drawn; may be exchanged between frames.
        hud: The heads-up display; what is on it stays until `hud.clear()`.
        settings: The present quality: as given, until `set_quality` changes it.
        timing: Time the stages of every frame, although no graph of them is shown.

    Args:
        surface: Where to draw; owned by the caller.
        world: What to draw.
        settings: Quality.
        clock: For `FrameStats`.
        shader_folder: Other shaders than the installation's.
    """

    def __init__(
        self,
        surface: Surface,
        world: World,
        settings: RenderSettings | None = None,
        *,
        clock: Clock | None = None,
        shader_folder: Path | None = None,
    ) -> None:
        self.world = world
        self.settings = settings or RenderSettings()
        self._surface = surface
        self._clock = clock or MonotonicClock()
        self._shader_folder = shader_folder
        self.hud = Hud()
        self.timing = False
        self._overlay: Overlay | None = None
        self._make_stages()

    def _make_stages(self) -> None:
        """Everything that lives in the surface's context."""
        surface, ctx = self._surface, self._surface.ctx
        self._shaders = ShaderLibrary(ctx, self._shader_folder)
        self._arena = MeshArena(ctx)
        self._has = has = read_capabilities(ctx)
        self._materials = MaterialStore(ctx, self._shaders, has)
        self._list = DrawList(self._arena, self._materials)
        self._frame = FrameBuffers(ctx)
        self._bending = Bending(ctx, self._shaders, self._arena, self.settings.skinning)
        self._picture = PictureTarget(surface, self._shaders, self.settings)
        self._shadows = ShadowStage(ctx, self.settings.shadow_size)
        self._world = WorldStage(ctx, self._shaders, self._arena, self._frame, self.settings, has.texture_size)
        self._effects: EffectStage | None = None
        self._longest_texture = has.texture_size
        self._hud_pass = HudPass(ctx, self._shaders)
        self._pictures = PictureStage(ctx, self._shaders)
        self._still = StillPicture()
        self._materials.live = self._pictures.pictures
        # Once requested, the shaders keep asking: a governor's step compiles nothing.
        self._ambient = False
        self._timer = ctx.query(time=True) if self.settings.timer else None

    @property
    def overlay(self) -> Overlay:
        """The developer's overlay; made when it is first requested."""
        if self._overlay is None:
            from mimics_app.rendering.visual.overlay.overlay import Overlay

            ctx = self._surface.ctx
            self._overlay = Overlay(ctx, self._shaders, self._arena, self._frame, self._clock)
        return self._overlay

    def shows(self, layer: Layer) -> bool:
        """Whether a layer of the overlay is on."""
        return self._overlay is not None and layer in self._overlay.layers

    def renew(self) -> None:
        """Make everything anew on the surface's present context; the one before was lost with all it held.

        World, settings, figures and what the overlay shows stay as they are.
        """
        before, self._overlay = self._overlay, None
        self._make_stages()
        if before is not None:
            self.overlay.take_over(before)

    def draw(self, views: Sequence[View], latch: Latch | None = None) -> FrameStats:
        """Draw one frame into the surface's framebuffer; `surface.swap()` shows it.

        Args:
            views: What each eye sees; at least one.
            latch: Called for the views once more when all is queued, just before the world is drawn: where the eyes
                are by then; None where no head moves.

        Raises:
            UsageError: no view.
            SceneError: a shader does not compile.
        """
        return self._measure(views, latch, finish=False)

    def draw_finished(self, views: Sequence[View], latch: Latch | None = None) -> FrameStats:
        """As `draw`, but return only when the driver has drawn all of it: `cpu_ms` is the frame's whole cost."""
        return self._measure(views, latch, finish=True)

    def set_quality(self, **changes: Unpack[QualityChanges]) -> None:
        """Change what a governor may change, from the next frame on; what is not named stays as it is.

        Args:
            changes: Fields of `RenderSettings`.

        Raises:
            UsageError: a value that cannot be.
        """
        self.settings = replace(self.settings, **changes)
        self._shadows.resize(self.settings.shadow_size)
        self._picture.settings = self.settings

    @property
    def shaders_replaced(self) -> int:
        """How many programs `reload_shaders` has replaced so far: a picture drawn before is out of date."""
        return self._shaders.replaced

    def forget_picture(self) -> None:
        """Have the next frame drawn as a whole, whatever of the last one could be kept."""
        self._still.forget()

    def reload_shaders(self) -> list[Issue]:
        """Compile changed shaders anew; returns what is wrong with them, old programs stay in use."""
        return self._shaders.reload()

    def take_issues(self) -> list[Issue]:
        """What could not be drawn as the world asks since the last call; each fault is reported once."""
        taken = [*self._materials.issues, *self._world.sky.issues, *self._pictures.issues]
        self._materials.issues, self._world.sky.issues, self._pictures.issues = [], [], []
        return taken if self._effects is None else [*taken, *self._effects.take_issues()]

    def release(self) -> None:
        """Free everything but the surface."""
        if self._overlay is not None:
            self._overlay.release()
            self._overlay = None
        parts = (self._pictures, self._hud_pass, self._world, self._shadows, self._picture, self._frame)
        for part in (*parts, self._materials, self._arena):
            part.release()
        if self._effects is not None:
            self._effects.release()
        self._bending.release()

    def _measure(self, views: Sequence[View], latch: Latch | None, *, finish: bool) -> FrameStats:
        if not views:
            raise UsageError("a frame without a view cannot be drawn", "give at least one View")
        started = self._clock.now_ns()
        timer = None if self.times is not None else self._timer  # timers of a driver cannot lie in each other
        with timer or nullcontext():
            triangles, draws = self._draw(views, latch)
        if finish:
            self._surface.ctx.finish()
        cpu_ms = (self._clock.now_ns() - started) * 1e-6
        tally = self._list.tally
        bent = self._bending.skinning.vertices if self._bending.skinning is not None else 0
        counts = (tally.items, tally.culled, tally.hidden, tally.tests, bent)
        if self.times is not None:
            self.times.count(tally.items, tally.culled, tally.hidden)
        return FrameStats(cpu_ms, timer.elapsed * 1e-6 if timer else None, triangles, draws, *counts)

    @property
    def times(self) -> StageTimes | None:
        """Where the times of stages go, None while nobody looks at them.

        Whoever has stages of his own before those of the renderer begins the frame; otherwise `draw` does.
        """
        return self.overlay.times if self.timing or self.shows("graph") else None

    def _timed(self, stage: str) -> AbstractContextManager[None]:
        times = self.times
        return nullcontext() if times is None else times.stage(stage)

    def _draw(self, views: Sequence[View], latch: Latch | None) -> tuple[int, int]:
        """The stages of a frame in their order; returns triangles and draw calls."""
        times = self.times
        if times is not None and not times.begun:
            times.begin()
        with self._timed("cull"):
            scene = self._prepare(views)
            parts = self._changed_parts(scene, views if latch is None else ())
            target = self._picture.begin()
            parts = parts if self._picture.holds else None
            drawn = self._batch_all(scene, views) if parts is None else self._batch_parts(scene, views[0], parts)
            self._bending.bend(self.world, self._list.drawn_meshes())
            self._frame.upload(self._arena)
            if scene.effects is not None:
                scene.effects.upload()
        with self._timed("shadows"):
            draws = self._shadows.draw(self._arena, self._frame)
        with self._timed("mirrors"):
            draws += self._pictures.draw(self._world, scene, self._picture.samples)
        with self._timed("submit"):
            if latch is not None:
                drawn = _latched(drawn, latch())
            paint = self._world.draw if parts is None else self._world.draw_parts
            draws += paint(target, self._picture.samples, scene, drawn)
            self._picture.holds = self._picture.keep
        if self._overlay is not None and self._overlay.shows:
            with self._timed("overlay"):
                draws += self._draw_overlay(self._overlay, target, scene, drawn)
        with self._timed("post"):
            draws += self._draw_over(views, parts)
        if times is not None:
            times.begun = False
        return self._shadows.triangles + self._pictures.triangles + sum(each.triangles for each in drawn), draws

    def _batch_all(self, scene: FrameScene, views: Sequence[View]) -> list[ViewDraws]:
        """Queue what is seen in the views and in the pictures within them."""
        places = [self._picture.rectangle(view.rectangle) for view in views]
        queued: dict[int, ViewDraws] = {}
        for numbers in group_views(views):
            eyes = [views[number] for number in numbers]
            queued |= zip(numbers, self._batch(scene, eyes, numbers[0], [places[k] for k in numbers]), strict=True)
        drawn = [queued[number] for number in range(len(views))]
        return self._pictures.queue(self.world, drawn, partial(self._batch_inside, scene), self.settings.mirror_scale)

    def _changed_parts(self, scene: FrameScene, views: Sequence[View]) -> list[Rect] | None:
        """Rectangles in which the picture is another one than before [px]; None for all of it, or of no views."""
        place = self._picture.rectangle(views[0].rectangle if views else (0, 0, 0, 0))
        if (self._overlay and self._overlay.shows) or not (self._has.software and may_keep(scene, views, place)):
            self._still.forget()
            parts = None
        else:
            parts = self._still.parts(look_at(scene, views[0], place, self._list, self._shaders.replaced))
        self._picture.keep = self._still.keeps
        return parts

    def _batch_parts(self, scene: FrameScene, view: View, parts: Sequence[Rect]) -> list[ViewDraws]:
        """Queue what is seen in parts of a view."""
        x, y, *size = self._picture.rectangle(view.rectangle)
        drawn = []
        for part in parts:
            inside = (part[0] - x, part[1] - y, part[2], part[3])
            opaque, blended, away = self._list.batch_views(
                self._frame, [view], view.eye_world, [(size[0], size[1])], self._picture.samples, 0, inside
            )
            mixed = blended if scene.effects is None else scene.effects.mix(view, blended, away)
            drawn.append(ViewDraws(view, (x, y, size[0], size[1]), opaque, mixed, part=part))
        return drawn

    def _prepare(self, views: Sequence[View]) -> FrameScene:
        """Take over the world, and queue what casts shadows."""
        lighting, settings = gather_lighting(self.world), self.settings
        self._pictures.update(self.world)
        self._ambient = self._ambient or settings.ambient_occlusion > 0.0
        lights = light_features(lighting, settings)
        asked = lights | ({"AMBIENT_OCCLUSION"} if self._ambient else frozenset())
        fates = self._overlay is not None and self._overlay.asks_fates
        self._list.update(self.world, settings, light_features=asked, fates=fates)
        self._frame.begin()
        sizes = [self._picture.rectangle(view.rectangle)[2:] for view in views]
        coarser = math.sqrt(min(map(fewer_pixels, views, sizes)))
        self._shadows.prepare(lighting, views, self._list, self._frame, settings, coarser)
        effects, plan = self._prepare_effects(asked), self._shadows.plan
        items = self._list.items
        return FrameScene(self.world, items, lighting, plan, settings, self._ambient, lights, effects)

    def _prepare_effects(self, lights: frozenset[str]) -> EffectStage | None:
        """The stage of sprites and projectors, ready for this frame; None, and nothing loaded, in a world without."""
        if self.world.effects.empty:
            return None
        if self._effects is None:
            from mimics_app.rendering.visual.stages.effect_stage import EffectStage

            self._effects = EffectStage(self._surface.ctx, self._shaders, self._longest_texture)
        self._effects.prepare(self.world, lights)
        return self._effects

    def _batch(
        self, scene: FrameScene, views: Sequence[View], key: Hashable, places: Sequence[Rect]
    ) -> list[ViewDraws]:
        """Queue what is seen in a view, or in both of two eyes."""
        eyes = list(views) if len(views) == 1 else see_from_between(*views)
        sizes, samples = [place[2:] for place in places], self._picture.samples
        queue = self._list.batch_views(self._frame, views, eyes[0].eye_world, sizes, samples, key)
        opaque, blended, away = queue
        passes = self._pair_up([*opaque, *blended], places)
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
        return [
            replace(each, transparent=scene.effects.mix(each.view, blended, away), projected=projected)
            for each in drawn
        ]

    def _pair_up(self, runs: Sequence[DrawRun], places: Sequence[Rect]) -> EyePasses:
        """How what is queued is drawn: together only for two eyes over which nothing of the overlay is laid."""
        if len(places) != 2 or (self._overlay is not None and self._overlay.shows):
            return "alone"
        return eye_passes(self.settings, self._has, runs, places)

    def _batch_inside(self, scene: FrameScene, view: View, key: Hashable) -> ViewDraws:
        """Queue what is seen in a picture within the picture; it is where the view says itself."""
        return self._batch(scene, [view], key, [view.rectangle])[0]

    def _draw_overlay(
        self, overlay: Overlay, target: moderngl.Framebuffer, scene: FrameScene, drawn: Sequence[ViewDraws]
    ) -> int:
        """What the overlay shows in the world."""
        draws = overlay.draw_lines(target, scene, self._list, drawn)
        for each in drawn:
            self._world.enter(scene, each)
            draws += overlay.draw_wires(target, each)
        return draws

    def _draw_over(self, views: Sequence[View], parts: list[Rect] | None) -> int:
        """Show the world's picture, and over it what no filter touches and is never smaller: insets, figures."""
        rectangles = [view.rectangle for view in views]
        if self._picture.filtered:
            return self._picture.end(rectangles, parts) + self._draw_hud(views)
        return self._draw_hud(views) + self._picture.end(rectangles)

    def _draw_hud(self, views: Sequence[View]) -> int:
        draws = self._pictures.draw_insets(self.world, views, self.settings.hud_depth)
        huds = [self.hud]
        if self._overlay is not None and self._overlay.layers:
            draws += self._overlay.draw_atlas(self._surface.framebuffer, self._shadows)
            self._overlay.lay_out(self.hud.width, self.hud.height)
            huds.append(self._overlay.hud)
        if all(hud.empty for hud in huds):
            return draws
        for screen in dict.fromkeys(view.screen for view in views if view.screen >= 0):
            eyes = [view for view in views if view.screen == screen]
            plane = plane_of_views(eyes, self.settings.hud_depth)
            draws += sum(self._hud_pass.draw(hud, view, plane) for view in eyes for hud in huds)
        return draws


def _latched(drawn: list[ViewDraws], newer: Sequence[View]) -> list[ViewDraws]:
    """What is queued for some views, drawn from where their eyes are now; what is in a mirror stays as it was."""
    pairs = zip(drawn, newer, strict=True)
    return [each if each.mirrors else replace(each, view=each.view.latched(view)) for each, view in pairs]
