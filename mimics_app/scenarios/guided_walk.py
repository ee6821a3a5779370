"""Guided walk (D2.1 3.4.2): the person's view and own body in an alley, and an avatar that brings them to a place."""

from __future__ import annotations

import numpy as np

from mimics_app.contracts.errors import SceneError
from mimics_app.contracts.messages import HapticSnapshot, TaskOrders
from mimics_app.scenarios.touch_scene import TouchScene
from mimics_app.tasks.kinds.guided_walk import GuidedWalkSpec
from mimics_app.tasks.scene_section import task_of
from mimics_app.world.scene.scene import Scene
from mimics_app.world.scene_node import SceneNode
from mimics_app.world.world import World

__all__ = ["GuidedWalk"]

_TURN = 0.06
"""Share of a turn towards the avatar that is made in a frame."""
_ARM_RAISED = 2.3
_ARM_POINTS = 1.45
"""Angles of the avatar's arm from hanging down [rad]."""
_BECKON, _POINT = 4, 5


class GuidedWalk(TouchScene):
    """An alley along -z; places along it are metres from where the walk begins.

    Args:
        scene: The checked scene; needs a robot and a task with `guided_walk`.
        world: The world built from it.

    Raises:
        SceneError: the task has no guided walk.
    """

    def __init__(self, scene: Scene, world: World) -> None:
        super().__init__(scene, world)
        spec = task_of(scene).section("guided_walk")
        if not isinstance(spec, GuidedWalkSpec):
            raise SceneError(scene.issue("/task", "it has no guided_walk", 'write "guided_walk": {"avatar": ...}'))
        self._person, self._avatar = world.find(spec.person), world.find(spec.avatar)
        self._arm = world.find(f"{spec.avatar}_arm") if f"{spec.avatar}_arm" in world else None
        self._places = {"walk.person": 0.0, "walk.avatar": -2.5, "walk.deed": 3.0}
        self._yaw = 0.0
        self._swing = 0.0

    def apply(self, orders: TaskOrders, snapshot: HapticSnapshot) -> None:
        super().apply(orders, snapshot)
        for name in self._places:
            value = orders.visual.get(name)
            if isinstance(value, int | float):
                self._places[name] = float(value)
        person, avatar = self._places["walk.person"], self._places["walk.avatar"]
        side = 1.0 if avatar >= person else -1.0
        self._yaw += _TURN * ((0.0 if side > 0.0 else np.pi) - self._yaw)
        _place(self._person, person, self._yaw)
        _place(self._avatar, avatar, 0.0 if side < 0.0 else np.pi)
        self._move_arm(round(self._places["walk.deed"]), snapshot.t_ns)

    def _move_arm(self, deed: int, t_ns: int) -> None:
        """Beckoning waves, pointing points, else the arm hangs."""
        if self._arm is None:
            return
        aim = 0.05
        if deed == _BECKON:
            aim = _ARM_RAISED + 0.35 * np.sin(t_ns * 1e-9 * 7.0)
        elif deed == _POINT:
            aim = _ARM_POINTS
        self._swing += 0.15 * (aim - self._swing)
        self._arm.set_orientation(np.array([np.sin(self._swing / 2), 0.0, 0.0, np.cos(self._swing / 2)]))


def _place(node: SceneNode, along: float, yaw: float) -> None:
    """A node along the alley, turned about the vertical; its height is kept."""
    height = float(node.world_matrix()[1, 3])
    node.set_position(np.array([0.0, height, -along]))
    node.set_orientation(np.array([0.0, np.sin(yaw / 2), 0.0, np.cos(yaw / 2)]))
