"""A figure that walks anywhere on the ground, posed by what the task knows of a walker: place, heading and legs."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from mimics_app.contracts.messages.orders import Feature, VisualOrder
from mimics_app.scenarios.figures.walking_figure import add_walk, below, pace_with, stand
from mimics_app.tasks.walking.walker import FigurePose
from mimics_app.world.content.world import World
from mimics_app.world.graph.scene_node import SceneNode

__all__ = ["FreeFigure"]


class FreeFigure:
    """A node and the legs of its model.

    Args:
        world: The world of the node.
        node: The node; its model is at the node or at a child of it. Without a model only the node moves.
        pose: Feature that poses the walker.
        ahead: 1: the figure looks along the node's +z, as models do; -1: along its -z, as cameras do.
        ground: Returns the material of the ground at a place, x and z [m].
        step: Kind of the event of a heel strike.

    Attributes:
        walk: Gait of the model; None without one.
    """

    def __init__(
        self,
        world: World,
        node: SceneNode,
        pose: Feature[FigurePose],
        ahead: float,
        ground: Callable[[float, float], str] = lambda x, z: "",
        step: str = "step",
    ) -> None:
        self._node, self._feature, self._ahead = node, pose, ahead
        self._now = pose.default
        self.walk = add_walk(
            world.motion,
            below(node, world.motion.animators),
            lambda: pace_with(self._now.speed, self._now.step),
            lambda: (self._now.x, self._now.z, self._now.yaw),
            lambda: ground(self._now.x, self._now.z),
            legs=lambda: np.array(self._now.legs),
            phase=lambda: self._now.phase,
            step=step,
        )

    def follow(self, order: VisualOrder) -> None:
        """Take the task's pose of this frame, and stand where it says."""
        self._now = order.get(self._feature) or self._now
        stand(self._node, self._now[:3], self._now.yaw, self._ahead)
