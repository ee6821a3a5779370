"""A figure on a ground path: its node, the legs of its model, and the ground it treads on."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from mimics_app.scenarios.figures.ground_path import GroundPath
from mimics_app.scenarios.figures.walking_figure import add_walk, below, pace_at, stand
from mimics_app.tasks.walking.walker import FigurePose
from mimics_app.world.components.walking import PathWalker
from mimics_app.world.content.world import World
from mimics_app.world.graph.scene_node import SceneNode

__all__ = ["PathFigure"]


class PathFigure:
    """A walker of a scene.

    Args:
        world: The world of the node.
        node: The node; its model is at the node or at a child of it. Without a model only the node moves.
        walker: Its component.
        path: The path of the component.
        ahead: 1: the figure looks along the node's +z, as models do; -1: along its -z, as cameras do.
        own: Returns the pose of the person's own legs; None: the legs go by the speed.

    Attributes:
        walk: Gait of the model; None without one.
    """

    def __init__(
        self,
        world: World,
        node: SceneNode,
        walker: PathWalker,
        path: GroundPath,
        ahead: float = 1.0,
        own: Callable[[], FigurePose] | None = None,
    ) -> None:
        self._node, self._walker, self._path, self._ahead = node, walker, path, ahead
        self._x = self._z = self._yaw = self._speed = 0.0
        self._s = walker.start
        animator = below(node, world.motion.animators)
        self.walk = add_walk(
            world.motion,
            animator,
            lambda: pace_at(self._speed),
            lambda: (self._x, self._z, self._yaw),
            lambda: path.ground(self._s),
            legs=None if own is None else lambda: np.array(own().legs),
            phase=None if own is None else lambda: own().phase,
        )
        self.go(0.0, 0.0)

    def go(self, walked: float, speed: float) -> None:
        """Place the figure where it is after a distance from its start [m], with its present speed [m/s]."""
        self._s, self._speed = self._walker.start + walked, speed
        self._yaw = self._path.heading(self._s)
        x, y, z = self._path.at(self._s)
        aside = self._walker.aside
        self._x, self._z = x - aside * math.cos(self._yaw), z + aside * math.sin(self._yaw)
        stand(self._node, (self._x, y, self._z), self._yaw, self._ahead)
