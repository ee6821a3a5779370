"""Filters of the finished picture: of its edges, and of its size."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from mimics_app.rendering.visual.changed_part import ChangedPart
from mimics_app.rendering.visual.materials.shader_library import ShaderLibrary
from mimics_app.rendering.visual.passes.screen import ScreenPass
from mimics_app.rendering.visual.view import Rect

if TYPE_CHECKING:
    import moderngl

__all__ = ["EdgeFilter", "Enlargement", "PictureFilter"]

_EDGE_STEPS, _EDGE_REACH = 12.0, 28
"""Steps in which an edge is followed in each direction, 26 pixels; and how far a pixel affects others [px]."""

Parts = Sequence[ChangedPart]


@dataclass(frozen=True, slots=True)
class _Shown:
    """A region of a picture [texels], and the rectangle that it fills in the target [px]."""

    source: moderngl.Texture
    region: Rect
    place: Rect


class PictureFilter(ABC):
    """Filters each view's region of a picture.

    Args:
        passes: Its passes, released with it.
    """

    def __init__(self, *passes: ScreenPass) -> None:
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
        return sum(self._fill(_Shown(source, *pair), target, exact=exact) for pair in each)

    def draw_parts(
        self,
        source: moderngl.Texture,
        target: moderngl.Framebuffer,
        region: Rect,
        place: Rect,
        parts: Parts,
    ) -> tuple[int, list[ChangedPart]]:
        """Update a target that holds the filtered last picture of a view.

        Args:
            source: The picture.
            target: Framebuffer to update.
            region: Region of the view in the picture [texels].
            place: Rectangle of the view in the target [px].
            parts: Parts of the picture that changed.

        Returns:
            Draw calls made, and the parts of the target that were written.
        """
        target.use()
        shown = _Shown(source, region, place)
        written = [self._reached(part, shown) for part in parts]
        draws = self._update(shown, target, parts, written)
        target.scissor = None  # type: ignore[assignment]  # disables it
        return draws, written

    def release(self) -> None:
        """Free the vertex arrays."""
        for each in self._passes:
            each.release()

    @abstractmethod
    def _fill(self, shown: _Shown, target: moderngl.Framebuffer, *, exact: bool) -> int:
        """Fill a rectangle of the target in use; return the draw calls."""

    @abstractmethod
    def _reached(self, part: ChangedPart, shown: _Shown) -> ChangedPart:
        """Return the part of the target that a changed part affects."""

    @abstractmethod
    def _update(self, shown: _Shown, target: moderngl.Framebuffer, parts: Parts, written: Parts) -> int:
        """Update parts of the target in use, its scissor rectangle included; return the draw calls."""


class EdgeFilter(PictureFilter):
    """Anti-aliasing of a picture's edges; its targets need depth, which marks the pixels beside edges."""

    def __init__(self, ctx: moderngl.Context, shaders: ShaderLibrary) -> None:
        self._ctx = ctx
        self._find = ScreenPass(ctx, shaders, "post/edges.frag", ("FIND",))
        self._smooth = ScreenPass(ctx, shaders, "post/edges.frag")
        super().__init__(self._find, self._smooth)

    def _fill(self, shown: _Shown, target: moderngl.Framebuffer, *, exact: bool) -> int:
        target.depth_mask = True
        return self._mark(shown, target, [None]) + self._blend(shown, target, [None])

    def _reached(self, part: ChangedPart, shown: _Shown) -> ChangedPart:
        reached = _reached(part.rectangle, shown, _EDGE_REACH)
        pieces = [_reached(piece, shown, 0) for piece in part.pieces]
        return ChangedPart(reached, [wing for piece in pieces for wing in _cross(piece, reached)])

    def _update(self, shown: _Shown, target: moderngl.Framebuffer, parts: Parts, written: Parts) -> int:
        """Find edges in what changed; elsewhere the target's depth has those of the last picture."""
        target.depth_mask = True
        changed = [_reached(piece, shown, 0) for part in parts for piece in part.pieces]
        draws = self._mark(shown, target, changed)
        return draws + self._blend(shown, target, [piece for part in written for piece in part.pieces])

    def _mark(self, shown: _Shown, target: moderngl.Framebuffer, within: Sequence[Rect | None]) -> int:
        """Copy the picture and mark the pixels beside edges, within scissor rectangles."""
        self._ctx.depth_func = "1"  # always
        draws = self._find.draw(shown.source, shown.region, shown.place, within=within, depth=True)
        self._ctx.depth_func = "<"
        return draws

    def _blend(self, shown: _Shown, target: moderngl.Framebuffer, within: Sequence[Rect | None]) -> int:
        """Filter the marked pixels within scissor rectangles; the marks stay."""
        target.depth_mask = False
        where = (shown.source, shown.region, shown.place)
        draws = self._smooth.draw(*where, within=within, depth=True, steps=_EDGE_STEPS)
        target.depth_mask = True
        return draws


class Enlargement(PictureFilter):
    """Bilinear scaling.

    A single view fills its picture: a variant of the shader for it is faster with llvmpipe, and rounds in another way.
    """

    def __init__(self, ctx: moderngl.Context, shaders: ShaderLibrary) -> None:
        self._exact = ScreenPass(ctx, shaders, "post/resample.frag")
        self._fast = ScreenPass(ctx, shaders, "post/resample.frag", ("WHOLE",))
        self._rehearsed = False
        super().__init__(self._exact, self._fast)

    def _fill(self, shown: _Shown, target: moderngl.Framebuffer, *, exact: bool) -> int:
        if exact or shown.region != (0, 0, *shown.source.size):
            return self._exact.draw(shown.source, shown.region, shown.place)
        if not self._rehearsed:  # nothing is left to compile when the view comes to rest
            self._exact.draw(shown.source, shown.region, shown.place)
            self._rehearsed = True
        return self._fast.draw(shown.source, shown.region, shown.place)

    def _reached(self, part: ChangedPart, shown: _Shown) -> ChangedPart:
        reached = [_reached(each, shown, 1) for each in (part.rectangle, *part.pieces)]
        return ChangedPart(reached[0], reached[1:])

    def _update(self, shown: _Shown, target: moderngl.Framebuffer, parts: Parts, written: Parts) -> int:
        within = [piece for part in written for piece in part.pieces]
        return self._exact.draw(shown.source, shown.region, shown.place, within=within)


def _reached(part: Rect, shown: _Shown, reach: int) -> Rect:
    """Return the rectangle of the target that a changed part affects, within the filter's radius [px]."""
    region, place, spans = shown.region, shown.place, []
    for axis in (0, 1):
        scale = place[axis + 2] / region[axis + 2]
        low = math.floor((part[axis] - region[axis] - reach) * scale)
        high = math.ceil((part[axis] - region[axis] + part[axis + 2] + reach) * scale)
        low, high = max(low, 0), min(high, place[axis + 2])
        spans.append((place[axis] + low, high - low))
    return spans[0][0], spans[1][0], spans[0][1], spans[1][1]


def _cross(piece: Rect, around: Rect) -> list[Rect]:
    """Return the pixels whose edges may pass a piece, which are beside it or above or below it [px].

    Args:
        piece: The piece.
        around: A rectangle around all of them.
    """
    x, y, width, height = piece
    left, bottom = max(around[0], x - _EDGE_REACH), max(around[1], y - _EDGE_REACH)
    right = min(around[0] + around[2], x + width + _EDGE_REACH)
    top = min(around[1] + around[3], y + height + _EDGE_REACH)
    above = (x, y + height, width, top - y - height)
    return [(left, y, right - left, height), (x, bottom, width, y - bottom), above]
