"""Runs a display's own shader over what was drawn."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from mimics_app.contracts.display_port import Composing, Rect
from mimics_app.rendering.visual.materials.shader_library import ShaderLibrary
from mimics_app.rendering.visual.passes.screen import ScreenPass
from mimics_app.rendering.visual.surfaces.eye_buffer import EyeBuffer
from mimics_app.rendering.visual.surfaces.surface import Surface

if TYPE_CHECKING:
    import moderngl

__all__ = ["ComposePass"]


class ComposePass:
    """One shader from the picture of all eyes to the one that is shown.

    Args:
        ctx: Where it runs.
        composing: Which, with its numbers.
    """

    def __init__(self, ctx: moderngl.Context, composing: Composing) -> None:
        self._composing = composing
        self._shaders = ShaderLibrary(ctx)
        self._pass = ScreenPass(ctx, self._shaders, composing.shader)

    def draw(self, drawn: EyeBuffer, shown: Surface, places: Sequence[Rect]) -> int:
        """Fill the surface; returns the draw calls made.

        Args:
            drawn: All eyes.
            shown: Where to.
            places: Of the eyes in `drawn` [px], for shaders that run over each of them.
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
    """A rectangle of one picture in another that holds the whole of it, smaller or larger [px]."""
    across, down = shown.size[0] / drawn.size[0], shown.size[1] / drawn.size[1]
    x, y, width, height = place
    left, bottom = round(x * across), round(y * down)
    return left, bottom, max(1, round((x + width) * across) - left), max(1, round((y + height) * down) - bottom)
