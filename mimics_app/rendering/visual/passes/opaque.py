"""Everything that hides what is behind it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.rendering.visual.frame_buffers import DrawRun, FrameBuffers
from mimics_app.rendering.visual.mesh_arena import MeshArena

if TYPE_CHECKING:
    import moderngl

__all__ = ["draw_opaque"]


def draw_opaque(ctx: moderngl.Context, arena: MeshArena, frame: FrameBuffers, runs: list[DrawRun]) -> int:
    """Draw opaque and masked runs with depth.

    Returns:
        Draw calls made.
    """
    import moderngl

    ctx.enable_only(moderngl.DEPTH_TEST)
    for run in runs:
        (ctx.disable if run.look.material.double_sided else ctx.enable)(moderngl.CULL_FACE)
        run.look.bind()
        frame.draw(arena, run)
    return len(runs)
