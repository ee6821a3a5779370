"""Who bends the bodies that are drawn; nothing is loaded for a world in which none does."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.rendering.visual.drawing.mesh_arena import MeshArena
from mimics_app.rendering.visual.materials.shader_library import ShaderLibrary
from mimics_app.rendering.visual.settings import BendBy
from mimics_app.world.world import World

if TYPE_CHECKING:
    import moderngl

    from mimics_app.rendering.visual.drawing.feedback import FeedbackSkinning
    from mimics_app.rendering.visual.drawing.skinning import ProcessorSkinning

__all__ = ["Bending"]


class Bending:
    """Bends by compiled loops or by the driver, as is asked for when the first body has to bend.

    Attributes:
        skinning: What does it; None before the first body.
    """

    def __init__(self, ctx: moderngl.Context, shaders: ShaderLibrary, arena: MeshArena, by: BendBy) -> None:
        self._ctx, self._shaders, self._arena, self._by = ctx, shaders, arena, by
        self.skinning: ProcessorSkinning | FeedbackSkinning | None = None

    def bend(self, world: World, names: list[str]) -> None:
        """Have those of a world's meshes bend that are drawn, by their keys."""
        if not world.motion.bodies:
            return
        if self.skinning is None and self._by == "feedback":
            from mimics_app.rendering.visual.drawing.feedback import FeedbackSkinning

            self.skinning = FeedbackSkinning(self._ctx, self._shaders, self._arena)
        elif self.skinning is None:
            from mimics_app.rendering.visual.drawing.skinning import ProcessorSkinning

            self.skinning = ProcessorSkinning(self._arena)
        self.skinning.bend(world, names)

    def release(self) -> None:
        """Free what the driver holds for it."""
        if self.skinning is not None:
            self.skinning.release()
