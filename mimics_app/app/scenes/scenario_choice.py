"""Choice of the scenario of a scene: the one that it names, built in or a plug-in, else one for its components.

A scene with a robot and no other scenario needs no code of its own: `TouchScene` plays its components.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, cast

from mimics_app import scenarios
from mimics_app.app.scenes.shipped import ONLY_LOOKED_AT
from mimics_app.contracts.errors import SceneError, nearest
from mimics_app.contracts.messages.orders import Feature
from mimics_app.contracts.ports.members import load_member, member_names
from mimics_app.contracts.ports.plugins import PluginError
from mimics_app.contracts.ports.scenario_port import PLUGINS, Scenario
from mimics_app.world.components.hand import GraspingHand
from mimics_app.world.components.robot import Robot, Tunnel
from mimics_app.world.content.world import World
from mimics_app.world.files.scene.scene import Scene

__all__ = ["BUILT_IN", "features_of", "is_part", "is_playable", "open_scenario"]

_Builder = Callable[[Scene, World], Scenario]

BUILT_IN = member_names(scenarios)
"""Names of the scenarios that come with the product: the modules of `mimics_app.scenarios`, named like their scenes."""

_BY_COMPONENT: dict[type, str] = {Tunnel: "wavy_tunnel"}
"""Built-in scenario of a scene that names none, by the first of these components it has."""

_ROBOT_NEEDED = 'include "mimics:scenes/parts/touch_room.json" and add {"id": "robot", "prefab": "robot"}'


def open_scenario(scene: Scene, world: World) -> Scenario:
    """Return the scenario of a scene, in the world built from it.

    Raises:
        SceneError: No scenario can play the scene, or it lacks a part that its scenario needs.
    """
    return _find_builder(scene)(scene, world)


def features_of(scene: Scene) -> Sequence[Feature[Any]]:
    """Return what of its view a task may change: as the scene's scenario declares it.

    Raises:
        SceneError: No scenario can play the scene.
    """
    declared = getattr(_find_builder(scene), "features", None)
    return () if declared is None else declared(scene)


def is_part(scene: Scene) -> bool:
    """Whether a scene file is only to be included by others: a scenario takes it, but it has neither robot nor task."""
    return is_playable(scene) and not scene.has(Robot) and "task" not in scene.sections


def is_playable(scene: Scene) -> bool:
    """Whether a scenario takes the scene; it may still lack a part that the scenario needs."""
    try:
        _find_builder(scene)
    except SceneError:
        return False
    return True


def _find_builder(scene: Scene) -> _Builder:
    if scene.scenario == ONLY_LOOKED_AT:
        raise SceneError(scene.issue("/scenario", "this scene has no task", f"open it: mimics view {scene.name}"))
    if scene.scenario in BUILT_IN:
        return _load(scene.scenario)
    installed = PLUGINS.names()
    if scene.scenario in installed:
        try:
            return cast(_Builder, PLUGINS.load(scene.scenario))
        except PluginError as error:
            what = f'the scenario "{scene.scenario}" is not available'
            raise SceneError(scene.issue("/scenario", what, str(error))) from error
    if scene.scenario != scene.name:
        hint = nearest(scene.scenario, [*BUILT_IN, *installed])
        raise SceneError(scene.issue("/scenario", f'no scenario "{scene.scenario}"', f"leave it out; {hint}"))
    for component, name in _BY_COMPONENT.items():
        if scene.has(component):
            return _load(name)
    task = scene.document.get("task")
    if scene.has(GraspingHand) and (not task or "carry" in task):  # a hand in another task is only shown
        return _load("pick_and_place")
    if scene.has(Robot):
        from mimics_app.scenarios.parts.touch_scene import TouchScene  # compiled code: not needed for other scenes

        return TouchScene
    what = "nothing plays this scene: it has no robot, and names no scenario"
    raise SceneError(scene.issue("", what, f"{_ROBOT_NEEDED}; to look at it only: mimics view"))


def _load(name: str) -> _Builder:
    return load_member(scenarios, name, "SCENARIO", type)
