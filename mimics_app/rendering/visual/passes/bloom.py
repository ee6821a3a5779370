"""Bloom: a share of the light is spread, as by an eye or a lens, through a pyramid of half-size copies."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from typing import TYPE_CHECKING

from mimics_app.rendering.visual.draw_buffer import texture_of
from mimics_app.rendering.visual.materials.shader_library import ShaderLibrary
from mimics_app.rendering.visual.passes.screen import ScreenPass
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.surfaces.surface import Size
from mimics_app.rendering.visual.view import Rect

if TYPE_CHECKING:
    import moderngl

__all__ = ["BloomPass"]

_LEVELS = 6
_SMALLEST = 4
"""Minimum width and height of a copy [texels]."""

_WIDER = 0.8
"""Share of each level that comes from the coarser ones."""

_BINDING = 21


class BloomPass:
    """Mixes the picture with a wide blur of its light: without threshold, energy-preserving except at the border.

    The picture holds display values as half floats; the tone map is inverted for the blur, which is of linear light.
    Copies are made per view and clamped at its borders, so that adjacent views do not mix.

    Attributes:
        settings: Settings of the frame; `bloom` is the share of the light that is spread.
    """

    def __init__(self, ctx: moderngl.Context, shaders: ShaderLibrary, settings: RenderSettings) -> None:
        self.settings = settings
        self._ctx = ctx
        self._first = ScreenPass(ctx, shaders, "post/downsample.frag", ("FROM_DISPLAY",))
        self._downsample = ScreenPass(ctx, shaders, "post/downsample.frag")
        self._upsample = ScreenPass(ctx, shaders, "post/upsample.frag")
        self._mix = ScreenPass(ctx, shaders, "post/bloom.frag")
        self._levels: dict[Size, list[moderngl.Framebuffer]] = {}

    def draw(
        self, source: moderngl.Texture, target: moderngl.Framebuffer, regions: Sequence[Rect], places: Sequence[Rect]
    ) -> int:
        """Fill a target; arguments of `PictureFilter.draw`."""
        self._drop_unused(regions)
        neutral = float(self.settings.tone_map == "neutral")
        draws = 0
        for region, place in zip(regions, places, strict=True):
            levels = self._copies(region[2:])
            draws += self._blur(source, region, levels, neutral)
            texture_of(levels[0]).use(_BINDING)
            target.use()
            draws += self._mix.draw(source, region, place, share=self.settings.bloom, neutral=neutral)
        return draws

    def release(self) -> None:
        """Free copies and vertex arrays."""
        for part in (self._first, self._downsample, self._upsample, self._mix):
            part.release()
        for size in list(self._levels):
            self._free(size)

    def _blur(self, source: moderngl.Texture, region: Rect, levels: list[moderngl.Framebuffer], neutral: float) -> int:
        """Fill the pyramid: downsample by means of 4 x 4 texels, upsample and blend by a tent filter."""
        levels[0].use()
        draws = self._first.draw(source, region, _whole(levels[0]), neutral=neutral)
        for finer, wider in itertools.pairwise(levels):
            wider.use()
            draws += self._downsample.draw(texture_of(finer), _whole(finer), _whole(wider))
        for finer, wider in reversed(list(itertools.pairwise(levels))):
            finer.use()
            draws += self._upsample.draw(texture_of(wider), _whole(wider), _whole(finer), blend=True, share=_WIDER)
        return draws

    def _copies(self, size: Size) -> list[moderngl.Framebuffer]:
        if size not in self._levels:
            levels: list[moderngl.Framebuffer] = []
            width, height = size
            while not levels or (len(levels) < _LEVELS and min(width, height) >= 2 * _SMALLEST):
                width, height = (width + 1) // 2, (height + 1) // 2
                texture = self._ctx.texture((width, height), 4, dtype="f2")
                texture.repeat_x = texture.repeat_y = False
                levels.append(self._ctx.framebuffer([texture]))
            self._levels[size] = levels
        return self._levels[size]

    def _drop_unused(self, regions: Sequence[Rect]) -> None:
        wanted = {region[2:] for region in regions}
        for size in [size for size in self._levels if size not in wanted]:
            self._free(size)

    def _free(self, size: Size) -> None:
        for level in self._levels.pop(size):
            texture = texture_of(level)
            level.release()
            texture.release()


def _whole(framebuffer: moderngl.Framebuffer) -> Rect:
    return (0, 0, *framebuffer.size)
