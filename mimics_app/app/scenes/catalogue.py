"""Which scenario plays which scene: the one it names, an installed plug-in, else one that knows its components.

A scene with a robot that no other takes needs no code of its own: `TouchScene` plays what its components say.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib.metadata import entry_points

from mimics_app.app.scenes.shipped import ONLY_LOOKED_AT
from mimics_app.contracts.errors import SceneError, nearest
from mimics_app.contracts.plugins import load_plugin
from mimics_app.contracts.scenario_port import Scenario
from mimics_app.scenarios.avatar_cord import AvatarCord
from mimics_app.scenarios.guided_walk import GuidedWalk
from mimics_app.scenarios.pick_and_place import PickAndPlace
from mimics_app.scenarios.touch_scene import TouchScene
from mimics_app.scenarios.wavy_tunnel import WavyTunnel
from mimics_app.world.components.hand import GraspingHand
from mimics_app.world.components.robot import Robot, Tunnel
from mimics_app.world.scene.scene import Scene
from mimics_app.world.world import World

__all__ = ["BUILT_IN", "BY_COMPONENT", "ENTRY_POINT_GROUP", "is_part", "is_playable", "open_scenario"]

ENTRY_POINT_GROUP = "mimics_app.scenarios"

_Builder = Callable[[Scene, World], Scenario]

BUILT_IN: dict[str, _Builder] = {
    "wavy_tunnel": WavyTunnel,
    "pick_and_place": PickAndPlace,
    "avatar_cord": AvatarCord,
    "guided_walk": GuidedWalk,
}
"""Scenarios that come with the product, by name."""

BY_COMPONENT: dict[type, _Builder] = {Tunnel: WavyTunnel, GraspingHand: PickAndPlace, Robot: TouchScene}
"""What plays a scene that names no scenario: by the first of these components it has."""


_ROBOT_NEEDED = 'include "mimics:scenes/parts/touch_room.json" and add {"id": "robot", "prefab": "robot"}'


def open_scenario(scene: Scene, world: World) -> Scenario:
    """Bring a scene to life in the world built from it.

    Raises:
        SceneError: no scenario can play it, or the one that would misses a part.
    """
    return _find_builder(scene)(scene, world)


def is_part(scene: Scene) -> bool:
    """Whether a file is there to be included: something would play it, but it has neither a robot nor a task."""
    return is_playable(scene) and not scene.has(Robot) and "task" not in scene.sections


def is_playable(scene: Scene) -> bool:
    """Whether a scenario takes the scene; it may still miss a part of it."""
    try:
        _find_builder(scene)
    except SceneError:
        return False
    return True


def _find_builder(scene: Scene) -> _Builder:
    if scene.scenario == ONLY_LOOKED_AT:
        raise SceneError(scene.issue("/scenario", "nothing is to be done in this scene", "look at it: mimics view"))
    if scene.scenario in BUILT_IN:
        return BUILT_IN[scene.scenario]
    installed = {point.name: point for point in entry_points(group=ENTRY_POINT_GROUP)}
    if scene.scenario in installed:
        try:
            builder: _Builder = load_plugin(installed[scene.scenario])
        except ValueError as fault:
            raise SceneError(scene.issue("/scenario", str(fault))) from fault
        return builder
    if scene.scenario != scene.name:
        hint = nearest(scene.scenario, [*BUILT_IN, *installed])
        raise SceneError(scene.issue("/scenario", f'no scenario "{scene.scenario}"', f"leave it out; {hint}"))
    for component, builder in BY_COMPONENT.items():
        if scene.has(component):
            return builder
    what = "nothing plays this scene: it has no robot, and names no scenario"
    raise SceneError(scene.issue("", what, f"{_ROBOT_NEEDED}; to look at it only: mimics view"))
