"""Full-screen passes: one triangle over a rectangle, shaded from a region of a texture."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from mimics_app.rendering.visual.materials.shader_library import ShaderLibrary
from mimics_app.rendering.visual.view import Rect

if TYPE_CHECKING:
    import moderngl

__all__ = ["PictureFilter", "ScreenPass"]

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
        self._made: tuple[int, moderngl.VertexArray] | None = None

    def draw(
        self, source: moderngl.Texture, region: Rect, place: Rect, *, blend: bool = False, **numbers: float
    ) -> int:
        """Fill a rectangle.

        Args:
            source: The texture.
            region: Region that is shown, and outside of which nothing is sampled [texels].
            place: Rectangle to fill in the framebuffer in use [px].
            blend: True blends by the shader's alpha.
            numbers: Values of uniforms.

        Returns:
            Draw calls made.
        """
        import moderngl

        shader = self._shaders.program("post/screen.vert", self._fragment, self._defines)
        if self._made is None or self._made[0] != shader.revision:
            self.release()
            self._made = (shader.revision, self._ctx.vertex_array(shader.program, []))
        shader.set_numbers("region", region)
        for name, value in numbers.items():
            shader.set_number(name, value)
        self._ctx.viewport = place
        self._ctx.enable_only(moderngl.BLEND if blend else moderngl.NOTHING)
        if blend:
            self._ctx.blend_func = moderngl.SRC_ALPHA, moderngl.ONE_MINUS_SRC_ALPHA
        source.use(_BINDING)
        self._made[1].render(moderngl.TRIANGLES, vertices=3)
        return 1

    def release(self) -> None:
        """Free the vertex array."""
        if self._made is not None:
            self._made[1].release()
            self._made = None


class PictureFilter:
    """Filters each view's region of a picture by one shader with fixed uniforms.

    Args:
        ctx: Context of the pass.
        shaders: Shader library.
        fragment: Path of a shader that includes post/region.glsl.
        reach: Radius of the filter [texels].
        numbers: Values of uniforms.
    """

    def __init__(
        self, ctx: moderngl.Context, shaders: ShaderLibrary, fragment: str, reach: int, **numbers: float
    ) -> None:
        self._pass = ScreenPass(ctx, shaders, fragment)
        self._reach = reach
        self._numbers = numbers

    def draw(
        self, source: moderngl.Texture, target: moderngl.Framebuffer, regions: Sequence[Rect], places: Sequence[Rect]
    ) -> int:
        """Fill a target.

        Args:
            source: The picture.
            target: Framebuffer to fill.
            regions: Region of each view in the picture [texels].
            places: Rectangle of each view in the target [px].

        Returns:
            Draw calls made.
        """
        target.use()
        each = zip(regions, places, strict=True)
        return sum(self._pass.draw(source, region, place, blend=False, **self._numbers) for region, place in each)

    def draw_parts(
        self,
        source: moderngl.Texture,
        target: moderngl.Framebuffer,
        region: Rect,
        place: Rect,
        parts: Sequence[Rect],
    ) -> list[Rect]:
        """Update a target that holds the filtered last picture of a view.

        Args:
            source: The picture.
            target: Framebuffer to update.
            region: Region of the view in the picture [texels].
            place: Rectangle of the view in the target [px].
            parts: Rectangles of the picture that changed [texels].

        Returns:
            Rectangles of the target that were written, one per part [px].
        """
        written = [_reached(part, region, place, self._reach) for part in parts]
        for each in written:
            target.scissor = each
            self.draw(source, target, [region], [place])
        target.scissor = None  # type: ignore[assignment]  # None disables it
        return written

    def release(self) -> None:
        """Free the vertex array."""
        self._pass.release()


def _reached(part: Rect, region: Rect, place: Rect, reach: int) -> Rect:
    """Return the rectangle of the target that a changed part affects, within the filter's radius [px]."""
    spans = []
    for axis in (0, 1):
        scale = place[axis + 2] / region[axis + 2]
        low = math.floor((part[axis] - region[axis] - reach) * scale)
        high = math.ceil((part[axis] - region[axis] + part[axis + 2] + reach) * scale)
        low, high = max(low, 0), min(high, place[axis + 2])
        spans.append((place[axis] + low, high - low))
    return spans[0][0], spans[1][0], spans[0][1], spans[1][1]
