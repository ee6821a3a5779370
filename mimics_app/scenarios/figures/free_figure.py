"""A figure that walks anywhere on the ground, posed by what the task knows of a walker: place, heading and legs."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from mimics_app.scenarios.figures.walking_figure import add_walk, below, follow_numbers, pace_with, stand
from mimics_app.tasks.walking.walker import JOINTS, blank_orders
from mimics_app.world.content.world import World
from mimics_app.world.graph.scene_node import SceneNode

__all__ = ["FreeFigure"]


class FreeFigure:
    """A node and the legs of its model.

    Args:
        world: The world of the node.
        node: The node; its model is at the node or at a child of it. Without a model only the node moves.
        name: Name under which the task orders the numbers of the walker.
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
        name: str,
        ahead: float,
        ground: Callable[[float, float], str] = lambda x, z: "",
        step: str = "step",
    ) -> None:
        self._node, self._name, self._ahead = node, name, ahead
        self._now = blank_orders(name)
        self.walk = add_walk(
            world.motion,
            below(node, world.motion.animators),
            lambda: pace_with(self._of("speed"), self._of("step")),
            lambda: (self._of("x"), self._of("z"), self._of("yaw")),
            lambda: ground(self._of("x"), self._of("z")),
            legs=lambda: np.array([self._of(each) for each in JOINTS]),
            phase=lambda: self._of("phase"),
            step=step,
        )

    def follow(self, orders: Mapping[str, object]) -> None:
        """Take the task's numbers of this frame, and stand where they say."""
        follow_numbers(self._now, orders)
        stand(self._node, (self._of("x"), self._of("y"), self._of("z")), self._of("yaw"), self._ahead)

    def _of(self, word: str) -> float:
        return self._now[f"{self._name}.{word}"]
