"""Nodes of haptic bodies: entities follow the poses of the loop."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import F8
from mimics_app.maths import mat, quat
from mimics_app.world.content.world import World
from mimics_app.world.graph.scene_node import SceneNode

__all__ = ["BodyNodes"]


class BodyNodes:
    """Nodes driven by the poses beside a snapshot.

    Args:
        world: The running world.
        entities: Entity of each row of bodies.
    """

    def __init__(self, world: World, entities: Sequence[str]) -> None:
        self._nodes = [world.find(name) for name in entities]

    def follow(self, poses: NDArray[Any]) -> None:
        """Set the pose of every node to that of its body.

        Args:
            poses: Position [m] and quaternion xyzw of each body, world, shape [bodies, 7]; a body the loop has not
                placed yet (a quaternion of zeros) keeps its node where it is.
        """
        for node, pose in zip(self._nodes, poses, strict=False):
            if pose[3:7].any():
                _place(node, pose[:3], pose[3:7])


def _place(node: SceneNode, position: F8, orientation: F8) -> None:
    """Set the world pose of a node under any parent."""
    parent = node.parent
    if parent is not None and parent.parent is not None:
        inverse = np.zeros((4, 4))
        mat.affine_inverse(parent.world_matrix(), inverse)
        local = inverse @ mat.compose(position, orientation)
        position, turn = local[:3, 3], np.zeros(4)
        quat.from_matrix(local / np.cbrt(np.linalg.det(local[:3, :3])), turn)
        orientation = turn
    node.set_position(position)
    node.set_orientation(orientation)
