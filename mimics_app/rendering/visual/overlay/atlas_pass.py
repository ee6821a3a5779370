"""The shadow atlas as an inset."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mimics_app.rendering.visual.materials.shader_library import ShaderLibrary
from mimics_app.rendering.visual.materials.vertex_arrays import bare_arrays
from mimics_app.rendering.visual.shadows.shadow_maps import ShadowPlan
from mimics_app.rendering.visual.stages.shadow_stage import ShadowStage

if TYPE_CHECKING:
    import moderngl

__all__ = ["AtlasPass"]

_BINDING = 4
_SHARE = 0.36
"""Height of the inset over that of the picture."""
_MAX_TILES = 16


class AtlasPass:
    """Shows the depths as a shaded relief, in the lower right corner."""

    def __init__(self, ctx: moderngl.Context, shaders: ShaderLibrary) -> None:
        self._ctx = ctx
        self._shader = shaders.program("overlay/depth.vert", "overlay/depth.frag")
        self._arrays = bare_arrays(ctx)

    def draw(self, framebuffer: moderngl.Framebuffer, shadows: ShadowStage) -> int:
        """Draw the inset over a framebuffer; return the draw calls, 0 without shadow maps."""
        import moderngl

        if not shadows.plan.maps:
            return 0
        width, height = framebuffer.size
        side = 2.0 * _SHARE
        across = side * height / width
        self._shader.set_numbers("rectangle", (1.0 - across - 0.03, -0.95, across, side))
        self._shader.set_number("tiles", float(shadows.plan.grid))
        self._shader.set_numbers("relief", _relief(shadows.plan))
        self._ctx.viewport = (0, 0, width, height)
        self._ctx.enable_only(moderngl.BLEND)
        self._ctx.blend_func = moderngl.SRC_ALPHA, moderngl.ONE_MINUS_SRC_ALPHA
        shadows.bind(_BINDING)
        self._arrays.of(self._shader).render(moderngl.TRIANGLE_STRIP, vertices=4)
        return 1

    def release(self) -> None:
        """Free the vertex array."""
        self._arrays.release()


def _relief(plan: ShadowPlan) -> list[float]:
    """Return depth range over texel width of each tile; approximate for spot lights, whose depth is not linear."""
    ratios = [1.0] * _MAX_TILES
    for shadow in plan.maps:
        column, row = shadow.tile
        along = float(np.linalg.norm(shadow.clip_from_world[2, :3]))
        ratios[row * plan.grid + column] = 2.0 / (along * shadow.texel)
    return ratios
