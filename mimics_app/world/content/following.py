"""Followers: nodes that keep their place beside another node and look at it."""

from __future__ import annotations

import math

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.maths import mat, quat
from mimics_app.world.components.follow import Follow
from mimics_app.world.graph.scene_graph import SceneGraph

__all__ = ["Follower"]

_REPOSITIONED = 5.0
"""Distance between a follower and its place from which it is put there at once [m]: the followed one was put back."""

_TOUCHING = 1e-6
"""Distance from what a follower looks at below which it keeps its orientation [m]."""


class Follower:
    """One node that follows another one.

    Args:
        name: Name of the node that follows; it is below the root.
        spec: Whom, where and how closely.
    """

    def __init__(self, name: str, spec: Follow) -> None:
        self._name, self._spec = name, spec
        self._place: F8 = np.full(3, np.nan)
        self._aim: F8 = np.full(3, np.nan)
        self._time = 0.0

    def step(self, graph: SceneGraph, time: float) -> None:
        """Place the node for a scene time [s], at which the followed node is where the graph has it."""
        elapsed, self._time = time - self._time, time
        if self._name not in graph or self._spec.entity not in graph:
            return
        place, aim = self._wanted(graph)
        share = self._share(elapsed)
        if not np.linalg.norm(place - self._place) < _REPOSITIONED:  # also before the first step
            share = 1.0
            self._place, self._aim = place, aim
        self._place = self._place + share * (place - self._place)
        self._aim = self._aim + share * (aim - self._aim)
        index, turn = graph.find(self._name), np.empty(4)
        graph.transforms.set_translation(index, self._place)
        if np.linalg.norm(self._aim - self._place) > _TOUCHING:
            quat.from_matrix(mat.look_at(self._place, self._aim)[:3, :3], turn)
            graph.transforms.set_rotation(index, turn)

    def _wanted(self, graph: SceneGraph) -> tuple[F8, F8]:
        """Return where the follower belongs and what it looks at, world [m], float64 [3] each."""
        pose = graph.world_matrix(graph.find(self._spec.entity))
        turn = _heading(pose) if self._spec.turns else np.eye(3)
        offsets = np.array([self._spec.offset, self._spec.aim])
        place, aim = offsets @ turn.T + pose[:3, 3]
        if self._spec.within is not None:
            corners = np.array(self._spec.within)
            place = np.clip(place, corners.min(axis=0), corners.max(axis=0))
        if self._spec.at is not None and self._spec.at in graph:
            aim = graph.world_matrix(graph.find(self._spec.at))[:3, 3].copy()
        return place, aim

    def _share(self, elapsed: float) -> float:
        """Return the share of the way to its place that a follower goes in a time [s]: a first-order lag."""
        lag = self._spec.lag
        return 1.0 if lag == 0.0 else 1.0 - float(np.exp(-max(elapsed, 0.0) / lag))


def _heading(pose: F8) -> F8:
    """Return the rotation about +y that turns +z into the direction of a pose's z axis, float64 [3, 3]."""
    angle = math.atan2(pose[0, 2], pose[2, 2])
    sine, cosine = math.sin(angle), math.cos(angle)
    return np.array([[cosine, 0.0, sine], [0.0, 1.0, 0.0], [-sine, 0.0, cosine]])
