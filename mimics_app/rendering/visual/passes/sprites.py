"""Sprite pass: draws the sprite runs of a view."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from mimics_app.rendering.visual.effects.sprites import SpriteRun, SpriteState
from mimics_app.rendering.visual.kernels.sprites import SPRITE_VERTEX
from mimics_app.rendering.visual.materials.shader_library import ShaderLibrary, ShaderProgram
from mimics_app.rendering.visual.materials.vertex_arrays import VertexArrays
from mimics_app.rendering.visual.settings import ParticleLight

if TYPE_CHECKING:
    import moderngl

__all__ = ["SpritePass"]

_FORMATS = {"position": "3f4", "tint": "4f4", "style": "4u2", "at": "2i2", "normal": "4i1"}
"""Fields of SPRITE_VERTEX in order, in moderngl's notation."""

_TWO_TRIANGLES = np.array([0, 1, 2, 2, 1, 3], np.uint32)
_INDICES = len(_TWO_TRIANGLES)
_BINDING = 0
_OF_DISPLAY = frozenset(("HAZE", "TONED"))
"""Light features that apply to unlit sprites too."""


class SpritePass:
    """Buffers and shaders of sprites, created with the first visible sprite.

    Vertices are computed on the processor: software drivers take half as long for them as for as many instances.

    Attributes:
        particle_light: Where the light of lit particles is computed.
    """

    def __init__(self, ctx: moderngl.Context, shaders: ShaderLibrary) -> None:
        self.particle_light: ParticleLight = "pixel"
        self._ctx = ctx
        self._shaders = shaders
        self._vertices: moderngl.Buffer | None = None
        self._indices: moderngl.Buffer | None = None
        self._arrays = VertexArrays(self._vertex_array)

    def upload(self, vertices: NDArray[np.void]) -> None:
        """Upload the sprites of all views of a frame: SPRITE_VERTEX [n, 4], contiguous."""
        if not len(vertices):
            return
        if self._vertices is None or self._vertices.size < vertices.nbytes:
            self.release()
            self._vertices = self._ctx.buffer(reserve=2 * vertices.nbytes)
            firsts = np.arange(0, 2 * vertices.size, 4, dtype=np.uint32)
            self._indices = self._ctx.buffer((firsts[:, None] + _TWO_TRIANGLES).tobytes())
        self._vertices.orphan()
        self._vertices.write(vertices)

    def draw(self, target: moderngl.Framebuffer, run: SpriteRun, lights: frozenset[str]) -> int:
        """Draw a run; depth write is on afterwards.

        Args:
            target: The framebuffer in use.
            run: Run of the uploaded sprites.
            lights: Shader features that the frame's light needs.

        Returns:
            Draw calls made.
        """
        import moderngl

        flags = moderngl.DEPTH_TEST
        if not run.state.masked:
            flags |= moderngl.BLEND
            self._ctx.blend_func = moderngl.ONE, moderngl.ONE_MINUS_SRC_ALPHA
        self._ctx.enable_only(flags)
        target.depth_mask = run.state.masked
        run.state.pictures.use(_BINDING)
        array = self._arrays.of(self._shader(run.state, lights))
        array.render(moderngl.TRIANGLES, _INDICES * run.count, first=_INDICES * run.first)
        target.depth_mask = True
        return 1

    def release(self) -> None:
        """Free all buffers."""
        self._arrays.release()
        for buffer in (self._vertices, self._indices):
            if buffer is not None:
                buffer.release()
        self._vertices = self._indices = None

    def _shader(self, state: SpriteState, lights: frozenset[str]) -> ShaderProgram:
        defines = ["MASKED"] if state.masked else []
        if state.dots:
            defines.append("DOTS")
        flat = state.flat and self.particle_light == "vertex"
        if state.lit:
            defines += ["FLAT" if flat else "ROUND", *sorted(lights)]
        else:
            defines += sorted(lights & _OF_DISPLAY)
        defines.append("SHADE=smooth" if flat else "SHADE=flat")
        return self._shaders.program("sprite/sprite.vert", "sprite/sprite.frag", tuple(defines))

    def _vertex_array(self, shader: ShaderProgram) -> moderngl.VertexArray:
        assert self._vertices is not None and self._indices is not None, "runs are drawn after upload"
        # A program does not list a field that it does not read: its bytes are skipped.
        read = [name for name in _FORMATS if name in shader.program]
        fields = [_FORMATS[name] if name in read else f"{SPRITE_VERTEX[name].itemsize}x" for name in _FORMATS]
        content = (self._vertices, " ".join(fields), *read)
        return self._ctx.vertex_array(shader.program, [content], self._indices)
