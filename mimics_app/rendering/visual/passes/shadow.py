"""Shadow map pass: depth of the scene from the sun and from spot lights, in the tiles of one atlas."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from mimics_app.contracts.arrays import F8
from mimics_app.rendering.visual.drawing.frame_buffers import DrawRun, FrameBuffers
from mimics_app.rendering.visual.shadows.shadow_maps import ShadowPlan
from mimics_app.rendering.visual.shadows.shadow_target import ShadowTarget
from mimics_app.rendering.visual.view import Rect

if TYPE_CHECKING:
    import moderngl

__all__ = ["MapWork", "draw_shadows"]

_SLOPE_BIAS, _CONSTANT_BIAS = 2.5, 4.0
"""Depth bias: slopes per texel, and smallest depth steps. A slope bias of 1.5, the filter's reach in texels, suffices
for planes; curved surfaces need more, and a larger one leaks light under thin edges."""


@dataclass(frozen=True, eq=False)
class MapWork:
    """Draws of one shadow map.

    Attributes:
        still: Static casters, drawn first; None: their kept depths are restored.
        keep: True to keep the depths of the static casters.
        moving: Moving casters, drawn over them.
        reach: Rectangles of the map that these can cover [texel].
    """

    still: list[DrawRun] | None
    keep: bool
    moving: list[DrawRun]
    reach: list[Rect]

    @property
    def runs(self) -> list[DrawRun]:
        """All runs."""
        return [*(self.still or ()), *self.moving]

    @property
    def triangles(self) -> int:
        """Triangles of all runs."""
        return sum(run.triangles for run in self.runs)


def draw_shadows(
    ctx: moderngl.Context,
    frame: FrameBuffers,
    target: ShadowTarget,
    plan: ShadowPlan,
    work: list[MapWork | None],
) -> int:
    """Draw the tiles of maps that have changed; the others stay as they are.

    Args:
        ctx: Context of the pass.
        frame: Buffers of the frame; each map's instances are relative to its own origin.
        target: The atlas.
        plan: Its maps.
        work: Draws of each of `plan.maps`; None leaves a map as it is.

    Returns:
        Draw calls made.
    """
    import moderngl

    changed = [(shadow, each) for shadow, each in zip(plan.maps, work, strict=True) if each is not None]
    if not changed:
        return 0
    target.begin()
    ctx.enable_only(moderngl.DEPTH_TEST)
    ctx.polygon_offset = (_SLOPE_BIAS, _CONSTANT_BIAS)
    for shadow, each in changed:
        clip_from_origin = shadow.clip_from_world.copy()
        clip_from_origin[:, 3] += shadow.clip_from_world[:, :3] @ shadow.origin
        target.enter(shadow.tile, plan.grid, each.reach, kept=each.still is None)
        _draw(frame, each.still or (), clip_from_origin)
        if each.keep:
            target.keep(shadow.tile, plan.grid)
        _draw(frame, each.moving, clip_from_origin)
    ctx.polygon_offset = (0.0, 0.0)
    frame.flush()
    return sum(len(each.runs) for _, each in changed)


def _draw(frame: FrameBuffers, runs: Sequence[DrawRun], clip_from_origin: F8) -> None:
    for run in runs:
        run.material_instance.bind()
        run.material_instance.shadow_shader.set_matrix("clip_from_eye", clip_from_origin)
        frame.draw(run, run.material_instance.shadow_shader)
