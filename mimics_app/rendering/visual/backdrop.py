"""What lies behind the sprites that change, kept from frame to frame."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.rendering.visual.draw_buffer import DrawBuffer

if TYPE_CHECKING:
    import moderngl

__all__ = ["Backdrop"]


class Backdrop:
    """A copy of a target's colours and depths, made before the sprites that change are drawn over them.

    Attributes:
        kept: True where it need not be drawn in this frame.
    """

    def __init__(self, ctx: moderngl.Context) -> None:
        self._ctx = ctx
        self._buffer: DrawBuffer | None = None
        self._sprites: bytes | None = None
        self.kept = False

    def begin(self, *, same: bool) -> bool:
        """Begin a frame; return `same`: whether nothing but sprites has changed since the last one."""
        self._sprites = self._sprites if same else None
        return same

    def use(self, sprites: bytes) -> bool:
        """Use it in this frame, with some sprites that belong to it; return whether it is kept from another one."""
        self.kept = self._sprites == sprites
        self._sprites = sprites
        return self.kept

    def keep(self, target: moderngl.Framebuffer) -> None:
        """Copy a target; changes the framebuffer in use."""
        drawn = target.color_attachments[0]
        if self._buffer is None or (self._buffer.size, self._buffer.samples) != (target.size, drawn.samples):
            self.release()
            self._buffer = DrawBuffer(self._ctx, target.size, drawn.samples, drawn.dtype)
        self._ctx.copy_framebuffer(self._buffer.framebuffer, target)

    def restore(self, target: moderngl.Framebuffer) -> None:
        """Copy it back; changes the framebuffer in use."""
        assert self._buffer is not None, "it was kept before"
        self._ctx.copy_framebuffer(target, self._buffer.framebuffer)

    def release(self) -> None:
        """Free the copy."""
        if self._buffer is not None:
            self._buffer.release()
            self._buffer = None
