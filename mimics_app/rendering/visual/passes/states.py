"""Render state of a look's passes, set in the driver only where it changes."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from mimics_app.rendering.visual.drawing.frame_buffers import DrawRun, FrameBuffers
from mimics_app.rendering.visual.drawing.mesh_arena import MeshArena
from mimics_app.rendering.visual.materials.look import LookPass
from mimics_app.rendering.visual.materials.shader_library import ShaderProgram

if TYPE_CHECKING:
    import moderngl

__all__ = ["draw_runs"]


def _as_it_is(shader: ShaderProgram) -> ShaderProgram:
    return shader


def draw_runs(
    target: moderngl.Framebuffer,
    arena: MeshArena,
    frame: FrameBuffers,
    runs: list[DrawRun],
    variant: Callable[[ShaderProgram], ShaderProgram] = _as_it_is,
) -> int:
    """Draw every pass of every run in order; afterwards depth is written and back faces are what is left out.

    Args:
        target: Where to; in use.
        arena: What the runs draw.
        frame: Has their commands.
        runs: In order.
        variant: Which program draws instead of a pass's own.

    Returns:
        Draw calls made.
    """
    ctx, calls, last = target.ctx, 0, None
    for run in runs:
        run.look.bind()
        for each in run.look.passes:
            state = (each.blend, each.cull, each.depth)
            if state != last:
                _set_state(target, each)
                last = state
            frame.draw(arena, run, variant(each.shader))
            calls += 1
    ctx.cull_face = "back"
    target.depth_mask = True
    return calls


def _set_state(target: moderngl.Framebuffer, wanted: LookPass) -> None:
    import moderngl

    ctx = target.ctx
    flags = moderngl.NOTHING
    if wanted.depth != "off":
        flags |= moderngl.DEPTH_TEST
    if wanted.cull != "none":
        flags |= moderngl.CULL_FACE
        ctx.cull_face = wanted.cull
    if wanted.blend != "none":
        flags |= moderngl.BLEND
        ctx.blend_func = {
            "add": (moderngl.SRC_ALPHA, moderngl.ONE),
            "multiply": (moderngl.DST_COLOR, moderngl.ZERO),
        }.get(wanted.blend, (moderngl.SRC_ALPHA, moderngl.ONE_MINUS_SRC_ALPHA))
    ctx.enable_only(flags)
    target.depth_mask = wanted.depth == "write"
