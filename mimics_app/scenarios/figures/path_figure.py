"""A figure on a ground path: its node, the legs of its model, and the ground it treads on."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.scenarios.figures.walking_figure import add_walk, below, pace_at, stand
from mimics_app.tasks.walking.walker import FigurePose
from mimics_app.world.components.walking import PathWalker, WalkingPath
from mimics_app.world.content.world import World
from mimics_app.world.graph.scene_node import SceneNode

__all__ = ["GroundPath", "PathFigure"]

_BEHIND, _AHEAD = 0.4, 1.6
"""Points of the path whose chord is the heading of a walker [m]: somebody turns before a corner, not in it."""


class GroundPath:
    """A path of a scene.

    Args:
        path: The component.

    Attributes:
        length: Length from the first corner to the last, or once round [m].
    """

    def __init__(self, path: WalkingPath) -> None:
        corners = np.array([*path.points, path.points[0]] if path.closed else path.points, np.float64)
        self._corners, self._closed = corners, path.closed
        self._ends = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(corners, axis=0), axis=1))])
        self._grounds = path.grounds or ("",)
        self.length = float(self._ends[-1])

    def at(self, s: float) -> F8:
        """Return the point at a distance along the path [m], shape [3]; before and beyond it, its end."""
        s = self._within(s)
        return np.array([np.interp(s, self._ends, self._corners[:, axis]) for axis in range(3)])

    def heading(self, s: float) -> float:
        """Return the heading of a walker at a distance along the path [rad], about +y from +z."""
        if not self._closed:  # the chord keeps its length at both ends
            s = min(max(s, _BEHIND), self.length - _AHEAD)
        x, _, z = self.at(s + _AHEAD) - self.at(s - _BEHIND)
        return math.atan2(x, z)

    def ground(self, s: float) -> str:
        """Return the material of the ground at a distance along the path [m]."""
        leg = int(np.searchsorted(self._ends[1:-1], self._within(s), side="right"))
        return self._grounds[min(leg, len(self._grounds) - 1)]

    def _within(self, s: float) -> float:
        return s % self.length if self._closed else min(max(s, 0.0), self.length)


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
