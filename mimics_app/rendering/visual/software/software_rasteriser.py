"""What is done in software: the members that the renderer's classes have there."""

from __future__ import annotations

import ctypes
import sys
from collections.abc import Callable
from typing import TYPE_CHECKING, TypeVar, cast

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import F8
from mimics_app.rendering.visual.backdrop import Backdrop
from mimics_app.rendering.visual.draw_buffer import DrawBuffer
from mimics_app.rendering.visual.drawing.draw_feed import DrawFeed
from mimics_app.rendering.visual.drawing.state_choice import StateChoice
from mimics_app.rendering.visual.drawing.triangle_lists import TriangleLists
from mimics_app.rendering.visual.effects.far_sprites import FarSprites
from mimics_app.rendering.visual.kernels.particles import SPRITE
from mimics_app.rendering.visual.kernels.sprites import LEVEL, UPRIGHT
from mimics_app.rendering.visual.materials.shader_source import PixelInputs
from mimics_app.rendering.visual.shadows.shadow_layers import ShadowLayers, SunBox
from mimics_app.rendering.visual.software.batched_feed import BatchedFeed
from mimics_app.rendering.visual.software.carried_uniforms import CarriedUniforms
from mimics_app.rendering.visual.software.kept_board import KeptBoard
from mimics_app.rendering.visual.software.partial_redraw import PartialRedraw
from mimics_app.rendering.visual.software.raster_threads import RasterThreads
from mimics_app.rendering.visual.software.reversed_copy import ReversedCopy
from mimics_app.rendering.visual.software.seen_triangles import SeenTriangles, SmallTriangles
from mimics_app.rendering.visual.software.still_layers import SteadyBox, StillLayers
from mimics_app.rendering.visual.stages.board_copy import BoardCopy
from mimics_app.rendering.visual.stages.redraw import Redraw
from mimics_app.rendering.visual.surfaces.driver_threads import DriverThreads
from mimics_app.rendering.visual.surfaces.rasteriser import Rasteriser
from mimics_app.rendering.visual.surfaces.window_copy import WindowCopy

if TYPE_CHECKING:
    import moderngl

__all__ = ["KeptBackdrop", "SoftwareRasteriser"]


_PERIOD = 60
"""Frames after which a distance is forgotten, at the earliest."""


class RestingSprites(FarSprites):
    """Counts the blended billboards at rest that are behind all sprites that change or have a mask.

    What is farther than all of something is behind it at every pixel, and is blended before it.
    """

    def __init__(self) -> None:
        self._before, self._rest = np.zeros(0, SPRITE), np.zeros(0, np.bool_)
        self._farthest = [0.0, 0.0]
        self._frames = 0

    def follow(self, billboards: NDArray[np.void]) -> None:
        alike = len(self._before) == len(billboards)
        self._rest = self._before == billboards if alike else np.zeros(len(billboards), np.bool_)
        self._before = billboards.copy()

    def rest(self) -> None:
        self._rest[:] = True

    def count(self, sprites: NDArray[np.void], numbers: NDArray[np.int32], solid: int, eye: F8, away: F8) -> int:
        seen, at_rest = sprites[numbers], np.zeros(len(sprites), np.bool_)
        at_rest[: len(self._rest)] = self._rest
        rests = at_rest[numbers]
        rests[:solid] = False
        offset, half = seen["place"] - eye, seen["half"]
        distance = np.linalg.norm(offset, axis=1)
        radius = np.linalg.norm(half, axis=1) + seen["lift"] * half[:, 1]
        least = np.where(seen["facing"] == LEVEL, distance - radius, distance)
        upright = seen["facing"] == UPRIGHT
        least[upright] = np.hypot(offset[upright, 0], offset[upright, 2])
        far = self._far(max((distance + radius)[~rests].max(initial=0.0), away.max(initial=0.0)))
        nearer = np.flatnonzero(~(rests & (least > far))[solid:])
        return int(nearer[0]) if len(nearer) else len(numbers) - solid

    def _far(self, distance: float) -> float:
        """Return the largest distance of at least the last `_PERIOD` frames.

        Otherwise a particle at the far edge of a cloud would change the count whenever it comes and goes.
        """
        if self._frames % _PERIOD == 0:
            self._farthest = [self._farthest[1], distance]
        self._frames += 1
        self._farthest[1] = max(self._farthest[1], distance)
        return max(self._farthest)


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


_TRIM_THRESHOLD, _MMAP_THRESHOLD = -1, -3
"""Parameters of glibc's mallopt."""
_KEPT, _MMAP_FROM = 256 << 20, 32 << 20
"""Freed memory that is kept, and size from which memory is mapped instead, glibc's maximum [bytes]."""


def keep_freed_memory() -> None:
    """Let glibc keep freed memory: a software renderer allocates and frees megabytes with every draw.

    Memory that the system maps again each time costs a page fault every 4 KiB. Other C libraries have no such call.
    """
    mallopt = getattr(ctypes.CDLL(None), "mallopt", None) if sys.platform == "linux" else None
    if mallopt is not None:
        mallopt(_TRIM_THRESHOLD, _KEPT)
        mallopt(_MMAP_THRESHOLD, _MMAP_FROM)


_MEMBERS: dict[type, type] = {
    Backdrop: KeptBackdrop,
    BoardCopy: KeptBoard,
    DrawFeed: BatchedFeed,
    DriverThreads: RasterThreads,
    FarSprites: RestingSprites,
    PixelInputs: CarriedUniforms,
    Redraw: PartialRedraw,
    ShadowLayers: StillLayers,
    StateChoice: SmallTriangles,
    SunBox: SteadyBox,
    TriangleLists: SeenTriangles,
    WindowCopy: ReversedCopy,
}


_Part = TypeVar("_Part")


class SoftwareRasteriser(Rasteriser):
    """llvmpipe and its kind: vertices in the thread that submits, pixels in threads of the driver's own.

    Args:
        left_out: Classes that are their own members.
    """

    defers = True
    pays_for_pixels = True

    def __init__(self, left_out: frozenset[type] = frozenset()) -> None:
        self._left_out = left_out
        keep_freed_memory()

    def member(self, part: type[_Part]) -> type[_Part]:
        return part if part in self._left_out else cast("type[_Part]", _MEMBERS.get(part, part))

    @property
    def parts(self) -> tuple[type, ...]:
        return tuple(part for part in _MEMBERS if part not in self._left_out)

    def without(self, *parts: type) -> SoftwareRasteriser:
        return SoftwareRasteriser(self._left_out.union(parts))
