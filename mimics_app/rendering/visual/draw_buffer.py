"""A picture off the surface, to be drawn into and read as a texture afterwards."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from mimics_app.rendering.visual.surfaces.raw_gl import SRGB8_ALPHA8, RawGL
from mimics_app.rendering.visual.surfaces.surface import Size, release_framebuffer

if TYPE_CHECKING:
    import moderngl

__all__ = ["DrawBuffer", "texture_of"]


class DrawBuffer:
    """A picture off the surface: a texture, or its multisampled twin until it is finished, and depth.

    Args:
        ctx: Where it lives.
        size: [px].
        samples: Per pixel, 0: one.
        dtype: "f1" for 8 bits, "f2" for half floats.
        srgb: True where a sampler is to decode the display values that are drawn.

    Attributes:
        size: [px].
        samples: Per pixel.
        texture: The finished picture.
        framebuffer: Where to draw.
    """

    def __init__(
        self, ctx: moderngl.Context, size: Size, samples: int, dtype: str = "f1", *, srgb: bool = False
    ) -> None:
        self._ctx = ctx
        self.size, self.samples = size, samples
        self.texture = ctx.texture(size, 4, dtype=dtype, internal_format=SRGB8_ALPHA8 if srgb else None)
        self.texture.repeat_x = self.texture.repeat_y = False
        depth = ctx.depth_renderbuffer(size, samples=samples)
        drawn = ctx.renderbuffer(size, 4, samples=samples, dtype=dtype) if samples else self.texture
        self.framebuffer = ctx.framebuffer([drawn], depth)
        # Framebuffers without depth: copying resolves every attachment both sides have, and depth is not wanted.
        self._copy = (ctx.framebuffer([self.texture]), ctx.framebuffer([drawn])) if samples else ()

    @property
    def finished(self) -> moderngl.Framebuffer:
        """What has the texture as its colours."""
        return self._copy[0] if self._copy else self.framebuffer

    def finish(self, places: Sequence[tuple[int, int, int, int]] | None = None) -> None:
        """Make each pixel of the texture the mean of its samples, in some rectangles [px] or everywhere."""
        if self._copy and places is None:
            self._ctx.copy_framebuffer(*self._copy)
        elif self._copy and places:
            RawGL(self._ctx).copy_colours(self._copy[1], self._copy[0], places)

    def release(self) -> None:
        """Free it."""
        for framebuffer in self._copy:
            framebuffer.release()
        release_framebuffer(self.framebuffer)
        if self.samples:
            self.texture.release()


def texture_of(framebuffer: moderngl.Framebuffer) -> moderngl.Texture:
    """The first texture of a framebuffer that was made with one."""
    return framebuffer.color_attachments[0]  # type: ignore[return-value]  # no renderbuffer
