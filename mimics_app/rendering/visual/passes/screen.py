"""Full-screen passes: one triangle over a rectangle, shaded from a region of a texture."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from mimics_app.rendering.visual.materials.shader_library import ShaderLibrary
from mimics_app.rendering.visual.materials.vertex_arrays import bare_arrays
from mimics_app.rendering.visual.view import Rect

if TYPE_CHECKING:
    import moderngl

__all__ = ["ScreenPass"]

_BINDING = 20
"""Binding of the texture in shaders/post/region.glsl."""


class ScreenPass:
    """Runs a fragment shader over a rectangle of the framebuffer in use; compiled on first use.

    Args:
        ctx: Context of the pass.
        shaders: Shader library.
        fragment: Path of a shader that includes post/region.glsl.
        defines: Names to `#define`.
    """

    def __init__(
        self, ctx: moderngl.Context, shaders: ShaderLibrary, fragment: str, defines: tuple[str, ...] = ()
    ) -> None:
        self._ctx = ctx
        self._shaders = shaders
        self._fragment, self._defines = fragment, defines
        self._arrays = bare_arrays(ctx)

    def draw(
        self,
        source: moderngl.Texture,
        region: Rect,
        place: Rect,
        *,
        within: Sequence[Rect | None] = (None,),
        blend: bool = False,
        depth: bool = False,
        **numbers: float,
    ) -> int:
        """Fill a rectangle.

        Args:
            source: The texture.
            region: Region that is shown, and outside of which nothing is sampled [texels].
            place: Rectangle to fill in the framebuffer in use [px].
            within: Scissor rectangles [px]; None: all of the framebuffer. The last one stays.
            blend: True blends by the shader's alpha.
            depth: True tests and writes depth; the triangle's is 0.5.
            numbers: Values of uniforms.

        Returns:
            Draw calls made.
        """
        import moderngl

        shader = self._shaders.program("post/screen.vert", self._fragment, self._defines)
        shader.set_numbers("region", region)
        for name, value in numbers.items():
            shader.set_number(name, value)
        self._ctx.viewport = place
        self._ctx.enable_only((moderngl.BLEND if blend else 0) | (moderngl.DEPTH_TEST if depth else 0))
        if blend:
            self._ctx.blend_func = moderngl.SRC_ALPHA, moderngl.ONE_MINUS_SRC_ALPHA
        source.use(_BINDING)
        triangle = self._arrays.of(shader)
        for each in within:
            self._ctx.scissor = each
            triangle.render(moderngl.TRIANGLES, vertices=3)
        return len(within)

    def release(self) -> None:
        """Free the vertex array."""
        self._arrays.release()
