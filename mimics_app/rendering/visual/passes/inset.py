"""Insets: pictures of other cameras, drawn on the plane of the heads-up display."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.rendering.visual.materials.shader_library import ShaderLibrary
from mimics_app.rendering.visual.materials.vertex_arrays import bare_arrays
from mimics_app.rendering.visual.passes.hud import HudPlane, clip_from_hud
from mimics_app.rendering.visual.pictures.live_picture import LivePicture
from mimics_app.rendering.visual.view import Rect, View
from mimics_app.world.components.pictures import Inset

if TYPE_CHECKING:
    import moderngl

__all__ = ["InsetPass", "inset_pixels"]

_BINDING = 22


def inset_pixels(inset: Inset, view: View) -> Rect:
    """Return the rectangle of an inset relative to its view's corner [px]."""
    left, bottom, width, height = inset.rectangle
    wide, high = view.rectangle[2:]
    return round(left * wide), round(bottom * high), max(1, round(width * wide)), max(1, round(height * high))


class InsetPass:
    """Draws insets; the shader is compiled on first use."""

    def __init__(self, ctx: moderngl.Context, shaders: ShaderLibrary) -> None:
        self._ctx = ctx
        self._shaders = shaders
        self._arrays = bare_arrays(ctx)

    def draw(self, inset: Inset, picture: LivePicture, pixels: Rect, view: View, plane: HudPlane) -> int:
        """Draw an inset over a view; return the draw calls.

        Args:
            inset: The inset.
            picture: Its picture.
            pixels: Its rectangle in the first view of the screen, see `inset_pixels`.
            view: A view of that screen.
            plane: Plane of the screen's heads-up display.
        """
        import moderngl

        shader = self._shaders.program("inset/inset.vert", "inset/inset.frag")
        line = plane.canvas_height / view.rectangle[3]
        shader.set_numbers("box", [side * line for side in pixels])
        shader.set_number("border", inset.border)
        shader.set_number("mirrored", float(inset.mirrored))
        shader.set_matrix("clip_from_hud", clip_from_hud(view, plane))
        self._ctx.viewport = view.rectangle
        self._ctx.enable_only(moderngl.NOTHING)
        picture.use(_BINDING)
        self._arrays.of(shader).render(moderngl.TRIANGLE_STRIP, vertices=4)
        return 1

    def release(self) -> None:
        """Free the vertex array."""
        self._arrays.release()
