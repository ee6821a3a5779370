"""Projective textures: each surface that a projector hits is drawn again with depth test "equal"."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from mimics_app.rendering.visual.drawing.frame_buffers import FrameBuffers
from mimics_app.rendering.visual.effects.projectors import Beam, BeamRuns
from mimics_app.rendering.visual.materials.material_instance import MaterialInstance
from mimics_app.rendering.visual.materials.shader_library import ShaderLibrary, ShaderProgram
from mimics_app.rendering.visual.materials.texture_store import TextureStore
from mimics_app.rendering.visual.view import Rect, View

if TYPE_CHECKING:
    import moderngl

__all__ = ["ProjectorPass"]

_BINDING = 10
_DEFINES = {"paint": (), "stain": ("STAIN",), "light": ("LIGHT",)}
_OF_ALBEDO = ("TEXTURED", "COLOURED", "UV_TRANSFORMS")
"""Shader features that the surface's albedo depends on."""


class ProjectorPass:
    """Draws projected textures."""

    def __init__(self, ctx: moderngl.Context, shaders: ShaderLibrary, max_size: int) -> None:
        self._ctx = ctx
        self._shaders = shaders
        self._textures = TextureStore(ctx, shaders, max_size)

    def draw(
        self,
        target: moderngl.Framebuffer,
        frame: FrameBuffers,
        view: View,
        projected: Sequence[BeamRuns],
        lights: frozenset[str],
        eyes: tuple[str, ...],
        *,
        whole: bool,
    ) -> int:
        """Draw over the opaque surfaces of a view; depth state is restored afterwards.

        Args:
            target: Framebuffer with the depth of the opaque surfaces.
            frame: Buffers of the frame.
            view: The view; its block is bound.
            projected: Projectors with the surfaces they hit.
            lights: Shader features that the frame's light needs.
            eyes: Additional defines where both eyes are drawn in one pass.
            whole: Whether one view is drawn as a whole, so that the pass may set the scissor rectangle.

        Returns:
            Draw calls made.
        """
        if not projected:
            return 0
        ctx, draws = self._ctx, 0
        target.depth_mask = False
        ctx.depth_func = "=="
        for each in projected:
            if whole:
                target.scissor = _bounds(each.beam, view, target.viewport)
            texture = self._textures.get(each.beam.key, each.beam.picture)
            texture.repeat_x = texture.repeat_y = False
            texture.use(_BINDING)
            for run in each.runs:
                run.material_instance.bind()
                self._set_state(run.material_instance, each.beam)
                shader = self._shaders.also_with(self._shader(run.material_instance, each.beam, lights), eyes)
                _describe(shader, each.beam, view)
                frame.draw(run, shader)
                draws += 1
        if whole:
            target.scissor = None  # type: ignore[assignment]  # disables it
        ctx.depth_func = "<"
        ctx.cull_face = "back"
        target.depth_mask = True
        return draws

    def release(self) -> None:
        """Free the textures."""
        self._textures.release()

    def _set_state(self, instance: MaterialInstance, beam: Beam) -> None:
        import moderngl

        flags = moderngl.DEPTH_TEST | moderngl.BLEND
        cull = instance.passes[0].cull
        if cull != "none":
            flags |= moderngl.CULL_FACE
            self._ctx.cull_face = cull
        self._ctx.enable_only(flags)
        self._ctx.blend_func = {
            "stain": (moderngl.DST_COLOR, moderngl.ZERO),
            # On display values this "screen" blending is closer to a sum of light than addition.
            "light": (moderngl.ONE_MINUS_DST_COLOR, moderngl.ONE),
        }.get(beam.spec.blend, (moderngl.ONE, moderngl.ONE_MINUS_SRC_ALPHA))

    def _shader(self, instance: MaterialInstance, beam: Beam, lights: frozenset[str]) -> ShaderProgram:
        defines = [*_DEFINES[beam.spec.blend], *(sorted(lights) if beam.spec.blend == "paint" else ())]
        if beam.spec.blend == "light":
            drawn = instance.passes[0].shader
            # Textures of the plain technique are in arrays, which this shader does not read: tint only.
            readable = _OF_ALBEDO if drawn.fragment != "plain/plain.frag" else ("COLOURED",)
            defines += [name for name in readable if name in drawn.defines]
        return self._shaders.program("common/mesh.vert", "projector/projector.frag", tuple(defines))


def _bounds(beam: Beam, view: View, viewport: Rect) -> Rect:
    """Return the rectangle of a viewport [px] outside of which a projector shows nothing."""
    left, bottom, width, height = viewport
    places = np.column_stack([beam.corners, np.ones(len(beam.corners))]) @ view.clip_from_world.T
    if (places[:, 3] <= 0.0).any():  # a corner is behind the eye
        return viewport
    size = np.array([width, height])
    at = 0.5 * (places[:, :2] / places[:, 3:] + 1.0) * size
    low = np.clip(np.floor(at.min(axis=0)) - 1.0, 0, size).astype(int)
    high = np.clip(np.ceil(at.max(axis=0)) + 1.0, low, size).astype(int)
    return int(left + low[0]), int(bottom + low[1]), int(high[0] - low[0]), int(high[1] - low[1])


def _describe(shader: ShaderProgram, beam: Beam, view: View) -> None:
    """Set the projector's uniforms, relative to the camera, subtracted in float64."""
    world_from_eye = np.eye(4)
    world_from_eye[:3, 3] = view.eye_world
    shader.set_matrix("slide_from_eye", beam.texture_from_world @ world_from_eye)
    towards = beam.towards.copy()
    towards[:3] -= towards[3] * view.eye_world
    spec = beam.spec
    lean = (math.cos(spec.full_angle), math.cos(spec.last_angle))
    for name, value in (("towards", towards), ("slide_tint", spec.colour), ("lean", lean)):
        uniform: Any = shader.program[name]
        uniform.value = tuple(float(number) for number in value)
