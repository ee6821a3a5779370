"""The render target of a frame before it reaches the surface."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from mimics_app.rendering.visual.changed_part import ChangedPart
from mimics_app.rendering.visual.draw_buffer import DrawBuffer, texture_of
from mimics_app.rendering.visual.materials.shader_library import FEW_PIXELS, ShaderLibrary
from mimics_app.rendering.visual.passes.bloom import BloomPass
from mimics_app.rendering.visual.passes.picture_filters import EdgeFilter, Enlargement, PictureFilter
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.surfaces.picture_texture import make_picture_texture
from mimics_app.rendering.visual.surfaces.surface import Size, Surface, release_framebuffer
from mimics_app.rendering.visual.view import Rect

if TYPE_CHECKING:
    import moderngl

__all__ = ["PictureTarget"]

_CARRIED_FROM = 200_000
"""Pixels of a surface from which on vertices carry uniforms to them: in smaller pictures the vertices are the cost."""


class PictureTarget:
    """Target of the world's picture: the surface's framebuffer, a multisampled one, or a buffer to be filtered.

    Attributes:
        keep: True to draw into a buffer of its own that the next frame finds unchanged.
        holds: True while that buffer has the last frame's world; set by the renderer.

    Args:
        board_within: True to draw the heads-up display into a kept multisampled buffer, too, so that its edges are
            smoothed as in a picture that is not kept.
    """

    def __init__(
        self, surface: Surface, shaders: ShaderLibrary, settings: RenderSettings, *, board_within: bool = False
    ) -> None:
        self.keep = self.holds = False
        self._board_within = board_within
        self._surface = surface
        self._most_samples = surface.ctx.max_samples
        self._bloom = BloomPass(surface.ctx, shaders, settings)
        self._edges = EdgeFilter(surface.ctx, shaders)
        self._enlarge = Enlargement(surface.ctx, shaders)
        self._made_for: object = None
        self._multisampled: moderngl.Framebuffer | None = None
        # The surface without depth: a copy resolves every attachment that both framebuffers have, and llvmpipe scales
        # in integers only where there is no depth.
        self._shown: moderngl.Framebuffer | None = None
        self._buffer: DrawBuffer | None = None
        self._between: list[moderngl.Framebuffer] = []
        # Output of the last filter while frames are kept: the heads-up display is drawn over the surface.
        self._filtered: moderngl.Framebuffer | None = None
        self.settings = settings

    @property
    def settings(self) -> RenderSettings:
        """Settings of the frame: samples, scale and filters."""
        return self._settings

    @settings.setter
    def settings(self, settings: RenderSettings) -> None:
        wanted = (
            (settings.bloom > 0.0, self._bloom),
            (settings.fxaa, self._edges),
            (settings.scale < 1.0, self._enlarge),
        )
        self._settings = settings
        # In order; the last one draws onto the surface.
        self._filters: list[BloomPass | PictureFilter] = [step for applies, step in wanted if applies]

    @property
    def samples(self) -> int:
        """Samples per pixel in use: as requested, at most the driver's maximum."""
        return min(self.settings.msaa, self._most_samples)

    @property
    def filtered(self) -> bool:
        """Whether the world is drawn into another framebuffer than the surface's own."""
        return self.keep or bool(self._filters)

    @property
    def takes_board(self) -> bool:
        """Whether the heads-up display is drawn into the world's framebuffer."""
        kept_with_board = self._board_within and self.samples > 0 and not self._filters
        return kept_with_board or not self.filtered

    @property
    def size(self) -> Size:
        """Size of the picture as drawn [px]."""
        (width, height), scale = self._surface.size, self.settings.scale
        return max(1, round(width * scale)), max(1, round(height * scale))

    @property
    def features(self) -> frozenset[str]:
        """Shader features by the surface's size, not by that of the picture: a governor's step compiles nothing."""
        return frozenset({FEW_PIXELS} if math.prod(self._surface.size) < _CARRIED_FROM else ())

    def rectangle(self, of_surface: Rect) -> Rect:
        """Map a rectangle of the surface to the picture as drawn [px]; adjacent ones stay adjacent."""
        x, y, width, height = of_surface
        (wide, high), (full_wide, full_high) = self.size, self._surface.size
        left, right = round(x * wide / full_wide), round((x + width) * wide / full_wide)
        bottom, top = round(y * high / full_high), round((y + height) * high / full_high)
        return left, bottom, max(1, right - left), max(1, top - bottom)

    def begin(self) -> moderngl.Framebuffer:
        """Return the framebuffer to draw into, for the surface's present size and the present settings."""
        self._bloom.settings = self.settings
        filters = (self.settings.bloom > 0.0, self._filters, self.keep)
        wanted = (self.size, self._surface.framebuffer, self.samples, *filters)
        if self._made_for != wanted:
            self.holds = False
            self._free()
            self._make()
            self._made_for = wanted
        drawn = self._buffer.framebuffer if self._buffer else self._multisampled
        return drawn or self._surface.framebuffer

    def finish(
        self, rectangles: Sequence[Rect], parts: Sequence[ChangedPart] | None = None
    ) -> tuple[int, Sequence[ChangedPart] | None]:
        """Resolve the picture and filter it.

        Args:
            rectangles: Rectangles of the views on the surface [px].
            parts: Parts that were redrawn; None: all of it.

        Returns:
            Draw calls made, and the parts of `finished` that were written; None: all of it.
        """
        draws, surface = 0, self._surface
        if self._buffer is not None and self._shown is not None:
            self._buffer.finish(None if parts is None else [piece for part in parts for piece in part.pieces])
            if (filters := self._filters) and not (self._filtered and parts == []):
                own = surface.framebuffer if filters[-1] is self._edges else self._shown
                # A light's bloom reaches beyond the parts.
                changed = parts if self._filtered and self._bloom not in filters else None
                draws, parts = self._filter(self._buffer.texture, self._filtered or own, rectangles, changed)
        return draws, parts

    @property
    def finished(self) -> moderngl.Framebuffer | None:
        """Framebuffer with the finished picture; None where that is the surface's already."""
        if self._filters:
            return self._filtered
        return self._buffer.finished if self._buffer else self._multisampled

    def show(self, finished: moderngl.Framebuffer | None) -> None:
        """Copy a finished picture to the surface's framebuffer, and use that."""
        if self._shown is not None and finished is not None:
            self._surface.ctx.copy_framebuffer(self._shown, finished)
        self._surface.framebuffer.use()

    def _filter(
        self,
        picture: moderngl.Texture,
        target: moderngl.Framebuffer,
        rectangles: Sequence[Rect],
        parts: Sequence[ChangedPart] | None,
    ) -> tuple[int, Sequence[ChangedPart] | None]:
        """Draw a filtered picture into a target; only in parts where the target holds the last frame's.

        Returns:
            Draw calls made, and the parts that were written; None: all of it.
        """
        drawn = [self.rectangle(each) for each in rectangles]
        if parts is None and sum(width * height for _, _, width, height in rectangles) < math.prod(self._surface.size):
            target.clear(alpha=1.0)
        draws, places = 0, [*([drawn] * len(self._between)), rectangles]
        for step, into, where in zip(self._filters, [*self._between, target], places, strict=True):
            if isinstance(step, BloomPass):
                draws += step.draw(picture, into, drawn, where)
            elif parts is None:
                draws += step.draw(picture, into, drawn, where, exact=target is self._filtered)
            else:
                calls, parts = step.draw_parts(picture, into, drawn[0], where[0], parts)
                draws += calls
            picture = texture_of(into)
        return draws, parts

    def release(self) -> None:
        """Free buffers and filters."""
        self._free()
        for step in (self._bloom, self._edges, self._enlarge):
            step.release()

    def _make(self) -> None:
        ctx, size, samples = self._surface.ctx, self.size, self.samples
        if self.filtered:
            self._buffer = DrawBuffer(ctx, size, samples, "f2" if self.settings.bloom > 0.0 else "f1")
            self._between = [self._make_target(step, size) for step in self._filters[:-1]]
            if self.keep and self._filters:
                self._filtered = self._make_target(self._filters[-1], self._surface.size)
        elif samples:
            colour = ctx.renderbuffer(size, 4, samples=samples)
            self._multisampled = ctx.framebuffer([colour], ctx.depth_renderbuffer(size, samples=samples))
        if self.filtered or samples:
            self._shown = ctx.framebuffer([self._surface.framebuffer.color_attachments[0]])

    def _make_target(self, step: BloomPass | PictureFilter, size: Size) -> moderngl.Framebuffer:
        """Return a framebuffer for the output of a filter."""
        ctx = self._surface.ctx
        depth = ctx.depth_renderbuffer(size) if step is self._edges else None
        return ctx.framebuffer([make_picture_texture(ctx, size)], depth)

    def _free(self) -> None:
        for own in (*self._between, self._multisampled, self._filtered):
            if own is not None:
                release_framebuffer(own)
        if self._buffer is not None:
            self._buffer.release()
        if self._shown is not None:
            self._shown.release()
        self._between, self._multisampled, self._shown = [], None, None
        self._buffer, self._filtered, self._made_for = None, None, None
