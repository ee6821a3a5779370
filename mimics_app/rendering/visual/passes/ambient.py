"""How much of the sky's light near surfaces leave each other: found in the picture's depth before it is drawn."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mimics_app.rendering.visual.draw_buffer import texture_of
from mimics_app.rendering.visual.drawing.frame_buffers import DrawRun, FrameBuffers
from mimics_app.rendering.visual.drawing.mesh_arena import MeshArena
from mimics_app.rendering.visual.materials.shader_library import ShaderLibrary
from mimics_app.rendering.visual.passes.screen import ScreenPass
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.surfaces.surface import Size, release_framebuffer
from mimics_app.rendering.visual.view import Rect, View

if TYPE_CHECKING:
    import moderngl

__all__ = ["AmbientPass"]

_TEXTURE_BINDING, _BLOCK_BINDING = 23, 6
"""Of shaders/common/ambient.glsl."""


class AmbientPass:
    """Draws the depth of a view at half the size, and from it what the lit shaders take off the sky's light.

    Only light from everywhere is taken off, because it is known before anything is lit. What is blended, and what a
    mirror or another camera shows, is without it.
    """

    def __init__(self, ctx: moderngl.Context, shaders: ShaderLibrary, arena: MeshArena, frame: FrameBuffers) -> None:
        self._ctx = ctx
        self._arena, self._frame = arena, frame
        self._find = ScreenPass(ctx, shaders, "ambient/ssao.frag")
        self._smooth = ScreenPass(ctx, shaders, "ambient/blur.frag")
        self._size: Size = (0, 0)
        self._depth: moderngl.Framebuffer | None = None
        self._found: list[moderngl.Framebuffer] = []
        self._open: moderngl.Texture | None = None
        self._block: moderngl.Buffer | None = None

    def draw(self, view: View, rectangle: Rect, opaque: list[DrawRun], settings: RenderSettings) -> int:
        """Find it for a view, whose block is bound, and have the shaders read it; returns the draw calls made.

        Args:
            view: From where.
            rectangle: Of the view in the picture [px].
            opaque: What is drawn in it.
            settings: Strength and radius.
        """
        self._make(((rectangle[2] + 1) // 2, (rectangle[3] + 1) // 2))
        whole = (0, 0, *self._size)
        draws = self._draw_depth(view, opaque)
        found, smooth = self._found
        found.use()
        numbers = {"radius": settings.ambient_radius, "strength": settings.ambient_occlusion}
        assert self._depth is not None
        draws += self._find.draw(self._depth.depth_attachment, whole, whole, **numbers)  # type: ignore[arg-type]
        smooth.use()
        draws += self._smooth.draw(texture_of(found), whole, whole, radius=settings.ambient_radius)
        self._place(rectangle[:2], (self._size[0] / rectangle[2], self._size[1] / rectangle[3]))
        texture_of(smooth).use(_TEXTURE_BINDING)
        return draws

    def skip(self) -> None:
        """Have the shaders read that all is open."""
        if self._open is None:
            self._open = self._ctx.texture((1, 1), 2, np.array([1.0, 0.0], np.float16).tobytes(), dtype="f2")
        self._place((0, 0), (1.0, 1.0))
        self._open.use(_TEXTURE_BINDING)

    def release(self) -> None:
        """Free buffers and passes."""
        for part in (self._find, self._smooth, self._open, self._block):
            if part is not None:
                part.release()
        self._open = self._block = None
        self._free()

    def _draw_depth(self, view: View, opaque: list[DrawRun]) -> int:
        import moderngl

        assert self._depth is not None
        self._depth.use()
        self._depth.clear(depth=1.0)
        ctx = self._ctx
        for run in opaque:
            run.look.bind()
            double = run.look.passes[0].cull == "none"
            ctx.enable_only(moderngl.DEPTH_TEST if double else moderngl.DEPTH_TEST | moderngl.CULL_FACE)
            run.look.shadow_shader.set_matrix("clip_from_eye", view.clip_from_eye)
            self._frame.draw(self._arena, run, run.look.shadow_shader)
        return len(opaque)

    def _place(self, corner: tuple[int, int], texels: tuple[float, float]) -> None:
        if self._block is None:
            self._block = self._ctx.buffer(reserve=16)
        self._block.orphan()
        self._block.write(np.array([*corner, *texels], np.float32).tobytes())
        self._block.bind_to_uniform_block(_BLOCK_BINDING)

    def _make(self, size: Size) -> None:
        if size == self._size:
            return
        self._free()
        self._size = size
        depth = self._ctx.depth_texture(size)
        depth.compare_func = ""
        self._depth = self._ctx.framebuffer(depth_attachment=depth)
        self._found = [self._ctx.framebuffer([self._ctx.texture(size, 2, dtype="f2")]) for _ in range(2)]

    def _free(self) -> None:
        for framebuffer in (self._depth, *self._found):
            if framebuffer is not None:
                release_framebuffer(framebuffer)
        self._depth, self._found, self._size = None, [], (0, 0)
