"""Depth of the scene seen from the sun."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.rendering.visual.frame_buffers import DrawRun, FrameBuffers
from mimics_app.rendering.visual.lighting import ShadowFrustum
from mimics_app.rendering.visual.mesh_arena import MeshArena
from mimics_app.rendering.visual.targets import ShadowTarget

if TYPE_CHECKING:
    import moderngl

__all__ = ["draw_shadow"]

_SLOPE_BIAS, _CONSTANT_BIAS = 2.5, 4.0
"""Depth bias: depth slopes per texel, and smallest depth steps. The filter reaches 1.5 texels, so that 1.5
would do for planes; curved surfaces need more, and still more lets light in under thin edges."""


def draw_shadow(
    ctx: moderngl.Context,
    arena: MeshArena,
    frame: FrameBuffers,
    target: ShadowTarget,
    frustum: ShadowFrustum | None,
    runs: list[DrawRun],
) -> int:
    """Fill the sun's shadow map; without a frustum it stays what it was, and the view block says not to ask it.

    Returns:
        Draw calls made.
    """
    import moderngl

    if frustum is None:
        return 0
    target.begin()
    clip_from_centre = frustum.clip_from_world.copy()
    clip_from_centre[:3, 3] += frustum.clip_from_world[:3, :3] @ frustum.centre
    ctx.enable_only(moderngl.DEPTH_TEST)
    ctx.polygon_offset = (_SLOPE_BIAS, _CONSTANT_BIAS)
    for run in runs:
        run.look.bind()
        run.look.shadow_shader.set_matrix("clip_from_eye", clip_from_centre)
        frame.draw(arena, run, run.look.shadow_shader)
    ctx.polygon_offset = (0.0, 0.0)
    return len(runs)
