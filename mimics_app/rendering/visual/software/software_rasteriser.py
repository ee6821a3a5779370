"""What is done in software: the members that the renderer's classes have there."""

from __future__ import annotations

import ctypes
import sys
from typing import TypeVar, cast

from mimics_app.rendering.visual.backdrop import Backdrop
from mimics_app.rendering.visual.drawing.draw_feed import DrawFeed
from mimics_app.rendering.visual.drawing.state_choice import StateChoice
from mimics_app.rendering.visual.drawing.triangle_lists import TriangleLists
from mimics_app.rendering.visual.effects.far_sprites import FarSprites
from mimics_app.rendering.visual.materials.shader_source import PixelInputs
from mimics_app.rendering.visual.shadows.shadow_layers import ShadowLayers, SunBox
from mimics_app.rendering.visual.software.batched_feed import BatchedFeed
from mimics_app.rendering.visual.software.carried_uniforms import CarriedUniforms
from mimics_app.rendering.visual.software.kept_backdrop import KeptBackdrop
from mimics_app.rendering.visual.software.kept_board import KeptBoard
from mimics_app.rendering.visual.software.partial_redraw import PartialRedraw
from mimics_app.rendering.visual.software.raster_threads import RasterThreads
from mimics_app.rendering.visual.software.resting_sprites import RestingSprites
from mimics_app.rendering.visual.software.reversed_copy import ReversedCopy
from mimics_app.rendering.visual.software.seen_triangles import SeenTriangles, SmallTriangles
from mimics_app.rendering.visual.software.still_layers import SteadyBox, StillLayers
from mimics_app.rendering.visual.stages.board_copy import BoardCopy
from mimics_app.rendering.visual.stages.redraw import Redraw
from mimics_app.rendering.visual.surfaces.driver_threads import DriverThreads
from mimics_app.rendering.visual.surfaces.rasteriser import Rasteriser
from mimics_app.rendering.visual.surfaces.window_copy import WindowCopy

__all__ = ["SoftwareRasteriser"]

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
