"""Screen-space ambient occlusion, computed from a depth pre-pass."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from mimics_app.contracts.arrays import F4
from mimics_app.rendering.visual.draw_buffer import texture_of
from mimics_app.rendering.visual.drawing.frame_buffers import DrawRun, FrameBuffers
from mimics_app.rendering.visual.materials.shader_library import ShaderLibrary
from mimics_app.rendering.visual.passes.screen import ScreenPass
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.surfaces.raw_gl import CLIP_DISTANCE_0
from mimics_app.rendering.visual.surfaces.surface import Size, release_framebuffer
from mimics_app.rendering.visual.view import Rect, View

if TYPE_CHECKING:
    import moderngl

__all__ = ["AmbientPass"]

_TEXTURE_BINDING, _BLOCK_BINDING = 23, 6
"""Bindings of shaders/common/ambient.glsl."""

_BOTH_EYES = ("EYES_BY_CLIPPING",)
"""Define for both eyes, which are always side by side in the depth buffer of this pass."""


class AmbientPass:
    """Draws the depth of one eye or both at half resolution, and computes the visibility of the sky from it.

    Only ambient light is occluded, since visibility is known before shading. Blended surfaces, mirrors and other
    cameras' pictures are not occluded.
    """

    def __init__(self, ctx: moderngl.Context, shaders: ShaderLibrary, frame: FrameBuffers) -> None:
        self._ctx = ctx
        self._shaders = shaders
        self._frame = frame
        self._find = ScreenPass(ctx, shaders, "ambient/ssao.frag")
        self._smooth = ScreenPass(ctx, shaders, "ambient/blur.frag")
        self._size: Size = (0, 0)
        self._depth: moderngl.Framebuffer | None = None
        self._found: list[moderngl.Framebuffer] = []
        self._open: moderngl.Texture | None = None
        self._block: moderngl.Buffer | None = None
        self._places = np.zeros((2, 8), np.float32)

    def begin_depth(self, rectangles: Sequence[Rect]) -> None:
        """Clear the depth buffer.

        Args:
            rectangles: Rectangles of the views in the picture, of equal size [px].
        """
        self._reserve(rectangles)
        assert self._depth is not None
        self._depth.use()
        self._depth.clear(depth=1.0)

    def draw_depth(self, views: Sequence[View], opaque: list[DrawRun]) -> int:
        """Draw the depth of one view, or of the eyes selected by the bound view block; return the draw calls.

        Args:
            views: One view, or both eyes.
            opaque: Their opaque runs.
        """
        import moderngl

        ctx, both = self._ctx, len(views) > 1
        if both:
            ctx.enable_direct(CLIP_DISTANCE_0)
        for run in opaque:
            run.material_instance.bind()
            double = run.material_instance.passes[0].cull == "none"
            ctx.enable_only(moderngl.DEPTH_TEST if double else moderngl.DEPTH_TEST | moderngl.CULL_FACE)
            shader = self._shaders.also_with(run.material_instance.shadow_shader, _BOTH_EYES if both else ())
            if not both:
                shader.set_matrix("clip_from_eye", views[0].clip_from_eye)
            self._frame.draw(run, shader)
        if both:
            ctx.disable_direct(CLIP_DISTANCE_0)
        return len(opaque)

    def find(self, number: int, settings: RenderSettings) -> int:
        """Compute the visibility for an eye whose view block is bound; return the draw calls.

        Args:
            number: Number of the eye among those whose depth was drawn.
            settings: Strength and radius.
        """
        assert self._depth is not None
        width, height = self._size
        part = (number * width, 0, width, height)
        found, smooth = self._found
        found.use()
        numbers = {"radius": settings.ambient_radius, "strength": settings.ambient_occlusion}
        draws = self._find.draw(self._depth.depth_attachment, part, part, **numbers)  # type: ignore[arg-type]
        smooth.use()
        return draws + self._smooth.draw(texture_of(found), part, part, radius=settings.ambient_radius)

    def use(self, eyes: Sequence[int]) -> None:
        """Bind the visibility of one eye, or of both where one pass draws both."""
        self._write(self._places[list(eyes)])
        texture_of(self._found[1]).use(_TEXTURE_BINDING)

    def skip(self) -> None:
        """Bind full visibility."""
        if self._open is None:
            self._open = self._ctx.texture((1, 1), 2, np.array([1.0, 0.0], np.float16).tobytes(), dtype="f2")
        self._write(np.zeros((2, 8), np.float32))
        self._open.use(_TEXTURE_BINDING)

    def release(self) -> None:
        """Free buffers and passes."""
        for part in (self._find, self._smooth, self._open, self._block):
            if part is not None:
                part.release()
        self._open = self._block = None
        self._free()

    def _write(self, places: F4) -> None:
        """Upload the texels of each eye: corner [px], texels per pixel; first and last column, last row."""
        if self._block is None:
            self._block = self._ctx.buffer(reserve=64)
        block = np.zeros((2, 2, 4), np.float32)
        block[:, : len(places)] = places.reshape(-1, 2, 4).swapaxes(0, 1)
        self._block.orphan()
        self._block.write(block.tobytes())
        self._block.bind_to_uniform_block(_BLOCK_BINDING)

    def _reserve(self, rectangles: Sequence[Rect]) -> None:
        """Create buffers for eyes side by side, at half the size of these rectangles [px]."""
        _, _, across, along = rectangles[0]
        width, height = (across + 1) // 2, (along + 1) // 2
        for number, (x, y, _, _) in enumerate(rectangles):
            first = number * width
            texels = (first, first + width - 1, height - 1, 0.0)
            self._places[number] = (x, y, width / across, height / along, *texels)
        self._size, had = (width, height), self._depth
        size = (len(rectangles) * width, height)
        if had is not None and had.size == size:
            return
        self._free()
        depth = self._ctx.depth_texture(size)
        depth.compare_func = ""
        self._depth = self._ctx.framebuffer(depth_attachment=depth)
        self._found = [self._ctx.framebuffer([self._ctx.texture(size, 2, dtype="f2")]) for _ in range(2)]

    def _free(self) -> None:
        for framebuffer in (self._depth, *self._found):
            if framebuffer is not None:
                release_framebuffer(framebuffer)
        self._depth, self._found = None, []
