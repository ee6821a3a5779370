"""An offscreen render target whose colours are read as a texture afterwards."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from mimics_app.rendering.visual.surfaces.picture_texture import make_picture_texture
from mimics_app.rendering.visual.surfaces.raw_gl import SRGB8_ALPHA8, RawGL
from mimics_app.rendering.visual.surfaces.surface import Size, release_framebuffer

if TYPE_CHECKING:
    import moderngl

__all__ = ["DrawBuffer", "texture_of"]


class DrawBuffer:
    """An offscreen render target: a colour texture, multisampled until it is resolved, and depth.

    Args:
        ctx: Context that owns it.
        size: Width and height [px].
        samples: Samples per pixel; 0: not multisampled.
        dtype: "f1" for 8 bits, "f2" for half floats.
        srgb: True for a texture whose sampler decodes the display values to linear light.

    Attributes:
        size: Width and height [px].
        samples: Samples per pixel.
        texture: The resolved colours.
        framebuffer: Framebuffer to draw into.
    """

    def __init__(
        self, ctx: moderngl.Context, size: Size, samples: int, dtype: str = "f1", *, srgb: bool = False
    ) -> None:
        self._ctx, self._gl = ctx, RawGL(ctx)
        self.size, self.samples = size, samples
        self.texture = _make_texture(ctx, size, dtype, srgb)
        depth = ctx.depth_renderbuffer(size, samples=samples)
        drawn = ctx.renderbuffer(size, 4, samples=samples, dtype=dtype) if samples else self.texture
        self.framebuffer = ctx.framebuffer([drawn], depth)
        # Framebuffers without depth: copying resolves every attachment both sides have, and depth is not wanted.
        self._copy = (ctx.framebuffer([self.texture]), ctx.framebuffer([drawn])) if samples else ()

    @property
    def finished(self) -> moderngl.Framebuffer:
        """Framebuffer whose colour attachment is the texture."""
        return self._copy[0] if self._copy else self.framebuffer

    def finish(self, places: Sequence[tuple[int, int, int, int]] | None = None) -> None:
        """Resolve the samples into the texture, in some rectangles [px] or everywhere."""
        if self._copy and places is None:
            self._ctx.copy_framebuffer(*self._copy)
        elif self._copy and places:
            self._gl.copy_colours(self._copy[1], self._copy[0], places)

    def release(self) -> None:
        """Free textures, renderbuffers and framebuffers."""
        for framebuffer in self._copy:
            framebuffer.release()
        release_framebuffer(self.framebuffer)
        if self.samples:
            self.texture.release()


def _make_texture(ctx: moderngl.Context, size: Size, dtype: str, srgb: bool) -> moderngl.Texture:
    if dtype == "f1" and not srgb:
        return make_picture_texture(ctx, size)
    texture = ctx.texture(size, 4, dtype=dtype, internal_format=SRGB8_ALPHA8 if srgb else None)
    texture.repeat_x = texture.repeat_y = False
    return texture


def texture_of(framebuffer: moderngl.Framebuffer) -> moderngl.Texture:
    """Return the first colour attachment of a framebuffer that was made with a texture."""
    return framebuffer.color_attachments[0]  # type: ignore[return-value]  # no renderbuffer
