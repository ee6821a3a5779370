"""Draws sprites in the runs a view was cut into."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from mimics_app.rendering.visual.effects.sprites import SpriteRun, SpriteState
from mimics_app.rendering.visual.kernels.sprites import SPRITE_VERTEX
from mimics_app.rendering.visual.materials.shader_library import ShaderLibrary, ShaderProgram

if TYPE_CHECKING:
    import moderngl

__all__ = ["SpritePass"]

_FORMATS = {"position": "3f4", "tint": "4f4", "style": "4u2"}
"""Of the fields of SPRITE_VERTEX, in their order, as moderngl writes them."""

_TWO_TRIANGLES = np.array([0, 1, 2, 2, 1, 3], np.uint32)
_INDICES = len(_TWO_TRIANGLES)
_BINDING = 0
_OF_DISPLAY = frozenset(("HAZE", "TONED"))
"""Features of the frame's light that change what a sprite of its own light is shown as."""


class SpritePass:
    """Buffers and shaders of sprites; nothing is made before the first sprite is seen.

    Corners are computed on the processor: drivers that draw there need half the time for them of what they need for
    as many instances.
    """

    def __init__(self, ctx: moderngl.Context, shaders: ShaderLibrary) -> None:
        self._ctx = ctx
        self._shaders = shaders
        self._corners: moderngl.Buffer | None = None
        self._indices: moderngl.Buffer | None = None
        self._arrays: dict[ShaderProgram, tuple[int, moderngl.VertexArray]] = {}

    def upload(self, corners: NDArray[np.void]) -> None:
        """Send the sprites of a frame to the GPU: SPRITE_VERTEX [n, 4], contiguous, of all views."""
        if not len(corners):
            return
        if self._corners is None or self._corners.size < corners.nbytes:
            self.release()
            self._corners = self._ctx.buffer(reserve=2 * corners.nbytes)
            firsts = np.arange(0, 2 * corners.size, 4, dtype=np.uint32)
            self._indices = self._ctx.buffer((firsts[:, None] + _TWO_TRIANGLES).tobytes())
        self._corners.orphan()
        self._corners.write(corners)

    def draw(self, target: moderngl.Framebuffer, run: SpriteRun, lights: frozenset[str]) -> int:
        """Draw a run; afterwards depth is written.

        Args:
            target: Where to; in use.
            run: Of what was uploaded.
            lights: Features of shaders that the frame's light needs.

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
        array = self._array(self._shader(run.state, lights))
        array.render(moderngl.TRIANGLES, _INDICES * run.count, first=_INDICES * run.first)
        target.depth_mask = True
        return 1

    def release(self) -> None:
        """Free all buffers."""
        for _, array in self._arrays.values():
            array.release()
        self._arrays.clear()
        for buffer in (self._corners, self._indices):
            if buffer is not None:
                buffer.release()
        self._corners = self._indices = None

    def _shader(self, state: SpriteState, lights: frozenset[str]) -> ShaderProgram:
        defines = ["MASKED"] if state.masked else []
        if state.dots:
            defines.append("DOTS")
        if state.lit:
            defines += ["LIT", *sorted(lights)]
        else:
            defines += sorted(lights & _OF_DISPLAY)
        return self._shaders.program("sprite/sprite.vert", "sprite/sprite.frag", tuple(defines))

    def _array(self, shader: ShaderProgram) -> moderngl.VertexArray:
        known = self._arrays.get(shader)
        if known is not None and known[0] == shader.revision:
            return known[1]
        assert self._corners is not None and self._indices is not None, "runs are drawn after upload"
        content = (self._corners, " ".join(_FORMATS.values()), *(SPRITE_VERTEX.names or ()))
        array = self._ctx.vertex_array(shader.program, [content], self._indices)
        self._arrays[shader] = (shader.revision, array)
        return array
