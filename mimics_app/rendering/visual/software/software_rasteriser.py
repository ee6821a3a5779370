"""What is done in software: the members that the renderer's classes have there."""

from __future__ import annotations

from typing import TypeVar, cast

from mimics_app.rendering.visual.drawing.draw_feed import DrawFeed
from mimics_app.rendering.visual.drawing.state_choice import StateChoice
from mimics_app.rendering.visual.drawing.triangle_lists import TriangleLists
from mimics_app.rendering.visual.materials.shader_source import PixelInputs
from mimics_app.rendering.visual.software.batched_feed import BatchedFeed
from mimics_app.rendering.visual.software.carried_uniforms import CarriedUniforms
from mimics_app.rendering.visual.software.raster_threads import RasterThreads
from mimics_app.rendering.visual.software.reversed_copy import ReversedCopy
from mimics_app.rendering.visual.software.seen_triangles import SeenTriangles
from mimics_app.rendering.visual.software.small_triangles import SmallTriangles
from mimics_app.rendering.visual.surfaces.driver_threads import DriverThreads
from mimics_app.rendering.visual.surfaces.rasteriser import Rasteriser
from mimics_app.rendering.visual.surfaces.window_copy import WindowCopy

__all__ = ["SoftwareRasteriser"]

_MEMBERS: dict[type, type] = {
    DrawFeed: BatchedFeed,
    DriverThreads: RasterThreads,
    PixelInputs: CarriedUniforms,
    StateChoice: SmallTriangles,
    TriangleLists: SeenTriangles,
    WindowCopy: ReversedCopy,
}


_Part = TypeVar("_Part")


class SoftwareRasteriser(Rasteriser):
    """llvmpipe and its kind: vertices in the thread that submits, pixels in threads of the driver's own."""

    defers = True
    pays_for_pixels = True

    def member(self, part: type[_Part]) -> type[_Part]:
        return cast("type[_Part]", _MEMBERS.get(part, part))
