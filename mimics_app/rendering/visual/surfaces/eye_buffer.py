"""A picture of another size and shape than the surface it belongs to: all eyes of a display, before they are shown."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.rendering.visual.surfaces.surface import Size, Surface

if TYPE_CHECKING:
    import moderngl

__all__ = ["EyeBuffer"]


class EyeBuffer(Surface):
    """Drawn into like any surface, in the context of another, and read as a texture.

    Args:
        owner: Whose context it lives in; closed and renewed by whoever has it.
        size: [px].
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
        """Nothing of its own is left when its owner's context goes."""

    def _make_framebuffer(self, size: Size) -> moderngl.Framebuffer:
        texture = self.ctx.texture(size, 4)
        texture.repeat_x = texture.repeat_y = False
        return self.ctx.framebuffer([texture], self.ctx.depth_renderbuffer(size))
