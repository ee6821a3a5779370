"""Sound emitters of a scene, their occlusion, and the reverberation of the listener's room, frame by frame."""

from __future__ import annotations

from math import exp

import numpy as np

from mimics_app.app.cues.gait_clock import GaitClock
from mimics_app.contracts.arrays import F8
from mimics_app.contracts.messages.stage_messages import SoundTrigger
from mimics_app.rendering.audio.obstacles import Box, passes_of
from mimics_app.world.components.visible import SoundObstacle, SoundRoom, Walker
from mimics_app.world.content.world import World
from mimics_app.world.files.scene.scene import Scene

__all__ = ["SoundSurroundings"]


_RAMP_S = 0.03
"""Time constant of a change of occlusion [s], so that a sound behind an edge fades instead of jumping."""


class SoundSurroundings:
    """Obstacles, rooms and walkers of a scene.

    Args:
        scene: The scene of the components.
        emitters: Number of sound emitters.
    """

    def __init__(self, scene: Scene, emitters: int) -> None:
        self._obstacles = [(name, obstacle) for name, obstacle, _ in scene.components(SoundObstacle)]
        self._rooms = [(name, room) for name, room, _ in scene.components(SoundRoom)]
        self._walkers = [
            (name, GaitClock(walker.material, walker.strength)) for name, walker, _ in scene.components(Walker)
        ]
        self._passes = np.ones((emitters, 3))
        self._fresh = True

    def passes(self, world: World, head: F8, sources: F8, span: float) -> F8:
        """Return the linear gain of each source after occlusion, by frequency band, shape [n, 3].

        Args:
            world: World with the present poses of the obstacles.
            head: Position of the listener [m], shape [3].
            sources: Positions of the sources [m], shape [n, 3].
            span: Time since the last frame, over which the gain is ramped [s].
        """
        boxes = [
            Box(world.find(name).world_matrix(), 0.5 * np.array(obstacle.size), obstacle.surface_mass)
            for name, obstacle in self._obstacles
            if name in world
        ]
        if boxes:
            wanted = np.array([passes_of(head, source, boxes) for source in sources]).reshape(-1, 3)
            self._passes += (wanted - self._passes) * (1.0 if self._fresh else 1.0 - exp(-span / _RAMP_S))
            self._fresh = False
        return self._passes

    def steps(self, world: World, now_ns: int) -> list[SoundTrigger]:
        """Return the heel strikes of the scene's walkers since the last frame."""
        triggers: list[SoundTrigger] = []
        for name, gait in self._walkers:
            if name in world:
                x, y, z = (float(value) for value in world.find(name).world_matrix()[:3, 3])
                triggers += gait.step(now_ns, (x, y, z))
        return triggers

    def room(self, world: World, head: F8) -> tuple[float, float]:
        """Return level and decay time [s] of the reverberation at the listener, those of the loudest room."""
        reverbs = [(_inside(world, name, room, head) * room.level, room.time) for name, room in self._rooms]
        return max(reverbs, default=(0.0, 1.0))


def _inside(world: World, name: str, room: SoundRoom, head: F8) -> float:
    """Return 1 well inside a room, falling to 0 at its walls and outside."""
    if name not in world:
        return 0.0
    pose = world.find(name).world_matrix()
    local = np.linalg.solve(pose, np.append(head, 1.0))[:3]
    depth = float((0.5 * np.array(room.size) - np.abs(local)).min())
    return float(np.clip(depth / room.border, 0.0, 1.0))
