"""Sound emitters of a scene, their occlusion, and the reverberation of the listener's room, frame by frame."""

from __future__ import annotations

from math import exp

import numpy as np

from mimics_app.app.cues.gait_clock import GaitClock
from mimics_app.contracts.arrays import F8
from mimics_app.contracts.messages import SoundTrigger
from mimics_app.rendering.audio.obstacles import Box, passes_of
from mimics_app.world.components.visible import SoundObstacle, SoundRoom, Walker
from mimics_app.world.scene.scene import Scene
from mimics_app.world.world import World

__all__ = ["SoundSurroundings"]


_RAMP_S = 0.03
"""Time constant with which an obstacle takes effect [s]: nothing snaps behind an edge."""


class SoundSurroundings:
    """Obstacles, rooms and walkers of a scene.

    Args:
        scene: Whose components they are.
        emitters: How many sounds play from places.
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
        """Return each source's linear gain after occlusion, by band, ramped over the time since the last frame [s].

        Args:
            world: Where the obstacles are now.
            head: Position of the listener [m], shape [3].
            sources: Positions [m], shape [n, 3].
            span: [s].
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
        """Heel contacts of the scene's walkers since the last frame."""
        triggers: list[SoundTrigger] = []
        for name, gait in self._walkers:
            if name in world:
                x, y, z = (float(value) for value in world.find(name).world_matrix()[:3, 3])
                triggers += gait.step(now_ns, (x, y, z))
        return triggers

    def room(self, world: World, head: F8) -> tuple[float, float]:
        """Return level and time [s] of the reverberation at the listener, in the loudest room."""
        heard = [(_inside(world, name, room, head) * room.level, room.time) for name, room in self._rooms]
        return max(heard, default=(0.0, 1.0))


def _inside(world: World, name: str, room: SoundRoom, head: F8) -> float:
    """Return 1 well inside a room, falling to 0 at its walls and outside."""
    if name not in world:
        return 0.0
    pose = world.find(name).world_matrix()
    local = np.linalg.solve(pose, np.append(head, 1.0))[:3]
    depth = float((0.5 * np.array(room.size) - np.abs(local)).min())
    return float(np.clip(depth / room.border, 0.0, 1.0))
