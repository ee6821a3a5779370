"""Skinning of the drawn meshes, on the processor or the GPU; loaded only for worlds with skinned bodies."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.rendering.visual.drawing.mesh_arena import MeshArena
from mimics_app.rendering.visual.materials.shader_library import ShaderLibrary
from mimics_app.rendering.visual.settings import SkinBy
from mimics_app.world.content.world import World

if TYPE_CHECKING:
    import moderngl

    from mimics_app.rendering.visual.drawing.draw_list import DrawList
    from mimics_app.rendering.visual.drawing.feedback import FeedbackSkinning
    from mimics_app.rendering.visual.drawing.skinning import ProcessorSkinning

__all__ = ["MeshSkinning"]


class MeshSkinning:
    """Skins meshes by the requested method, which is loaded with the first skinned body.

    Attributes:
        skinning: The method in use; None before the first skinned body.
    """

    def __init__(self, ctx: moderngl.Context, shaders: ShaderLibrary, arena: MeshArena, by: SkinBy) -> None:
        self._ctx, self._shaders, self._arena, self._by = ctx, shaders, arena, by
        self.skinning: ProcessorSkinning | FeedbackSkinning | None = None

    def skin(self, world: World, listed: DrawList) -> None:
        """Skin those of a world's meshes that are queued in this frame and not skinned yet; the tally counts them."""
        if not world.motion.bodies:
            return
        if self.skinning is None and self._by == "feedback":
            from mimics_app.rendering.visual.drawing.feedback import FeedbackSkinning

            self.skinning = FeedbackSkinning(self._ctx, self._shaders, self._arena)
        elif self.skinning is None:
            from mimics_app.rendering.visual.drawing.skinning import ProcessorSkinning

            self.skinning = ProcessorSkinning(self._arena, listed.bent)
        listed.tally.bent += self.skinning.skin(world, listed.drawn_meshes())

    def release(self) -> None:
        """Free the GPU objects."""
        if self.skinning is not None:
            self.skinning.release()
