"""Edges of all triangles that are drawn."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.rendering.visual.drawing.frame_buffers import FrameBuffers
from mimics_app.rendering.visual.drawing.mesh_arena import MeshArena
from mimics_app.rendering.visual.materials.shader_library import ShaderLibrary
from mimics_app.rendering.visual.stages.world_stage import ViewDraws

if TYPE_CHECKING:
    import moderngl

__all__ = ["WirePass"]


class WirePass:
    """Draws the runs of a frame again as lines, a little nearer than they are."""

    def __init__(self, ctx: moderngl.Context, shaders: ShaderLibrary, arena: MeshArena, frame: FrameBuffers) -> None:
        self._ctx, self._arena, self._frame = ctx, arena, frame
        self._shader = shaders.program("common/mesh.vert", "overlay/wire.frag")

    def draw(self, target: moderngl.Framebuffer, drawn: ViewDraws) -> int:
        """Draw a view whose block is bound; returns the draw calls made."""
        import moderngl

        ctx, runs = self._ctx, (*drawn.opaque, *drawn.blended)
        target.viewport = drawn.rectangle
        target.depth_mask = False
        ctx.enable_only(moderngl.DEPTH_TEST | moderngl.BLEND)
        ctx.blend_func = moderngl.SRC_ALPHA, moderngl.ONE_MINUS_SRC_ALPHA
        ctx.depth_func, ctx.wireframe, ctx.polygon_offset = "<=", True, (-1.0, -1.0)
        for run in runs:
            self._frame.draw(self._arena, run, self._shader)
        ctx.depth_func, ctx.wireframe, ctx.polygon_offset = "<", False, (0.0, 0.0)
        target.depth_mask = True
        return len(runs)
