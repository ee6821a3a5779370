"""Copy of a picture to a window, whose rows have the opposite order, of what changed alone."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from mimics_app.rendering.visual.surfaces.picture_texture import make_picture_texture
from mimics_app.rendering.visual.surfaces.surface import release_framebuffer
from mimics_app.rendering.visual.surfaces.window_copy import WindowCopy

if TYPE_CHECKING:
    import moderngl

    from mimics_app.contracts.ports.display_port import Rect

__all__ = ["ReversedCopy"]

_RECTANGLES = """
#version 430
uniform vec2 size;
uniform float up;
in vec4 place;
out vec2 where;
void main() {
    where = (place.xy + place.zw * vec2(gl_VertexID & 1, gl_VertexID >> 1)) / size;
    gl_Position = vec4((2.0 * where - 1.0) * vec2(1.0, up), 0.0, 1.0);
}
"""
_COPY = """
#version 430
layout(binding = 20) uniform sampler2D picture;
in vec2 where;
out vec4 colour;
void main() { colour = texture(picture, where); }
"""

_BINDING = 20
"""Binding of `picture`, that of all passes over a whole picture."""


class ReversedCopy(WindowCopy):
    """Keeps a copy of the picture with the rows in the window's order.

    A window has its highest row first, a framebuffer its lowest. llvmpipe copies between buffers of the same order, and
    draws all pixels otherwise, by rectangles of a texture faster than by a blit. Hence a copy of the picture is kept
    with the rows in reverse order, in which only what changed is drawn.
    """

    def __init__(self, ctx: moderngl.Context) -> None:
        super().__init__(ctx)
        self._ctx = ctx
        self._program: moderngl.Program | None = None
        self._nearest: moderngl.Sampler | None = None
        self._reversed: moderngl.Framebuffer | None = None
        self._holds = False

    def present(self, picture: moderngl.Framebuffer, changed: Sequence[Rect] | None) -> None:
        width, height = picture.size
        whole = (0, 0, width, height)
        if changed is None:
            self._ctx.screen.use()
            self._ctx.viewport = whole
            self._draw(picture, [whole], up=1.0)
        else:
            copy = self._copy_for(picture.size)
            copy.use()
            self._draw(picture, changed if self._holds else [whole], up=-1.0)
            self._gl.blit(copy.glo, 0, [(whole, (0, height, width, 0))])
        self._holds = changed is not None
        picture.use()

    def _copy_for(self, size: tuple[int, int]) -> moderngl.Framebuffer:
        """Return the copy, a new one for another size."""
        if self._reversed is None or self._reversed.size != size:
            if self._reversed is not None:
                release_framebuffer(self._reversed)
            self._reversed = self._ctx.framebuffer([make_picture_texture(self._ctx, size)])
            self._holds = False
        return self._reversed

    def _draw(self, picture: moderngl.Framebuffer, places: Sequence[Rect], *, up: float) -> None:
        """Draw rectangles of a picture into the framebuffer in use, upside down for an `up` of -1."""
        import moderngl

        if not places:
            return
        ctx = self._ctx
        if self._program is None or self._nearest is None:
            self._program = ctx.program(_RECTANGLES, _COPY)
            self._nearest = ctx.sampler(filter=(moderngl.NEAREST, moderngl.NEAREST), repeat_x=False, repeat_y=False)
        self._program["size"], self._program["up"] = tuple(map(float, picture.size)), up
        buffer = ctx.buffer(np.array(places, np.float32))
        array = ctx.vertex_array(self._program, [(buffer, "4f /i", "place")])
        picture.color_attachments[0].use(_BINDING)  # type: ignore[union-attr]  # no renderbuffer
        self._nearest.use(_BINDING)
        ctx.enable_only(0)
        array.render(moderngl.TRIANGLE_STRIP, vertices=4, instances=len(places))
        self._nearest.clear(_BINDING)
        array.release()
        buffer.release()
