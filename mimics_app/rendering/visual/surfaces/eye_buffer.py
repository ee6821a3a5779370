"""Offscreen target for the pictures of all eyes of a display, before composition."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.rendering.visual.surfaces.surface import Size, Surface

if TYPE_CHECKING:
    import moderngl

__all__ = ["EyeBuffer"]


class EyeBuffer(Surface):
    """A surface in the context of another one, read as a texture.

    Args:
        owner: Surface that owns the context; closed and renewed by the caller.
        size: Width and height [px].
    """

    def __init__(self, owner: Surface, size: Size) -> None:
        self._owner = owner
        super().__init__(owner.backend, owner.ctx, size)
        self.reset_status = owner.reset_status

    @property
    def texture(self) -> moderngl.Texture:
        """The picture."""
        return self.framebuffer.color_attachments[0]  # type: ignore[return-value]  # made with a texture

    def renew(self) -> None:
        self._take(self._owner.ctx)
        self.reset_status = self._owner.reset_status

    def close(self) -> None:
        """Do nothing: its objects are freed with the owner's context."""

    def _make_framebuffer(self, size: Size) -> moderngl.Framebuffer:
        # RGBA, not BGRA as other pictures: a headset's runtime copies it byte by byte.
        texture = self.ctx.texture(size, 4)
        texture.repeat_x = texture.repeat_y = False
        return self.ctx.framebuffer([texture], self.ctx.depth_renderbuffer(size))
