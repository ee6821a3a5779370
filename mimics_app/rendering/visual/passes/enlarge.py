"""Brings a picture that was drawn smaller to the full size of the surface."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.rendering.visual.shader_library import ShaderLibrary

if TYPE_CHECKING:
    import moderngl

__all__ = ["EnlargePass"]

_BINDING = 4


class EnlargePass:
    """Fills the framebuffer in use with a texture, linearly filtered."""

    def __init__(self, ctx: moderngl.Context, shaders: ShaderLibrary) -> None:
        self._ctx = ctx
        self._shaders = shaders
        self._revision = -1
        self._array: moderngl.VertexArray | None = None

    def draw(self, picture: moderngl.Texture) -> None:
        """Draw it; compiled when it is first needed."""
        import moderngl

        shader = self._shaders.program("enlarge/enlarge.vert", "enlarge/enlarge.frag")
        if self._array is None or self._revision != shader.revision:
            self._array = self._ctx.vertex_array(shader.program, [])
            self._revision = shader.revision
        self._ctx.enable_only(moderngl.NOTHING)
        picture.use(_BINDING)
        self._array.render(moderngl.TRIANGLES, vertices=3)

    def release(self) -> None:
        """Free the vertex array."""
        if self._array is not None:
            self._array.release()
            self._array = None
