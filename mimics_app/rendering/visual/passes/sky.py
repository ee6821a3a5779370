"""The sky behind everything."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.rendering.visual.shader_library import ShaderLibrary

if TYPE_CHECKING:
    import moderngl

__all__ = ["SkyPass"]


class SkyPass:
    """Draws the sky wherever nothing opaque was drawn."""

    def __init__(self, ctx: moderngl.Context, shaders: ShaderLibrary) -> None:
        self._ctx = ctx
        self._shader = shaders.program("sky/sky.vert", "sky/sky.frag")
        self._revision = -1
        self._array: moderngl.VertexArray | None = None

    def draw(self) -> int:
        """Draw it; returns the draw calls made."""
        import moderngl

        if self._array is None or self._revision != self._shader.revision:
            self._array = self._ctx.vertex_array(self._shader.program, [])
            self._revision = self._shader.revision
        self._ctx.enable_only(moderngl.DEPTH_TEST)
        self._ctx.depth_func = "<="
        self._array.render(moderngl.TRIANGLES, vertices=3)
        self._ctx.depth_func = "<"
        return 1

    def release(self) -> None:
        """Free the vertex array."""
        if self._array is not None:
            self._array.release()
            self._array = None
