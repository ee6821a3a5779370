"""Sound emitters of a scene, their occlusion, and the reverberation of the listener's room, frame by frame.

A walker is an entity that moves; its footsteps are triggers. Its step length grows with the root of its speed, so they
follow its movement in time and place. Avatars emit the same `SoundTrigger` from the contacts of their feet.
"""

from __future__ import annotations

from math import exp, hypot, sqrt

import numpy as np

from mimics_app.contracts.arrays import F8, Vec3
from mimics_app.contracts.messages.stage_messages import SoundTrigger
from mimics_app.rendering.audio.obstacles import Box, passes_of
from mimics_app.world.components.visible import SoundObstacle, SoundRoom, Walker
from mimics_app.world.content.world import World
from mimics_app.world.files.scene.scene import Scene

__all__ = ["GaitClock", "SoundSurroundings"]


_RAMP_S = 0.03
"""Time constant of a change of occlusion [s], so that a sound behind an edge fades instead of jumping."""


_LENGTH_AT_ONE = 0.66
"""Step length at 1 m/s [m]; it grows with the root of the speed (Grieve 1968)."""

_SLOWEST = 0.05
"""Lowest speed at which steps are triggered [m/s]."""


class GaitClock:
    """Step counter of one walker.

    Args:
        material: Material of the ground, for the trigger.
        strength: Linear factor on the level of the steps.
    """

    def __init__(self, material: str, strength: float = 1.0) -> None:
        self._material = material
        self._strength = strength
        self._phase = 0.0
        self._before: tuple[int, Vec3] | None = None

    def step(self, t_ns: int, place: Vec3) -> list[SoundTrigger]:
        """Return the heel strikes since the last call, each with its time and place; call once per frame.

        Args:
            t_ns: Session time [ns].
            place: Position of the walker's feet in the world, +y up [m].
        """
        before, self._before = self._before, (t_ns, place)
        if before is None or t_ns <= before[0]:
            return []
        begin_ns, (x, y, z) = before
        distance = hypot(place[0] - x, place[2] - z)
        span_ns = t_ns - begin_ns
        speed = distance / (span_ns * 1e-9)
        if speed < _SLOWEST:
            return []
        advance = distance / (_LENGTH_AT_ONE * sqrt(speed))  # in steps
        done, self._phase = self._phase, self._phase + advance
        triggers = []
        for number in range(int(done) + 1, int(self._phase) + 1):
            share = (number - done) / advance
            at = (x + share * (place[0] - x), y + share * (place[1] - y), z + share * (place[2] - z))
            when = begin_ns + round(share * span_ns)
            triggers.append(SoundTrigger("step", when, at, self._material, self._strength))
        self._phase -= int(self._phase)
        return triggers


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
