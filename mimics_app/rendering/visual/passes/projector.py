"""Projects pictures onto surfaces: each surface it meets is drawn once more where its depth is what was seen."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from mimics_app.rendering.visual.drawing.frame_buffers import FrameBuffers
from mimics_app.rendering.visual.drawing.mesh_arena import MeshArena
from mimics_app.rendering.visual.effects.projectors import Beam, BeamRuns
from mimics_app.rendering.visual.materials.look import Look
from mimics_app.rendering.visual.materials.shader_library import ShaderLibrary, ShaderProgram
from mimics_app.rendering.visual.materials.texture_store import TextureStore
from mimics_app.rendering.visual.view import View

if TYPE_CHECKING:
    import moderngl

__all__ = ["ProjectorPass"]

_BINDING = 10
_DEFINES = {"paint": (), "stain": ("STAIN",), "light": ("LIGHT",)}
_OF_ALBEDO = ("TEXTURED", "COLOURED", "UV_TRANSFORMS")
"""Features that a surface's own colour hangs on."""


class ProjectorPass:
    """Draws what projectors throw."""

    def __init__(self, ctx: moderngl.Context, shaders: ShaderLibrary, longest: int) -> None:
        self._ctx = ctx
        self._shaders = shaders
        self._textures = TextureStore(ctx, longest)

    def draw(
        self,
        target: moderngl.Framebuffer,
        arena: MeshArena,
        frame: FrameBuffers,
        view: View,
        thrown: Sequence[BeamRuns],
        lights: frozenset[str],
        eyes: tuple[str, ...],
    ) -> int:
        """Draw over what is opaque in a view; afterwards depth is written and tested as before.

        Args:
            target: Where to; holds the depth of what is opaque.
            arena: Has the meshes.
            frame: Has the instances.
            view: From where; its block is bound.
            thrown: Projectors with the surfaces they meet.
            lights: Features of shaders that the frame's light needs.
            eyes: What shaders are told besides where both eyes are drawn together.

        Returns:
            Draw calls made.
        """
        if not thrown:
            return 0
        ctx, draws = self._ctx, 0
        target.depth_mask = False
        ctx.depth_func = "=="
        for each in thrown:
            texture = self._textures.get(each.beam.key, each.beam.picture)
            texture.repeat_x = texture.repeat_y = False
            texture.use(_BINDING)
            for run in each.runs:
                run.look.bind()
                self._set_state(run.look, each.beam)
                shader = self._shaders.also_with(self._shader(run.look, each.beam, lights), eyes)
                _describe(shader, each.beam, view)
                frame.draw(arena, run, shader)
                draws += 1
        ctx.depth_func = "<"
        ctx.cull_face = "back"
        target.depth_mask = True
        return draws

    def release(self) -> None:
        """Free the pictures."""
        self._textures.release()

    def _set_state(self, look: Look, beam: Beam) -> None:
        import moderngl

        flags = moderngl.DEPTH_TEST | moderngl.BLEND
        cull = look.passes[0].cull
        if cull != "none":
            flags |= moderngl.CULL_FACE
            self._ctx.cull_face = cull
        self._ctx.enable_only(flags)
        self._ctx.blend_func = {
            "stain": (moderngl.DST_COLOR, moderngl.ZERO),
            # Display values: light on light comes nearer to the sum of the two than adding their codes does.
            "light": (moderngl.ONE_MINUS_DST_COLOR, moderngl.ONE),
        }.get(beam.spec.blend, (moderngl.ONE, moderngl.ONE_MINUS_SRC_ALPHA))

    def _shader(self, look: Look, beam: Beam, lights: frozenset[str]) -> ShaderProgram:
        defines = [*_DEFINES[beam.spec.blend], *(sorted(lights) if beam.spec.blend == "paint" else ())]
        if beam.spec.blend == "light":
            drawn = look.passes[0].shader
            # Pictures of the plain technique lie in arrays, which this shader does not read: their tint has to do.
            readable = _OF_ALBEDO if drawn.fragment != "plain/plain.frag" else ("COLOURED",)
            defines += [name for name in readable if name in drawn.defines]
        return self._shaders.program("common/mesh.vert", "projector/projector.frag", tuple(defines))


def _describe(shader: ShaderProgram, beam: Beam, view: View) -> None:
    """Give the shader the projector, relative to the eye, subtracted in float64."""
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
