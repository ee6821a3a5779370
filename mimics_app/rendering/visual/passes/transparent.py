"""Everything one can see through, from far to near."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.rendering.visual.frame_buffers import DrawRun, FrameBuffers
from mimics_app.rendering.visual.mesh_arena import MeshArena

if TYPE_CHECKING:
    import moderngl

__all__ = ["draw_transparent"]


def draw_transparent(target: moderngl.Framebuffer, arena: MeshArena, frame: FrameBuffers, runs: list[DrawRun]) -> int:
    """Blend sorted runs over the picture; depth is tested but not written.

    Glass is drawn twice, its back faces first: right for any convex cross-section, such as a tube's.

    Returns:
        Draw calls made.
    """
    import moderngl

    if not runs:
        return 0
    ctx = target.ctx
    ctx.enable_only(moderngl.DEPTH_TEST | moderngl.BLEND)
    ctx.blend_func = moderngl.SRC_ALPHA, moderngl.ONE_MINUS_SRC_ALPHA
    calls = 0
    target.depth_mask = False
    for run in runs:
        run.look.bind()
        for side in _sides(run):
            (ctx.enable if side else ctx.disable)(moderngl.CULL_FACE)
            if side:
                ctx.cull_face = side
            frame.draw(arena, run)
            calls += 1
    ctx.cull_face = "back"
    target.depth_mask = True
    return calls


def _sides(run: DrawRun) -> tuple[str, ...]:
    """Which faces are left out, draw by draw; "" leaves out none."""
    if run.look.material.technique == "glass":
        return ("front", "back")
    return ("",) if run.look.material.double_sided else ("back",)
