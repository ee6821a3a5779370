"""Stage of sprites and projectors; created when a world first has any."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from mimics_app.contracts.arrays import B1, F8
from mimics_app.contracts.errors import Issue
from mimics_app.rendering.visual.drawing.draw_list import DrawList
from mimics_app.rendering.visual.drawing.frame_buffers import DrawRun, FrameBuffers
from mimics_app.rendering.visual.effects.far_sprites import FarSprites
from mimics_app.rendering.visual.effects.projectors import Beam, BeamRuns, ProjectorField
from mimics_app.rendering.visual.effects.sprites import SpriteField, SpriteRun
from mimics_app.rendering.visual.materials.picture_arrays import PictureArrays
from mimics_app.rendering.visual.materials.shader_library import ShaderLibrary
from mimics_app.rendering.visual.passes.projector import ProjectorPass
from mimics_app.rendering.visual.passes.sprites import SpritePass
from mimics_app.rendering.visual.passes.states import draw_runs
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.surfaces.rasteriser import rasteriser_of
from mimics_app.rendering.visual.view import View
from mimics_app.world.content.world import World

if TYPE_CHECKING:
    import moderngl

__all__ = ["EffectStage"]


class EffectStage:
    """Prepares and draws sprites and projected textures."""

    def __init__(self, ctx: moderngl.Context, shaders: ShaderLibrary, max_size: int) -> None:
        self._pictures = PictureArrays(ctx, shaders, max_size)
        self._field = SpriteField(self._pictures, rasteriser_of(ctx).member(FarSprites)())
        self._sprites = SpritePass(ctx, shaders)
        self._projectors = ProjectorField()
        self._projecting = ProjectorPass(ctx, shaders, max_size)
        self._lights: frozenset[str] = frozenset()

    def prepare(self, world: World, lights: frozenset[str], settings: RenderSettings) -> None:
        """Update the effects from the world, at its time.

        Args:
            world: The world, updated.
            lights: Shader features that the frame's light needs.
            settings: Quality.
        """
        self._lights = lights
        self._sprites.particle_light = settings.particle_light
        self._field.cuts = settings.profile != "study"
        self._field.update(world)
        by_maps = settings.shadows.startswith("texture")
        self._projectors.update(world, shadows=settings.shadow_size > 0 or not by_maps)

    @property
    def sprites(self) -> F8:
        """All sprites, one row each: bounding sphere [m], then all other fields; float64 [n, m]."""
        return self._field.figures

    @property
    def lit(self) -> B1:
        """Which of the sprites are lit, [n]."""
        return self._field.lit

    @property
    def beams(self) -> Mapping[int, Beam]:
        """The projectors that are shown, by the index of their node."""
        return self._projectors.beams

    def mix(
        self, view: View, height: int, surfaces: Sequence[DrawRun], away: F8, *, split: bool = False
    ) -> tuple[list[DrawRun | SpriteRun], list[SpriteRun] | None]:
        """Queue the sprites of a view among its blended surfaces, see `SpriteField.batch`."""
        return self._field.batch(view, height, surfaces, away, split=split)

    @property
    def behind(self) -> bytes:
        """The records of the sprites that `mix` split off last, for comparison with those of another frame."""
        return self._field.behind

    def meet(self, views: Sequence[View], listed: DrawList, frame: FrameBuffers) -> list[BeamRuns]:
        """Queue the opaque surfaces that projectors hit, of the views that were batched last."""
        met = [
            BeamRuns(beam, listed.batch_meeting(frame, views[0], beam.planes, beam.onto))
            for beam in self._projectors.beams.values()
            if any(beam.is_seen(view.frustum_planes) for view in views)
        ]
        return [each for each in met if each.runs]

    def upload(self) -> None:
        """Upload the sprites of all views."""
        self._sprites.upload(self._field.vertices[: self._field.count])

    def project(
        self,
        target: moderngl.Framebuffer,
        frame: FrameBuffers,
        view: View,
        projected: Sequence[BeamRuns],
        eyes: tuple[str, ...],
        *,
        whole: bool,
    ) -> int:
        """Draw projected textures onto the opaque surfaces, see `ProjectorPass.draw`; return the draw calls."""
        return self._projecting.draw(target, frame, view, projected, self._lights, eyes, whole=whole)

    def draw_mixed(self, target: moderngl.Framebuffer, frame: FrameBuffers, runs: Sequence[DrawRun | SpriteRun]) -> int:
        """Draw sprites and blended surfaces in order; return the draw calls."""
        draws = 0
        for run in runs:
            if isinstance(run, SpriteRun):
                draws += self._sprites.draw(target, run, self._lights)
            else:
                draws += draw_runs(target, frame, [run])
        return draws

    def take_issues(self) -> list[Issue]:
        """Return what could not be drawn as the world requires since the last call."""
        taken = [*self._field.issues, *self._projectors.issues]
        self._field.issues, self._projectors.issues = [], []
        return taken

    def release(self) -> None:
        """Free everything."""
        for part in (self._sprites, self._projecting, self._pictures):
            part.release()
