"""The shadow atlas: the depth texture that shadow maps are drawn into, one tile each."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import TYPE_CHECKING

from mimics_app.rendering.visual.surfaces.raw_gl import RawGL
from mimics_app.rendering.visual.view import Rect

if TYPE_CHECKING:
    import moderngl

__all__ = ["ShadowTarget"]


class ShadowTarget:
    """The shadow atlas, a square depth texture.

    Attributes:
        size: Texels along a side.
    """

    _BINDING = 1

    def __init__(self, ctx: moderngl.Context, size: int) -> None:
        import moderngl

        self.size = size
        self._ctx = ctx
        self._texture = self._make()
        self._texture.compare_func = ""
        self._texture.filter = (moderngl.NEAREST, moderngl.NEAREST)
        self._texture.repeat_x = self._texture.repeat_y = False
        self._framebuffer = ctx.framebuffer(depth_attachment=self._texture)
        self._framebuffer.clear(depth=1.0)
        self._over: dict[tuple[int, int], list[Rect]] = {}  # where each tile's kept depths are drawn over [texel]

    def begin(self) -> None:
        """Bind the atlas for drawing."""
        self._framebuffer.use()

    def enter(self, tile: tuple[int, int], grid: int, reach: Sequence[Rect], *, kept: bool) -> None:
        """Select one of grid x grid tiles for drawing, cleared or restored to its kept depths.

        Args:
            tile: Column and row of the tile.
            grid: Tiles along a side.
            reach: Rectangles of the tile in which these are drawn over now, to be restored next time [texel].
            kept: True to restore the kept depths.
        """
        x, y, *_ = rectangle = self._framebuffer.viewport = self._rectangle(tile, grid)
        if kept:
            for place in self._over[tile]:
                self._raw.copy_texels(self._layer, self._texture, place)
        else:
            self._framebuffer.clear(depth=1.0, viewport=rectangle)
        self._over[tile] = [(x + left, y + bottom, width, height) for left, bottom, width, height in reach]

    def keep(self, tile: tuple[int, int], grid: int) -> None:
        """Keep a copy of a tile's present depths."""
        self._raw.copy_texels(self._texture, self._layer, self._rectangle(tile, grid))

    @cached_property
    def _layer(self) -> moderngl.Texture:
        """Copies of the kept depths."""
        return self._make()

    def _make(self) -> moderngl.Texture:
        """Return a texture of depths in single precision, which a software driver samples without converting them."""
        texture = self._ctx.depth_texture((max(self.size, 1),) * 2)
        self._raw.store_as_float(texture)
        return texture

    @cached_property
    def _raw(self) -> RawGL:
        return RawGL(self._ctx)

    def _rectangle(self, tile: tuple[int, int], grid: int) -> Rect:
        width = self.size // grid
        return tile[0] * width, tile[1] * width, width, width

    def bind(self, binding: int = _BINDING) -> None:
        """Bind it as a texture."""
        self._texture.use(binding)

    def release(self) -> None:
        """Free the texture."""
        self._framebuffer.release()
        self._texture.release()
        if "_layer" in self.__dict__:
            self._layer.release()
