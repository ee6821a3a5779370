"""RootMotion: transfers the horizontal motion of a joint in a clip to the model's node."""

from __future__ import annotations

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.maths.quat import rotate
from mimics_app.world.content.motion.animator import Animator
from mimics_app.world.content.motion.pose import Pose
from mimics_app.world.graph.transforms import TransformTable

__all__ = ["RootMotion"]


class RootMotion:
    """Root motion: a joint keeps its horizontal rest position, the model moves instead; an animator's last step.

    Args:
        animator: Animator whose layers move the joint.
        slot: The joint.
        transforms: Transform table of the world.
        entity: Entity index of the model's node.

    Attributes:
        travel: Displacement of the model in the last step, in its own frame [m], [3].
    """

    def __init__(self, animator: Animator, slot: int, transforms: TransformTable, entity: int) -> None:
        self._animator, self._slot = animator, slot
        self._transforms, self._entity = transforms, entity
        self._scratch = animator.rig.rest.copy()
        self.travel: F8 = np.zeros(3)

    def __call__(self, pose: Pose, seconds: float) -> None:
        travel, share = np.zeros(3), 0.0
        for layer in self._animator.layers:
            if layer.weight > 0.0 and layer.moves(self._slot) and not layer.additive:
                travel = (1.0 - layer.weight) * travel + layer.weight * layer.travel(self._slot, self._scratch)
                share = max(share, layer.weight)
        travel[1] = 0.0
        rest = self._animator.rig.rest.translations[self._slot]
        pose.translations[self._slot, [0, 2]] = rest[[0, 2]]
        self.travel = travel
        if share > 0.0 and travel.any():
            moved, table, index = np.empty(3), self._transforms, self._entity
            rotate(table.rotation(index), travel * table.scale(index), moved)
            table.set_translation(index, table.translation(index) + moved)
