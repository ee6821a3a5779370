"""Sprites and projectors of a frame from the world to the driver; made when a world first has any."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.errors import Issue
from mimics_app.rendering.visual.drawing.draw_list import DrawList
from mimics_app.rendering.visual.drawing.frame_buffers import DrawRun, FrameBuffers
from mimics_app.rendering.visual.drawing.mesh_arena import MeshArena
from mimics_app.rendering.visual.effects.projectors import BeamRuns, ProjectorField
from mimics_app.rendering.visual.effects.sprites import SpriteField, SpriteRun
from mimics_app.rendering.visual.materials.picture_arrays import PictureArrays
from mimics_app.rendering.visual.materials.shader_library import ShaderLibrary
from mimics_app.rendering.visual.passes.projector import ProjectorPass
from mimics_app.rendering.visual.passes.sprites import SpritePass
from mimics_app.rendering.visual.passes.states import draw_runs
from mimics_app.rendering.visual.view import View, compute_frustum_planes
from mimics_app.world.world import World

if TYPE_CHECKING:
    import moderngl

__all__ = ["EffectStage"]


class EffectStage:
    """Everything that is seen but is no body."""

    def __init__(self, ctx: moderngl.Context, shaders: ShaderLibrary, longest_texture: int) -> None:
        self._pictures = PictureArrays(ctx, longest_texture)
        self._field = SpriteField(self._pictures)
        self._sprites = SpritePass(ctx, shaders)
        self._projectors = ProjectorField()
        self._projecting = ProjectorPass(ctx, shaders, longest_texture)
        self._lights: frozenset[str] = frozenset()

    def prepare(self, world: World, lights: frozenset[str]) -> None:
        """Take over the world's effects as they are at its time.

        Args:
            world: After its update.
            lights: Features of shaders that the frame's light needs.
        """
        self._lights = lights
        self._field.update(world)
        self._projectors.update(world)

    @property
    def sprites(self) -> F8:
        """All sprites, a row each: a sphere about each one [m], then its look and the rest; float64 [n, m]."""
        return self._field.figures

    def mix(self, view: View, surfaces: Sequence[DrawRun], away: F8) -> list[DrawRun | SpriteRun]:
        """Queue the sprites of a view among its blended surfaces, see `SpriteField.batch`."""
        return self._field.batch(view, surfaces, away)

    def meet(self, views: Sequence[View], listed: DrawList, frame: FrameBuffers) -> list[BeamRuns]:
        """Queue the opaque surfaces that projectors meet, of the views that were batched last."""
        planes = [compute_frustum_planes(view.clip_from_world) for view in views]
        met = [
            BeamRuns(beam, listed.batch_meeting(frame, views[0], beam.planes, beam.onto))
            for beam in self._projectors.beams
            if any(beam.is_seen(each) for each in planes)
        ]
        return [each for each in met if each.runs]

    def upload(self) -> None:
        """Send the sprites of all views to the GPU."""
        self._sprites.upload(self._field.corners[: self._field.count])

    def project(
        self,
        target: moderngl.Framebuffer,
        arena: MeshArena,
        frame: FrameBuffers,
        view: View,
        projected: Sequence[BeamRuns],
        eyes: tuple[str, ...],
    ) -> int:
        """Draw projected pictures onto what is opaque; returns the draw calls made."""
        return self._projecting.draw(target, arena, frame, view, projected, self._lights, eyes)

    def draw_mixed(
        self, target: moderngl.Framebuffer, arena: MeshArena, frame: FrameBuffers, runs: Sequence[DrawRun | SpriteRun]
    ) -> int:
        """Draw sprites and blended surfaces in their order; returns the draw calls made."""
        draws = 0
        for run in runs:
            if isinstance(run, SpriteRun):
                draws += self._sprites.draw(target, run, self._lights)
            else:
                draws += draw_runs(target, arena, frame, [run])
        return draws

    def take_issues(self) -> list[Issue]:
        """What could not be drawn as the world asks since the last call."""
        taken = [*self._field.issues, *self._projectors.issues]
        self._field.issues, self._projectors.issues = [], []
        return taken

    def release(self) -> None:
        """Free everything."""
        for part in (self._sprites, self._projecting, self._pictures):
            part.release()
