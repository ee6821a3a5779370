"""Drawing of mesh runs: every pass of their materials, with render state set only where it changes."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from mimics_app.rendering.visual.drawing.frame_buffers import DrawRun, FrameBuffers
from mimics_app.rendering.visual.materials.material_instance import MaterialPass
from mimics_app.rendering.visual.materials.shader_library import ShaderProgram

if TYPE_CHECKING:
    import moderngl

__all__ = ["draw_runs"]


def _identity(shader: ShaderProgram) -> ShaderProgram:
    return shader


def draw_runs(
    target: moderngl.Framebuffer,
    frame: FrameBuffers,
    runs: list[DrawRun],
    variant: Callable[[ShaderProgram], ShaderProgram] = _identity,
) -> int:
    """Draw every pass of every run in order; depth write and back-face culling are restored afterwards.

    Args:
        target: The framebuffer in use.
        frame: Buffers of the frame.
        runs: Runs in order.
        variant: Returns the program to use in place of a pass's own.

    Returns:
        Draw calls made.
    """
    ctx, calls, last = target.ctx, 0, None
    for run in runs:
        run.material_instance.bind()
        for each in run.material_instance.passes:
            state = (each.blend, each.cull, each.depth)
            if state != last:
                _set_state(target, each)
                last = state
            frame.draw(run, variant(each.shader))
            calls += 1
    ctx.cull_face = "back"
    target.depth_mask = True
    return calls


def _set_state(target: moderngl.Framebuffer, wanted: MaterialPass) -> None:
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
