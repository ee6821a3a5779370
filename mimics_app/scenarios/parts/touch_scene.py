"""Scenario of scenes without code of their own: bodies move entities, the ball follows the HIP, paths are shown."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.errors import SceneError
from mimics_app.contracts.loop.gait_state import GaitState
from mimics_app.contracts.messages.stage_messages import HapticSnapshot, TaskOrders
from mimics_app.contracts.ports.scenario_port import Scenario, TaskContext
from mimics_app.rendering.haptic.devices.robot_reach import Reach
from mimics_app.rendering.haptic.scene_effects import curve_of_path
from mimics_app.rendering.haptic.scene_objects import objects_of_scene
from mimics_app.scenarios.parts.body_nodes import BodyNodes
from mimics_app.scenarios.parts.next_station import NextStation
from mimics_app.scenarios.parts.robot_scene import SPACING, Places, even_points, robot_block, robot_facts, start_at
from mimics_app.scenarios.parts.shown_hand import ShownHand
from mimics_app.tasks.scene_section import task_of
from mimics_app.tasks.task import PointGoal
from mimics_app.world.components.animation import Avatar
from mimics_app.world.components.hand import GraspingHand
from mimics_app.world.components.objects import HapticObject, HapticPath, InteractionPoints
from mimics_app.world.components.orthosis_view import OrthosisView
from mimics_app.world.components.robot import Ball, Patient, Robot
from mimics_app.world.content.meshes.primitives import tube
from mimics_app.world.content.world import World
from mimics_app.world.files.scene.placing import pose_of
from mimics_app.world.files.scene.scene import Scene

__all__ = ["TouchScene"]

_FREE = (GaitState.LEG_RELEASED, GaitState.EXPLORING)
"""States in which the lamps of the free leg shine."""


class OrthosisNodes:
    """Marks and lamps of the scene's `orthosis_view`; without one nothing.

    Args:
        scene: The checked scene.
        world: The world built from it.
    """

    def __init__(self, scene: Scene, world: World) -> None:
        self._view = scene.first(OrthosisView)
        view = self._view or OrthosisView()
        self._marks = [(node, np.array(node.position)) for node in map(world.find, view.marks)]
        self._lamps = [[world.find(name) for name in names] for names in (view.left_lamps, view.right_lamps)]
        self._lit = -1

    def follow(self, snapshot: HapticSnapshot) -> None:
        """Place the marks where the belt has brought them, and light the lamps of the leg that is free."""
        view = self._view
        if view is None:
            return
        behind, ahead = view.belt
        for node, place in self._marks:
            z = behind + (place[2] - behind - snapshot.belt_travel) % (ahead - behind)
            node.set_position((place[0], place[1], z))
        lit = snapshot.free_leg if snapshot.gait_state in _FREE else -1
        if lit != self._lit:
            self._lit = lit
            for leg, nodes in enumerate(self._lamps):
                material = view.lit if leg == lit else view.dark
                for node in nodes:
                    if node.entity is not None and material is not None:
                        node.entity.set_material(material)


_PATH_SIDES = 8
_RINGS_PER_PIECE = 16
_INSIDE = 0.97
"""Share of the joint range that a simulated person uses."""


class TouchScene(Scenario):
    """Everything that components alone say (D2.1 4.2.12).

    A trial begins where the entity with the `ball` stands. The simulated person goes to the entities its component
    names, in turn; without names along the paths, else to every haptic object; then to the points of the task's goals.

    Args:
        scene: The checked scene; needs a `robot`.
        world: The world built from it.

    Raises:
        SceneError: there is no robot, or an object or path cannot be made.
    """

    def __init__(self, scene: Scene, world: World) -> None:
        self._scene = scene
        self._world = world
        self._robot = scene.one(Robot)[1]
        self._reach = Reach(self._robot)
        self._objects = objects_of_scene(scene)
        self._bodies = BodyNodes(world, self._objects.body_entities)
        balls = scene.components(Ball)
        self._ball = world.find(balls[0][0]) if balls else None
        self._start = pose_of(scene, balls[0][0])[0] if balls else np.array(self._robot.robot_to_world.translation)
        points = scene.first(InteractionPoints)
        self._points = [
            (world.find(point.entity), self._contact(point.contact), np.array(point.offset))
            for point in (points.points if points else ())
            if point.entity is not None
        ]
        self._hand = ShownHand(scene, world) if scene.has(GraspingHand) else None
        self._worn = self._wears_device()
        self._orthosis = OrthosisNodes(scene, world)
        self._show_paths()
        patient = scene.first(Patient)
        visits = patient.visits if patient is not None else ()
        self._goals = [goal for goal in task_of(scene).goals if isinstance(goal, PointGoal)]
        aims = [(goal.position_world, goal.within) for goal in self._goals]
        self._next = NextStation(scene, world, visits, balls[0][0] if balls else "", aims)

    @property
    def task_context(self) -> TaskContext:
        joints, home = start_at(self._scene, self._start)
        return TaskContext(joints, home, self._objects.body_entities, Places(self._scene))

    @property
    def via_points_world(self) -> NDArray[np.float64]:
        path = [self._start, *(self._reachable(point) for point in self._stations())]
        return _evenly(np.array(path))

    @property
    def facts(self) -> Mapping[str, Any]:
        return {"bodies": list(self._objects.body_entities), **robot_facts(self._scene)}

    def scene_block(self) -> NDArray[Any]:
        return robot_block(self._scene)

    def apply(self, orders: TaskOrders, snapshot: HapticSnapshot) -> None:
        self._bodies.follow(snapshot.poses)
        self._orthosis.follow(snapshot)
        self._next.follow(snapshot.hip_world)
        if self._ball is not None:
            self._ball.set_position(snapshot.hip_world)
            self._ball.set_scale((snapshot.ball_radius,) * 3)
        if self._hand is not None:
            self._hand.follow(snapshot, self._objects)
        if self._worn:
            self._world.motion.joints = snapshot.q
        for node, contact, offset in self._points:
            node.set_position(snapshot.points[contact].hip_world + offset)

    def _wears_device(self) -> bool:
        """Return whether a person's legs turn by the joints of the device.

        Raises:
            SceneError: the device is no gait orthosis.
        """
        from mimics_app.world.content.motion.worn_legs import JOINTS

        for _, avatar, pointer in self._scene.components(Avatar):
            if avatar.joints:
                if len(self._reach.descriptor.joints) != JOINTS:
                    what = f"{self._robot.device} has not the joints of two legs"
                    raise SceneError(self._scene.issue(f"{pointer}/joints", what, "remove it, or take another device"))
                return True
        return False

    def _contact(self, name: str | None) -> int:
        """Number of a point of contact of the device."""
        return 0 if name is None else self._reach.descriptor.contacts.index(name)

    def _stations(self) -> list[NDArray[np.float64]]:
        """Return the stations of the simulated person in order [m]."""
        patient = self._scene.first(Patient)
        names = patient.visits if patient is not None else ()
        paths = [entity for entity, _, _ in self._scene.components(HapticPath)]
        if not names and not paths:
            names = tuple(entity for entity, _, _ in self._scene.components(HapticObject))
        points: list[NDArray[np.float64]] = []
        for name in names or paths:
            if name in paths:
                points += list(even_points(curve_of_path(self._scene, name)))
            else:
                points.append(pose_of(self._scene, name)[0])
        points += [np.array(goal.position_world) for goal in self._goals]
        return points

    def _reachable(self, point: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the point itself, or the reachable point nearest to it in joint space [m]."""
        robot, limits = self._robot, self._reach.limits
        q, _ = self._reach.joints(self._reach.from_world(point))
        x = self._reach.points(_inside(q, np.array(limits.lowest), np.array(limits.highest)))[0]
        R, origin = np.array(robot.robot_to_world.rotation), np.array(robot.robot_to_world.translation)
        world: NDArray[np.float64] = R @ x + origin
        return world

    def _show_paths(self) -> None:
        """Draw a line along each path that has a material."""
        for entity, path, _ in self._scene.components(HapticPath):
            if path.material is None:
                continue
            curve = curve_of_path(self._scene, entity)
            s = np.linspace(0.0, len(curve.pieces), len(curve.pieces) * _RINGS_PER_PIECE + 1)
            _, n, b = curve.frame(s)
            name = f"{entity} line"
            radii = np.full(s.size, path.shown_radius)
            self._world.replace_mesh(name, tube(curve.point(s), n, b, radii, sides=_PATH_SIDES))
            node = self._world.find(name) if name in self._world else self._world.root.create_child(name)
            if node.entity is None:
                node.show([(name, path.material)])
            else:
                node.entity.set_material(path.material)


def _inside(q: NDArray[np.float64], low: NDArray[np.float64], high: NDArray[np.float64]) -> NDArray[np.float64]:
    """Joints brought into the inner part of their range."""
    return np.clip(q, np.where(low < 0.0, _INSIDE * low, low), np.where(high > 0.0, _INSIDE * high, high))


def _evenly(corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return points of a polyline at distances of about `SPACING`, its corners included, shape [n, 3]."""
    points = [corners[0]]
    for start, end in itertools.pairwise(corners):
        steps = max(1, round(float(np.linalg.norm(end - start)) / SPACING))
        points += [start + (end - start) * (k + 1) / steps for k in range(steps)]
    path: NDArray[np.float64] = np.array(points)
    return path
