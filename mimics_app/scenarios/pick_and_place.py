"""Pick and place (D2.1 3.2.3): an apple falls beside a stall; it is gripped, carried and set down at the mark."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import count, takewhile
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.errors import SceneError
from mimics_app.contracts.messages.orders import Feature, HapticField, HapticOrder
from mimics_app.contracts.messages.stage_messages import Aim, HapticSnapshot, TaskOrders
from mimics_app.contracts.messages.trial_state import TrialState
from mimics_app.contracts.ports.scenario_port import Scenario, TaskContext
from mimics_app.rendering.haptic.scene_objects import objects_of_scene
from mimics_app.scenarios.parts.body_nodes import BodyNodes
from mimics_app.scenarios.parts.pick_plan import Percept, Picker
from mimics_app.scenarios.parts.robot_scene import robot_block, robot_facts, start_at, triple
from mimics_app.scenarios.parts.shown_hand import ShownHand, half_height
from mimics_app.tasks.kinds.carry.spec import CarrySpec
from mimics_app.tasks.scene_section import section_of
from mimics_app.world.content.extent import world_extent
from mimics_app.world.content.world import World
from mimics_app.world.files.scene.scene import Scene
from mimics_app.world.graph.scene_node import SceneNode

__all__ = ["SCENARIO", "PickAndPlace"]

_HELP = "help"
"""Id of the effect that guides the hand, where the scene has one."""

_HELP_STEP = 0.03
"""Step in which the guiding effect follows its target [m]: each needs a new parameter block."""

_HELP_STIFFNESS, _HELP_AT = HapticField("stiffness", "effects", _HELP), HapticField("position", "effects", _HELP)

_OBSTACLES = Feature("obstacles", 0.0)
"""Number of obstacles."""
_MARK = Feature("mark", 0.0)
"""Radius of the mark [m]."""


class PickAndPlace(Scenario):
    """Hand, bodies, mark and obstacles of the scene.

    Args:
        scene: The checked scene; needs a robot, an entity with `grasping_hand`, and a task that carries something.
        world: The world built from it.

    Raises:
        SceneError: something the scenario needs is missing.
    """

    def __init__(self, scene: Scene, world: World) -> None:
        self._scene = scene
        self._world = world
        self._carry = section_of(scene, CarrySpec)
        self._objects = objects_of_scene(scene)
        self._bodies = BodyNodes(world, self._objects.body_entities)
        self._hand = ShownHand(scene, world)
        self._start = self._hand.node.world_matrix()[:3, 3].copy()
        self._mark_node = world.find(self._carry.to)
        self._mark = triple(self._mark_node.world_matrix()[:3, 3])
        self._row = self._row_of_body()
        self._half_height = half_height(self._objects, self._row)
        self._picker = Picker(self._mark, self._half_height, self._carry.within)
        self._guided_to: NDArray[np.float64] | None = None
        self._helps = False
        self._reached: bool | None = None

    @property
    def task_context(self) -> TaskContext:
        joints, home = start_at(self._scene, self._start)
        return TaskContext(joints, home, self._objects.body_entities, {self._carry.to: self._mark})

    @property
    def via_points_world(self) -> NDArray[np.float64]:
        return np.zeros((0, 3))

    @property
    def facts(self) -> Mapping[str, Any]:
        grip = self._carry.grip
        return {
            "carry": {
                "body": self._carry.body,
                "row": self._row,
                "mark_world": self._mark,
                "above_m": self._half_height,
                "within_m": self._carry.within,
                "grasp_n": [grip.least, grip.most],
                "obstacles": self._outlines(),
            },
            **robot_facts(self._scene),
        }

    def scene_block(self) -> NDArray[Any]:
        return robot_block(self._scene)

    def apply(self, orders: TaskOrders, snapshot: HapticSnapshot) -> None:
        self._bodies.follow(snapshot.poses)
        self._guide(orders, snapshot)
        self._hand.follow(snapshot, self._objects)
        self._show_mark(orders, snapshot)
        obstacles = orders.visual.get(_OBSTACLES)
        if obstacles is not None:
            self._show_obstacles(round(obstacles))

    def aim(self, snapshot: HapticSnapshot) -> Aim | None:
        if not snapshot.poses[self._row, 3:7].any():
            return None
        hand, body = triple(snapshot.hip_world), triple(snapshot.poses[self._row])
        return self._picker.aim(Percept(snapshot.t_ns * 1e-9, hand, body, snapshot.held_body == self._row))

    @staticmethod
    def features(scene: Scene) -> Sequence[Feature[Any]]:
        return (_OBSTACLES, _MARK)

    def haptic_orders(self) -> HapticOrder:
        return HapticOrder() if self._guided_to is None else HapticOrder({_HELP_AT: triple(self._guided_to)})

    def _guide(self, orders: TaskOrders, snapshot: HapticSnapshot) -> None:
        """Let the guiding effect pull to the object, then above the mark; while it is off its target is unchanged.

        Before the go it rests at the start, and at the hand until a force is felt: the soft start waits for small ones.
        """
        stiffness = orders.haptic.numbers.get(_HELP_STIFFNESS)
        if isinstance(stiffness, int | float):
            self._helps = float(stiffness) > 0.0
        if not self._helps or _HELP not in self._objects.effect_entities:
            return
        target = self._goal_of_help(orders, snapshot)
        if self._guided_to is None or np.linalg.norm(target - self._guided_to) >= _HELP_STEP:
            self._guided_to = target

    def _goal_of_help(self, orders: TaskOrders, snapshot: HapticSnapshot) -> NDArray[np.float64]:
        if orders.view.state is not TrialState.TRAVEL:
            return self._start
        if snapshot.ramp == 0.0:
            return snapshot.hip_world.copy()
        if snapshot.held_body == self._row:
            return np.array(self._mark) + [0.0, 2.0 * self._half_height, 0.0]
        return snapshot.poses[self._row, :3].copy()

    def _row_of_body(self) -> int:
        if self._carry.body not in self._objects.body_entities:
            what = f'"{self._carry.body}" is not a movable haptic object'
            raise SceneError(self._scene.issue("/task/carry/body", what, 'give it a "haptic_object" with grip'))
        return self._objects.body_entities.index(self._carry.body)

    def _show_mark(self, orders: TaskOrders, snapshot: HapticSnapshot) -> None:
        """Scale the mark to the radius that counts as placed, and highlight it while the object is above it."""
        within = orders.visual.get(_MARK)
        if within is not None:
            self._picker.within = within
            share = within / self._carry.within
            self._mark_node.set_scale((share, 1.0, share))
        x, y, z = snapshot.poses[self._row, :3]
        level = float(np.hypot(x - self._mark[0], z - self._mark[2]))
        over = level <= self._picker.within and y > self._mark[1]
        if over != self._reached:
            self._reached = over
            for node in self._mark_node.children:
                _dress(node, self._world, "mark_reached" if over else "mark", f"{self._carry.to}_")

    def _outlines(self) -> list[list[float]]:
        """Return left, bottom, right, top of each obstacle in the frontal plane, world [m]."""
        self._world.update()
        boxes = (world_extent(self._world, self._world.find(name).index) for name in self._obstacles())
        return [[*box[0][:2].tolist(), *box[1][:2].tolist()] for box in boxes if box is not None]

    def _obstacles(self) -> Iterator[str]:
        """Yield the entities named obstacle_1, obstacle_2 and so on."""
        return takewhile(self._world.__contains__, (f"obstacle_{number}" for number in count(1)))

    def _show_obstacles(self, shown: int) -> None:
        """Show the first obstacles."""
        for number, name in enumerate(self._obstacles()):
            self._world.find(name).visible = number < shown


def _dress(node: SceneNode, world: World, material: str, prefix: str) -> None:
    """Give a node another material of the scene: MATERIAL, or MATERIAL_REST for an entity called PREFIX + REST."""
    rest = node.name.removeprefix(prefix)
    name = f"{material}_{rest}" if f"{material}_{rest}" in world.materials else material
    if node.entity is not None and name in world.materials:
        node.entity.set_material(name)


SCENARIO = PickAndPlace
