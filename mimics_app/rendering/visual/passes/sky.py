"""The sky behind everything."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mimics_app.rendering.visual.lighting import Lighting
from mimics_app.rendering.visual.picture_arrays import encode_srgb
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.shader_library import ShaderLibrary

if TYPE_CHECKING:
    import moderngl

__all__ = ["SkyPass", "flat_sky"]


def flat_sky(lighting: Lighting, settings: RenderSettings) -> tuple[float, float, float] | None:
    """Display values of a sky of one colour, which plain shading clears with instead of drawing; None for any other."""
    same = np.array_equal(lighting.zenith, lighting.horizon) and np.array_equal(lighting.horizon, lighting.ground)
    if settings.shading != "plain" or not same:
        return None
    red, green, blue = encode_srgb(settings.exposure * lighting.zenith).tolist()
    return red, green, blue


class SkyPass:
    """Draws the sky wherever nothing opaque was drawn."""

    def __init__(self, ctx: moderngl.Context, shaders: ShaderLibrary) -> None:
        self._ctx = ctx
        self._shader = shaders.program("sky/sky.vert", "sky/sky.frag")
        self._revision = -1
        self._array: moderngl.VertexArray | None = None

    def draw(self) -> int:
        """Draw it; returns the draw calls made."""
        import moderngl

        if self._array is None or self._revision != self._shader.revision:
            self._array = self._ctx.vertex_array(self._shader.program, [])
            self._revision = self._shader.revision
        self._ctx.enable_only(moderngl.DEPTH_TEST)
        self._ctx.depth_func = "<="
        self._array.render(moderngl.TRIANGLES, vertices=3)
        self._ctx.depth_func = "<"
        return 1

    def release(self) -> None:
        """Free the vertex array."""
        if self._array is not None:
            self._array.release()
            self._array = None
