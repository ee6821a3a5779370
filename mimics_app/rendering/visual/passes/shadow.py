"""Depth of the scene seen from the sun and from spot lights, in the tiles of one atlas."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.rendering.visual.drawing.frame_buffers import DrawRun, FrameBuffers
from mimics_app.rendering.visual.drawing.mesh_arena import MeshArena
from mimics_app.rendering.visual.shadows.shadow_maps import ShadowPlan
from mimics_app.rendering.visual.shadows.shadow_target import ShadowTarget

if TYPE_CHECKING:
    import moderngl

__all__ = ["draw_shadows"]

_SLOPE_BIAS, _CONSTANT_BIAS = 2.5, 4.0
"""Depth bias: depth slopes per texel, and smallest depth steps. The filter reaches 1.5 texels, so that 1.5
would do for planes; curved surfaces need more, and still more lets light in under thin edges."""


def draw_shadows(
    ctx: moderngl.Context,
    arena: MeshArena,
    frame: FrameBuffers,
    target: ShadowTarget,
    plan: ShadowPlan,
    runs: list[list[DrawRun] | None],
) -> int:
    """Fill the tiles of maps that have changed; the others stay what they were.

    Args:
        ctx: Whose state is set.
        arena: Has the meshes.
        frame: Has the instances, each map's relative to its own origin.
        target: The atlas.
        plan: Its maps.
        runs: What to draw into each of `plan.maps`; None leaves it as it is.

    Returns:
        Draw calls made.
    """
    import moderngl

    changed = [(shadow, drawn) for shadow, drawn in zip(plan.maps, runs, strict=True) if drawn is not None]
    if not changed:
        return 0
    target.begin()
    ctx.enable_only(moderngl.DEPTH_TEST)
    ctx.polygon_offset = (_SLOPE_BIAS, _CONSTANT_BIAS)
    for shadow, drawn in changed:
        target.enter(shadow.tile, plan.grid)
        clip_from_origin = shadow.clip_from_world.copy()
        clip_from_origin[:, 3] += shadow.clip_from_world[:, :3] @ shadow.origin
        for run in drawn:
            run.look.bind()
            run.look.shadow_shader.set_matrix("clip_from_eye", clip_from_origin)
            frame.draw(arena, run, run.look.shadow_shader)
    ctx.polygon_offset = (0.0, 0.0)
    return sum(len(drawn) for _, drawn in changed)
