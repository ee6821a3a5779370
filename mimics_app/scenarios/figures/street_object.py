"""An obstacle of a street: it stands across a path, and opens once it has been felt."""

from __future__ import annotations

import math

import numpy as np

from mimics_app.maths import quat
from mimics_app.scenarios.figures.path_figure import GroundPath
from mimics_app.tasks.kinds.city_walk.street_obstacles import StreetObstacle
from mimics_app.world.graph.scene_node import SceneNode

__all__ = ["StreetObject"]

_SINKS = {"kerb": 0.0, "box": 0.5, "low_wall": 0.6, "door": 0.0}
"""How deep each sinks into the ground to let the person pass [m]; a kerb is stepped over, a door swings."""
_SWINGS = 0.5 * math.pi
"""Angle of an open door [rad]."""


class StreetObject:
    """A node across a path; the model's front is its plane z = 0, which looks along -z, and a door's hinge x = 0.

    Args:
        node: Its node.
        path: The path.
        obstacle: Its place and kind.
    """

    def __init__(self, node: SceneNode, path: GroundPath, obstacle: StreetObstacle) -> None:
        self._node, self._kind = node, obstacle.kind
        self._place, self._heading = path.at(obstacle.at), path.heading(obstacle.at)
        self._hinge = np.array(node.position)
        self.open(0.0)

    def open(self, share: float) -> None:
        """Show it open by a share, 0 to 1."""
        c, s = math.cos(self._heading), math.sin(self._heading)
        x, y, z = self._hinge  # where the entity stands beside the path, in the frame of the walker
        down = share * _SINKS[self._kind]
        self._node.set_position(self._place + (c * x + s * z, y - down, c * z - s * x))
        turn = share * _SWINGS if self._kind == "door" else 0.0
        self._node.set_orientation(quat.about_axis((0.0, 1.0, 0.0), self._heading + turn))
