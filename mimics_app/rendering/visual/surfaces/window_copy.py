"""Copy of a picture to a window, whose rows have the opposite order."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from mimics_app.rendering.visual.surfaces.picture_texture import make_picture_texture
from mimics_app.rendering.visual.surfaces.raw_gl import RawGL
from mimics_app.rendering.visual.surfaces.surface import release_framebuffer

if TYPE_CHECKING:
    import moderngl

    from mimics_app.contracts.display_port import Rect

__all__ = ["WindowCopy"]

_RECTANGLES = """
#version 430
uniform vec2 size;
in vec4 place;
void main() {
    vec2 at = place.xy + place.zw * vec2(gl_VertexID & 1, gl_VertexID >> 1);
    gl_Position = vec4(vec2(2.0, -2.0) * at / size + vec2(-1.0, 1.0), 0.0, 1.0);
}
"""
_OTHER_ROW = """
#version 430
uniform vec2 size;
layout(binding = 20) uniform sampler2D picture;
out vec4 colour;
void main() { colour = texelFetch(picture, ivec2(gl_FragCoord.x, size.y - gl_FragCoord.y), 0); }
"""
_BINDING = 20
"""Binding of `picture`, that of all passes over a whole picture."""


class WindowCopy:
    """Copies a picture to the back buffer of a window.

    A window has its highest row first, a framebuffer its lowest. llvmpipe copies between buffers of the same order, and
    draws all pixels otherwise: at 1280 x 720 0.3 and 3.4 ms of processor time. Hence a copy of the picture is kept with
    the rows in reverse order, in which only what changed is drawn.

    Args:
        ctx: Context of the window.
        reverses: Whether to keep such a copy.
    """

    def __init__(self, ctx: moderngl.Context, *, reverses: bool) -> None:
        self._ctx, self._gl, self._reverses = ctx, RawGL(ctx), reverses
        self._program: moderngl.Program | None = None
        self._reversed: moderngl.Framebuffer | None = None
        self._holds = False

    def present(self, picture: moderngl.Framebuffer, changed: Sequence[Rect] | None) -> None:
        """Copy a picture, and use its framebuffer.

        Args:
            picture: Framebuffer of the picture, of the window's size, with a texture.
            changed: All rectangles that differ from the last one [px]; None: the whole picture.
        """
        whole = (0, 0, *picture.size)
        if not self._reverses or changed is None:
            self._gl.blit(picture.glo, 0, [(whole, whole)])
            self._holds = False
        else:
            self._reverse(picture, changed if self._holds else [whole])
            self._holds = True
        picture.use()

    def _reverse(self, picture: moderngl.Framebuffer, places: Sequence[Rect]) -> None:
        """Draw rectangles of a picture into the copy, and copy that."""
        import moderngl

        ctx, (width, height) = self._ctx, picture.size
        if self._reversed is None or self._reversed.size != picture.size:
            if self._reversed is not None:
                release_framebuffer(self._reversed)
            self._reversed = ctx.framebuffer([make_picture_texture(ctx, picture.size)])
        if self._program is None:
            self._program = ctx.program(_RECTANGLES, _OTHER_ROW)
        if places:
            self._program["size"] = float(width), float(height)
            buffer = ctx.buffer(np.array(places, np.float32))
            array = ctx.vertex_array(self._program, [(buffer, "4f /i", "place")])
            picture.color_attachments[0].use(_BINDING)  # type: ignore[union-attr]  # no renderbuffer
            self._reversed.use()
            ctx.enable_only(0)
            array.render(moderngl.TRIANGLE_STRIP, vertices=4, instances=len(places))
            array.release()
            buffer.release()
        self._gl.blit(self._reversed.glo, 0, [((0, 0, width, height), (0, height, width, 0))])
