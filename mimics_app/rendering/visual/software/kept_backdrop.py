"""What lies behind the sprites that change, kept from frame to frame."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from mimics_app.rendering.visual.backdrop import Backdrop
from mimics_app.rendering.visual.draw_buffer import DrawBuffer

if TYPE_CHECKING:
    import moderngl

__all__ = ["KeptBackdrop"]


class KeptBackdrop(Backdrop):
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
        self._sprites = self._sprites if same else None
        return same

    def use(self, sprites: bytes) -> bool:
        self.kept = self._sprites == sprites
        self._sprites = sprites
        return self.kept

    def draw(self, target: moderngl.Framebuffer, draw: Callable[[], int]) -> int:
        if self.kept and self._buffer is not None:
            self._ctx.copy_framebuffer(target, self._buffer.framebuffer)
            return 0
        draws = draw()
        self._keep(target)
        return draws

    def _keep(self, target: moderngl.Framebuffer) -> None:
        drawn = target.color_attachments[0]
        if self._buffer is None or (self._buffer.size, self._buffer.samples) != (target.size, drawn.samples):
            self.release()
            self._buffer = DrawBuffer(self._ctx, target.size, drawn.samples, drawn.dtype)
        self._ctx.copy_framebuffer(self._buffer.framebuffer, target)

    def release(self) -> None:
        if self._buffer is not None:
            self._buffer.release()
            self._buffer = None
