"""Filters of the finished picture: of its edges, and of its size."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import TYPE_CHECKING

from mimics_app.rendering.visual.materials.shader_library import ShaderLibrary
from mimics_app.rendering.visual.passes.screen import ScreenPass
from mimics_app.rendering.visual.view import Rect

if TYPE_CHECKING:
    import moderngl

__all__ = ["EdgeFilter", "Enlargement", "PictureFilter"]

_EDGE_STEPS = 12.0
"""Steps in which an edge is followed in each direction: 26 pixels."""


class PictureFilter(ABC):
    """Filters each view's region of a picture.

    Args:
        reach: Radius of the filter [texels].
        passes: Its passes, released with it.
    """

    def __init__(self, reach: int, *passes: ScreenPass) -> None:
        self._reach = reach
        self._passes = passes

    def draw(
        self,
        source: moderngl.Texture,
        target: moderngl.Framebuffer,
        regions: Sequence[Rect],
        places: Sequence[Rect],
        *,
        exact: bool = False,
    ) -> int:
        """Fill a target.

        Args:
            source: The picture.
            target: Framebuffer to fill.
            regions: Region of each view in the picture [texels].
            places: Rectangle of each view in the target [px].
            exact: True for the same pixels as by `draw_parts`.

        Returns:
            Draw calls made.
        """
        target.use()
        each = zip(regions, places, strict=True)
        return sum(self._fill(source, target, region, place, exact=exact) for region, place in each)

    def draw_parts(
        self,
        source: moderngl.Texture,
        target: moderngl.Framebuffer,
        region: Rect,
        place: Rect,
        parts: Sequence[Rect],
    ) -> list[Rect]:
        """Update a target that holds the filtered last picture of a view.

        Args:
            source: The picture.
            target: Framebuffer to update.
            region: Region of the view in the picture [texels].
            place: Rectangle of the view in the target [px].
            parts: Rectangles of the picture that changed [texels].

        Returns:
            Rectangles of the target that were written, one per part [px].
        """
        written = [_reached(part, region, place, self._reach) for part in parts]
        for each in written:
            target.scissor = each
            self.draw(source, target, [region], [place], exact=True)
        target.scissor = None  # type: ignore[assignment]  # None disables it
        return written

    def release(self) -> None:
        """Free the vertex arrays."""
        for each in self._passes:
            each.release()

    @abstractmethod
    def _fill(
        self, source: moderngl.Texture, target: moderngl.Framebuffer, region: Rect, place: Rect, *, exact: bool
    ) -> int:
        """Fill a rectangle of the target in use; return the draw calls."""


class EdgeFilter(PictureFilter):
    """Anti-aliasing of a picture's edges; its targets need depth, which marks the pixels beside edges."""

    def __init__(self, ctx: moderngl.Context, shaders: ShaderLibrary) -> None:
        self._ctx = ctx
        self._find = ScreenPass(ctx, shaders, "post/edges.frag", ("FIND",))
        self._smooth = ScreenPass(ctx, shaders, "post/edges.frag")
        super().__init__(28, self._find, self._smooth)

    def _fill(
        self, source: moderngl.Texture, target: moderngl.Framebuffer, region: Rect, place: Rect, *, exact: bool
    ) -> int:
        target.depth_mask = True
        self._ctx.depth_func = "1"  # always
        draws = self._find.draw(source, region, place, depth=True)
        self._ctx.depth_func = "<"
        return draws + self._smooth.draw(source, region, place, depth=True, steps=_EDGE_STEPS)


class Enlargement(PictureFilter):
    """Bilinear scaling.

    A single view fills its picture: a variant of the shader for it is faster with llvmpipe, and rounds in another way.
    """

    def __init__(self, ctx: moderngl.Context, shaders: ShaderLibrary) -> None:
        self._exact = ScreenPass(ctx, shaders, "post/resample.frag")
        self._fast = ScreenPass(ctx, shaders, "post/resample.frag", ("WHOLE",))
        self._rehearsed = False
        super().__init__(1, self._exact, self._fast)

    def _fill(
        self, source: moderngl.Texture, target: moderngl.Framebuffer, region: Rect, place: Rect, *, exact: bool
    ) -> int:
        if exact or region != (0, 0, *source.size):
            return self._exact.draw(source, region, place)
        if not self._rehearsed:  # nothing is left to compile when the view comes to rest
            self._exact.draw(source, region, place)
            self._rehearsed = True
        return self._fast.draw(source, region, place)


def _reached(part: Rect, region: Rect, place: Rect, reach: int) -> Rect:
    """Return the rectangle of the target that a changed part affects, within the filter's radius [px]."""
    spans = []
    for axis in (0, 1):
        scale = place[axis + 2] / region[axis + 2]
        low = math.floor((part[axis] - region[axis] - reach) * scale)
        high = math.ceil((part[axis] - region[axis] + part[axis + 2] + reach) * scale)
        low, high = max(low, 0), min(high, place[axis + 2])
        spans.append((place[axis] + low, high - low))
    return spans[0][0], spans[1][0], spans[0][1], spans[1][1]
