"""Composition: a display's own shader from the picture of all eyes to the one that is shown."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from mimics_app.contracts.ports.display_port import Composing, Rect
from mimics_app.rendering.visual.materials.shader_library import ShaderLibrary
from mimics_app.rendering.visual.passes.screen import ScreenPass
from mimics_app.rendering.visual.surfaces.eye_buffer import EyeBuffer
from mimics_app.rendering.visual.surfaces.surface import Surface

if TYPE_CHECKING:
    import moderngl

__all__ = ["ComposePass"]


class ComposePass:
    """Runs the composition of a display.

    Args:
        ctx: Context of the pass.
        composing: Shader and uniforms.
    """

    def __init__(self, ctx: moderngl.Context, composing: Composing) -> None:
        self._composing = composing
        self._shaders = ShaderLibrary(ctx)
        self._pass = ScreenPass(ctx, self._shaders, composing.shader)

    def draw(self, drawn: EyeBuffer, shown: Surface, places: Sequence[Rect]) -> int:
        """Fill the surface; return the draw calls.

        Args:
            drawn: Picture of all eyes.
            shown: Surface to fill.
            places: Rectangles of the eyes in `drawn` [px], for shaders that run per eye.
        """
        shown.framebuffer.use()
        program: Any = self._shaders.program("post/screen.vert", self._composing.shader).program
        for name, values in self._composing.vectors.items():
            program[name].value = values
        if "rows" in program:
            program["rows"].value = float(shown.size[1])
        if not self._composing.each_eye:
            whole = (0, 0, *drawn.size)
            return self._pass.draw(drawn.texture, whole, (0, 0, *shown.size))
        shown.framebuffer.clear(alpha=1.0)
        return sum(self._pass.draw(drawn.texture, place, scaled(place, drawn, shown)) for place in places)

    def release(self) -> None:
        """Free the vertex array."""
        self._pass.release()


def scaled(place: Rect, drawn: Surface, shown: Surface) -> Rect:
    """Scale a rectangle of one picture to another that shows all of it at another size [px]."""
    across, down = shown.size[0] / drawn.size[0], shown.size[1] / drawn.size[1]
    x, y, width, height = place
    left, bottom = round(x * across), round(y * down)
    return left, bottom, max(1, round((x + width) * across) - left), max(1, round((y + height) * down) - bottom)
