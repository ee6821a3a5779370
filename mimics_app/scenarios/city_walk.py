"""City walk (D2.1 Table 1): the person's view and own body on a path through a town, and the people they meet."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.messages.orders import Feature, Shown
from mimics_app.contracts.messages.stage_messages import Aim, HapticSnapshot, TaskOrders
from mimics_app.contracts.messages.trial_state import TrialState
from mimics_app.maths import quat
from mimics_app.scenarios.figures.kicking_leg import add_kick
from mimics_app.scenarios.figures.path_figure import GroundPath, PathFigure
from mimics_app.scenarios.figures.walking_figure import below, see_past_head
from mimics_app.scenarios.parts.touch_scene import TouchScene
from mimics_app.scenarios.parts.weather import WEATHER, Weather
from mimics_app.tasks.kinds.city_walk.kind import ALONG, LOOKS, OPENED, SPEED, STOPPED, TAPPING, CityWalkSpec
from mimics_app.tasks.kinds.city_walk.street_obstacles import StreetObstacle
from mimics_app.tasks.scene_section import section_of
from mimics_app.tasks.walking.walker import PERSON
from mimics_app.world.components.visible import CameraComponent
from mimics_app.world.components.walking import PathWalker, WalkingPath
from mimics_app.world.content.world import World
from mimics_app.world.files.scene.scene import Scene
from mimics_app.world.graph.scene_node import SceneNode

__all__ = ["SCENARIO", "CityWalk", "StreetObject"]


_SINKS = {"kerb": 0.0, "box": 0.5, "low_wall": 0.6, "door": 0.0}
"""How deep each sinks into the ground to let the person pass [m]; a kerb is stepped over, a door swings."""
_SWINGS = -0.5 * math.pi
"""Angle of an open door [rad]: it swings away from who stands before it."""


class StreetObject:
    """A node across a path; the model's front is its plane z = 0, which looks along -z, and a door's hinge x = 0.

    Args:
        node: Its node.
        path: The path.
        obstacle: Its place and kind.
        frame: What is placed there and stays; None for nothing.
    """

    def __init__(
        self, node: SceneNode, path: GroundPath, obstacle: StreetObstacle, frame: SceneNode | None = None
    ) -> None:
        self._node, self._kind = node, obstacle.kind
        self._place, self._heading = path.at(obstacle.at), path.heading(obstacle.at)
        self._hinge = np.array(node.position)
        if frame is not None:
            frame.set_position(self._place)
            frame.set_orientation(quat.about_axis((0.0, 1.0, 0.0), self._heading))
        self.open(0.0)

    def open(self, share: float) -> None:
        """Show it open by a share, 0 to 1."""
        c, s = math.cos(self._heading), math.sin(self._heading)
        x, y, z = self._hinge  # where the entity stands beside the path, in the frame of the walker
        down = share * _SINKS[self._kind]
        self._node.set_position(self._place + (c * x + s * z, y - down, c * z - s * x))
        turn = share * _SWINGS if self._kind == "door" else 0.0
        self._node.set_orientation(quat.about_axis((0.0, 1.0, 0.0), self._heading + turn))


_GAZE_PER_METRE = 8.0
"""Angle of the eyes per displacement of the hand to the side [rad/m]."""
_TOUCHES_S = 1.5
"""Time from one touch of an obstacle by a simulated hand to the next [s]."""
_MOST_GAZE = 1.2
"""Largest angle of the eyes to the side [rad]."""


class CityWalk(TouchScene):
    """A walk through a town. The hand moves in the frame of the person: up is faster, to the side looks about.

    Walkers that accompany the person follow the person's pace; the others walk at their own speed all the time.

    Args:
        scene: The checked scene; needs a robot and a task with `city_walk`.
        world: The world built from it.

    Raises:
        SceneError: the task has no city walk.
    """

    def __init__(self, scene: Scene, world: World) -> None:
        super().__init__(scene, world)
        spec = section_of(scene, CityWalkSpec)
        paths = {name: GroundPath(path) for name, path, _ in scene.components(WalkingPath)}
        walkers = {name: walker for name, walker, _ in scene.components(PathWalker)}
        self._walk = Shown((PERSON, ALONG, SPEED, OPENED, TAPPING, STOPPED, LOOKS))
        figures = {}
        for name, walker in walkers.items():
            ahead, own = (-1.0, lambda: self._walk[PERSON]) if name == spec.person else (1.0, None)
            figures[name] = PathFigure(world, world.find(name), walker, paths[walker.path], ahead, own)
        led = {spec.person, *(name for name, walker in walkers.items() if walker.beside == spec.person)}
        self._led = [figures[name] for name in walkers if name in led]
        self._others = [(figures[name], walkers[name].speed) for name in walkers if name not in led]
        self._person = world.find(spec.person)
        add_kick(below(self._person, world.motion.animators), figures[spec.person].walk, lambda: self._walk[TAPPING])
        see_past_head(world.cameras, self._person)
        self._weather = Weather(world, self._person)
        path = paths[walkers[spec.person].path]
        self._obstacles = [
            (number, StreetObject(world.find(each.entity), path, each, world.find(each.frame) if each.frame else None))
            for number, each in enumerate(spec.obstacles)
            if each.entity in world
        ]
        self._eyes = [
            (node, np.array(node.orientation))
            for name, _, _ in scene.components(CameraComponent)
            if (parent := (node := world.find(name)).parent) is not None and parent.index == self._person.index
        ]

    @property
    def via_points_world(self) -> NDArray[np.float64]:
        return np.array([self._start]) if self._obstacles else super().via_points_world  # else see `aim`

    def hand_frame(self) -> NDArray[np.float64]:
        return self._person.world_matrix()

    def apply(self, orders: TaskOrders, snapshot: HapticSnapshot) -> None:
        super().apply(orders, snapshot)
        self._walk.follow(orders.visual)
        walks = orders.view.state is TrialState.TRAVEL and not orders.view.paused
        for figure in self._led:
            figure.go(self._walk[ALONG], self._walk[SPEED] if walks else 0.0)
        seconds = snapshot.t_ns * 1e-9
        for figure, own in self._others:
            figure.go(own * seconds, own)
        self._weather.follow(orders.visual, seconds)
        opened = self._walk[OPENED]
        for number, obstacle in self._obstacles:
            obstacle.open(opened[number] if opened else 0.0)
        self._turn_camera(float(snapshot.hip_world[0] - self._start[0]) if self._walk[LOOKS] else 0.0)

    def aim(self, snapshot: HapticSnapshot) -> Aim | None:
        """Return where the hand of a simulated person stays, and a touch of the obstacle that is in the way.

        None without obstacles: the hand goes along its path.
        """
        if not self._obstacles:
            return None
        x, y, z = super().via_points_world[-1].tolist()
        touches = self._walk[STOPPED] and snapshot.t_ns * 1e-9 % _TOUCHES_S < 0.5 * _TOUCHES_S
        return Aim((x, y, z), close=touches)

    @staticmethod
    def features(scene: Scene) -> Sequence[Feature[Any]]:
        return (WEATHER,)

    def _turn_camera(self, aside: float) -> None:
        angle = min(max(_GAZE_PER_METRE * aside, -_MOST_GAZE), _MOST_GAZE)
        turn = np.empty(4)
        for node, ahead in self._eyes:
            quat.multiply(quat.about_axis((0.0, 1.0, 0.0), -angle), ahead, turn)
            node.set_orientation(turn)


SCENARIO = CityWalk
