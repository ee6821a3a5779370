"""Draws lines over the world, faint where they are occluded."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.rendering.visual.materials.shader_library import ShaderLibrary, ShaderProgram
from mimics_app.rendering.visual.materials.vertex_arrays import VertexArrays
from mimics_app.rendering.visual.overlay.line_set import LINE_ROW, LineSet
from mimics_app.rendering.visual.view import Rect, View

if TYPE_CHECKING:
    import moderngl

__all__ = ["LinePass"]

_FAINT = 0.22


class LinePass:
    """Draws lines of constant width on the screen."""

    def __init__(self, ctx: moderngl.Context, shaders: ShaderLibrary) -> None:
        self._ctx = ctx
        self._shader = shaders.program("overlay/lines.vert", "overlay/lines.frag")
        self._buffer: moderngl.Buffer | None = None
        self._arrays = VertexArrays(self._vertex_array)

    def draw(self, target: moderngl.Framebuffer, lines: LineSet, view: View, rectangle: Rect) -> int:
        """Draw lines into a view of the framebuffer in use; return the draw calls."""
        import moderngl

        rows = lines.rows(view.eye_world)
        if not len(rows):
            return 0
        self._upload(rows.tobytes())
        ctx, shader, array = self._ctx, self._shader, self._arrays.of(self._shader)
        target.viewport = rectangle
        shader.set_matrix("clip_from_eye", view.clip_from_eye)
        shader.set_numbers("size_px", rectangle[2:])
        target.depth_mask = False
        ctx.blend_func = moderngl.SRC_ALPHA, moderngl.ONE_MINUS_SRC_ALPHA
        for flags, strength in ((moderngl.BLEND, _FAINT), (moderngl.BLEND | moderngl.DEPTH_TEST, 1.0)):
            ctx.enable_only(flags)
            ctx.depth_func = "<="
            shader.set_number("strength", strength)
            array.render(moderngl.TRIANGLE_STRIP, vertices=4, instances=len(rows))
        ctx.depth_func = "<"
        target.depth_mask = True
        return 2

    def release(self) -> None:
        """Free buffer and vertex array."""
        self._arrays.release()
        if self._buffer is not None:
            self._buffer.release()
            self._buffer = None

    def _upload(self, data: bytes) -> None:
        if self._buffer is None or self._buffer.size < len(data):
            self.release()
            self._buffer = self._ctx.buffer(reserve=max(2 * len(data), 256 * LINE_ROW.itemsize))
        self._buffer.orphan()
        self._buffer.write(data)

    def _vertex_array(self, shader: ShaderProgram) -> moderngl.VertexArray:
        content = [(self._buffer, "3f 3f 4f 2f /i", "begin", "end", "tint", "widths")]
        return self._ctx.vertex_array(shader.program, content)
