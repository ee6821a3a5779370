"""The pointer in every shipped scene: all of the reach is inside the window, and what the hand moves moves no hand."""

from __future__ import annotations

import itertools
import math
from functools import cache
from typing import Any

import msgspec
import numpy as np
import pytest

from mimics_app.app.scenes.loading import load_checked_scene
from mimics_app.app.scenes.scenario_choice import open_scenario
from mimics_app.app.scenes.shipped import shipped_scenes
from mimics_app.app.session.person_input import pointer_plane, ray_to_the_hand
from mimics_app.contracts.messages.stage_messages import TaskOrders
from mimics_app.contracts.messages.trial_state import TaskView, TrialState
from mimics_app.contracts.ports.scenario_port import Scenario
from mimics_app.inputs.interaction.plane import FrontalPlane
from mimics_app.inputs.interaction.window_reach import levered, pointed
from mimics_app.tasks.kinds.city_walk.kind import SPEED, CityWalkPlay, CityWalkSpec
from mimics_app.tasks.kinds.guided_walk.kind import GuidedWalkSpec
from mimics_app.tasks.scene_section import task_of
from mimics_app.tasks.task_manager import TaskManager
from mimics_app.world.components.robot import Robot
from mimics_app.world.content.world import World
from mimics_app.world.files.scene.file import build_world
from tests.support.task_play import make_snapshot

SIZES = ((1280, 720), (500, 900), (3840, 1080), (900, 900))
FIELDS = (0.5, 1.0, 1.5)
"""Factors on a scene's own field of view."""
INSIDE = 0.95
"""Share of the window's half sizes in which all of the reach must lie."""
PLAYED = [scene.name for scene in shipped_scenes() if scene.lasts]


class Pointed:
    """A shipped scene as a person at a window has it, without a picture.

    Attributes:
        lever: Whether the hand is a lever.
        plane: Plane of the cursor.
        factor: Factor on the field of view.
        size: Of the window [px].
    """

    def __init__(self, name: str, **guided: Any) -> None:
        self.scene = load_checked_scene(name)
        self.world: World = build_world(self.scene)
        self.scenario: Scenario = open_scenario(self.scene, self.world)
        task = task_of(self.scene)
        if guided:
            spec = task.find(GuidedWalkSpec)
            task = msgspec.structs.replace(task, guided_walk=msgspec.structs.replace(spec, **guided))
        self.lever = TaskManager(task, self.scenario.task_context, 1).lever
        self.plane: FrontalPlane = pointer_plane(self.scene, self.scenario, lever=self.lever)
        self.factor, self.size = 1.0, SIZES[0]

    def ray(self, right: float, up: float) -> Any:
        """Ray of a pinhole camera with square pixels."""
        self.world.update()
        camera = self.world.cameras[0]
        high = math.tan(0.5 * min(self.factor * camera.vertical_fov, 3.0))
        matrix = camera.world_from_eye
        direction = matrix[:3, :3] @ [right * high * self.size[0] / self.size[1], up * high, -1.0]
        ray = tuple(matrix[:3, 3].tolist()), tuple(direction.tolist())
        return ray_to_the_hand(ray, self.scenario.hand_frame())

    def cursor(self, right: float, up: float) -> Any:
        """Place of the cursor, right and up of the plane's middle [m]; None where it stays."""
        place = levered(self.plane, right, up) if self.lever else pointed(self.plane, self.ray, right, up)
        return None if place is None else np.subtract(place, self.plane.centre)[:2]

    def move_hand(self, x: float, y: float, t_ns: int) -> None:
        """Show the hand at a place of its plane, as a frame of a travel does."""
        hip, bodies = np.array(self.plane.at(x, y)), len(self.scenario.task_context.bodies)
        poses = np.zeros((max(bodies, 1), 7))
        snapshot = make_snapshot(t_ns, hip_world=hip, poses=poses)
        self.scenario.apply(TaskOrders(view=TaskView(TrialState.TRAVEL)), snapshot)
        self.world.update()


@cache
def opened(name: str) -> Pointed:
    return Pointed(name)


def rim() -> list[tuple[float, float]]:
    """Points all around the window, a little inside."""
    along = np.linspace(-INSIDE, INSIDE, 9)
    return [*((x, y) for x in along for y in (-INSIDE, INSIDE)), *((x, y) for x in (-INSIDE, INSIDE) for y in along)]


@pytest.mark.parametrize("name", PLAYED)
def test_all_of_the_reach_is_inside_every_window(name):
    at = opened(name)
    reach = np.array([at.plane.half_width, at.plane.half_height])
    for at.size, at.factor in itertools.product(SIZES, FIELDS):
        places = np.array([place for point in rim() if (place := at.cursor(*point)) is not None])
        np.testing.assert_allclose(places.min(axis=0), -reach, atol=1e-9, err_msg=f"{at.size} {at.factor}")
        np.testing.assert_allclose(places.max(axis=0), reach, atol=1e-9, err_msg=f"{at.size} {at.factor}")
    at.size, at.factor = SIZES[0], 1.0


@pytest.mark.parametrize("name", PLAYED)
def test_a_pointer_at_rest_leaves_the_hand_where_it_is(name):
    """Whatever the hand does to the view, the cursor under a pointer that does not move stays: the loop has gain 0."""
    check_at_rest(opened(name))


def check_at_rest(at: Pointed) -> None:
    points = [(0.0, 0.0), (0.3, -0.4), (-0.6, 0.5)]
    at.move_hand(0.0, 0.0, 1)
    before = [at.cursor(*point) for point in points]
    for k, (x, y) in enumerate(itertools.product((-1.0, 1.0), repeat=2)):
        at.move_hand(x * at.plane.half_width, y * at.plane.half_height, 17_000_000 * (k + 2))
        for point, place in zip(points, before, strict=True):
            np.testing.assert_allclose(at.cursor(*point), place, atol=1e-9)


def test_a_walk_led_by_the_hand_is_a_lever_too():
    check_at_rest(Pointed("guided_walk", walker="hand"))


def test_the_mouse_stops_and_leads_the_walk():
    """The middle of the window and all below it asks for rest, its upper part for full speed; aside looks about."""
    at = opened("city_walk")
    assert at.lever
    spec = msgspec.structs.replace(task_of(at.scene).find(CityWalkSpec), obstacles=())
    for up, speed in ((-INSIDE, 0.0), (-0.3, 0.0), (0.0, 0.0), (INSIDE, spec.fastest)):
        play = CityWalkPlay(spec, 140.0)
        manager_sees = [make_seen(at, 0.0), make_seen(at, up)]
        play.start_attempt(manager_sees[0])
        for _ in range(300):
            play.travel(manager_sees[1], 1.0 / 60.0)
        assert play.visual[SPEED] == pytest.approx(speed)


def make_seen(at: Pointed, up: float) -> Any:
    from mimics_app.tasks.observation import observe
    from tests.support.task_play import make_events

    x, y = at.cursor(0.0, up)
    return observe(make_snapshot(hip_world=np.array(at.plane.at(x, y))), make_events(), 0)


def test_every_lever_begins_in_the_middle_of_its_reach():
    for name in PLAYED:
        at = opened(name)
        if at.lever:
            robot = at.scene.first(Robot)
            assert at.plane.centre == pytest.approx(robot.robot_to_world.translation, abs=0.02)
