"""Draws sprites: one instance each, in the runs a view was cut into."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from mimics_app.rendering.visual.kernels.sprites import SPRITE_FLOATS
from mimics_app.rendering.visual.shader_library import ShaderLibrary, ShaderProgram
from mimics_app.rendering.visual.sprites import SpriteRun, SpriteState

if TYPE_CHECKING:
    import moderngl

__all__ = ["SpritePass"]

_LAYOUT = "3f 3f 3f 4f 4f /i"
_NAMES = ("middle", "across", "along", "tint", "style")
_BINDING = 0
_CORNERS = 4
_COMMAND = np.dtype(
    [("vertices", "u4"), ("instances", "u4"), ("first", "u4"), ("base_instance", "u4"), ("unused", "u4")]
)
"""As glMultiDrawArraysIndirect reads it, in steps of 20 bytes, which moderngl takes for draws without indices too."""


class SpritePass:
    """Buffers and shaders of sprites; nothing is made before the first sprite is seen."""

    def __init__(self, ctx: moderngl.Context, shaders: ShaderLibrary) -> None:
        self._ctx = ctx
        self._shaders = shaders
        self._rows: moderngl.Buffer | None = None
        self._commands: moderngl.Buffer | None = None
        self._arrays: dict[ShaderProgram, tuple[int, moderngl.VertexArray]] = {}
        self._places: dict[SpriteRun, int] = {}

    def upload(self, instances: NDArray[np.float32], runs: list[SpriteRun]) -> None:
        """Send the sprites of a frame to the GPU.

        Args:
            instances: Of all views, float32 [n, SPRITE_FLOATS], contiguous.
            runs: Of all views.
        """
        if not runs:
            return
        commands = np.zeros(len(runs), _COMMAND)
        commands["vertices"] = _CORNERS
        commands["instances"] = [run.count for run in runs]
        commands["base_instance"] = [run.first for run in runs]
        self._places = {run: number for number, run in enumerate(runs)}
        if self._rows is None or self._rows.size < instances.nbytes:
            self.release()
            self._rows = self._ctx.buffer(reserve=2 * instances.nbytes)
        if self._commands is None or self._commands.size < commands.nbytes:
            if self._commands is not None:
                self._commands.release()
            self._commands = self._ctx.buffer(reserve=2 * commands.nbytes)
        for buffer, data in ((self._rows, instances), (self._commands, commands)):
            buffer.orphan()
            buffer.write(data)

    def draw(self, target: moderngl.Framebuffer, run: SpriteRun, lights: frozenset[str]) -> int:
        """Draw a run; afterwards depth is written.

        Args:
            target: Where to; in use.
            run: Of those uploaded.
            lights: Features of shaders that the frame's light needs.

        Returns:
            Draw calls made.
        """
        import moderngl

        assert self._commands is not None, "runs are drawn after upload"
        flags = moderngl.DEPTH_TEST
        if not run.state.masked:
            flags |= moderngl.BLEND
            self._ctx.blend_func = moderngl.ONE, moderngl.ONE_MINUS_SRC_ALPHA
        self._ctx.enable_only(flags)
        target.depth_mask = run.state.masked
        run.state.pictures.use(_BINDING)
        array = self._array(self._shader(run.state, lights))
        array.render_indirect(self._commands, moderngl.TRIANGLE_STRIP, 1, first=self._places[run])
        target.depth_mask = True
        return 1

    def release(self) -> None:
        """Free all buffers."""
        for _, array in self._arrays.values():
            array.release()
        self._arrays.clear()
        for buffer in (self._rows, self._commands):
            if buffer is not None:
                buffer.release()
        self._rows = self._commands = None

    def _shader(self, state: SpriteState, lights: frozenset[str]) -> ShaderProgram:
        defines = ["MASKED"] if state.masked else []
        if state.lit:
            defines += ["LIT", *sorted(lights)]
        return self._shaders.program("sprite/sprite.vert", "sprite/sprite.frag", tuple(defines))

    def _array(self, shader: ShaderProgram) -> moderngl.VertexArray:
        known = self._arrays.get(shader)
        if known is not None and known[0] == shader.revision:
            return known[1]
        program = shader.program
        parts = zip(_LAYOUT.removesuffix(" /i").split(), _NAMES, strict=True)
        # What the compiler found unused is skipped over.
        layout = " ".join(part if name in program else f"{4 * int(part[0])}x" for part, name in parts)
        names = [name for name in _NAMES if name in program]
        assert self._rows is not None and self._rows.size >= 4 * SPRITE_FLOATS
        array = self._ctx.vertex_array(program, [(self._rows, f"{layout} /i", *names)])
        self._arrays[shader] = (shader.revision, array)
        return array
