"""The texture that shadow maps are drawn into, one tile each."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import moderngl

__all__ = ["ShadowTarget"]


class ShadowTarget:
    """A square depth texture.

    Attributes:
        size: Texels along a side.
    """

    _BINDING = 1

    def __init__(self, ctx: moderngl.Context, size: int) -> None:
        import moderngl

        self.size = size
        self._texture = ctx.depth_texture((max(size, 1),) * 2)
        self._texture.compare_func = ""
        self._texture.filter = (moderngl.NEAREST, moderngl.NEAREST)
        self._texture.repeat_x = self._texture.repeat_y = False
        self._framebuffer = ctx.framebuffer(depth_attachment=self._texture)
        self._framebuffer.clear(depth=1.0)

    def begin(self) -> None:
        """Draw into it from here on."""
        self._framebuffer.use()

    def enter(self, tile: tuple[int, int], grid: int) -> None:
        """Empty one of grid x grid tiles, and draw into it from here on."""
        width = self.size // grid
        rectangle = (tile[0] * width, tile[1] * width, width, width)
        self._framebuffer.viewport = rectangle
        self._framebuffer.clear(depth=1.0, viewport=rectangle)

    def bind(self, binding: int = _BINDING) -> None:
        """Make it what shaders read: surfaces as their map, or others as a picture."""
        self._texture.use(binding)

    def release(self) -> None:
        """Free the texture."""
        self._framebuffer.release()
        self._texture.release()
