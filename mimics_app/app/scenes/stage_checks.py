"""Checks by the stages of a scene whose files are right: robots, force fields, paths, and the robot's reach."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import msgspec
import numpy as np
from numpy.typing import NDArray

from mimics_app.app.scenes.parameter_checks import check_parameters
from mimics_app.app.scenes.scenario_choice import features_of, is_playable
from mimics_app.contracts.errors import DeviceError, Issue, SceneError, UsageError, nearest
from mimics_app.contracts.messages.orders import Feature
from mimics_app.estimation.registry import check_estimator
from mimics_app.inputs.trackers.network_place import listening, place_of
from mimics_app.learning.builder import check_learning
from mimics_app.learning.goals import build_goal
from mimics_app.learning.registry import check_policy
from mimics_app.rendering.haptic.devices.robot_checks import (
    check_contact,
    check_controller,
    check_points,
    check_robot,
    check_wires,
)
from mimics_app.rendering.haptic.devices.robot_reach import Reach
from mimics_app.rendering.haptic.force_fields import check_field
from mimics_app.rendering.haptic.scene_effects import check_field_count, check_haptic_path
from mimics_app.rendering.haptic.scene_objects import check_objects
from mimics_app.rendering.haptic.scene_reference import check_reference
from mimics_app.rendering.haptic.scene_tunnel import tunnel_of_scene
from mimics_app.rendering.haptic.stability_checks import check_stability
from mimics_app.tasks.actions import build_learning_space, haptic_target
from mimics_app.tasks.kinds.carry.spec import CarrySpec
from mimics_app.tasks.kinds.tunnel.kind import own_tunnel
from mimics_app.tasks.task import MapSpec, TaskSpec
from mimics_app.world.components.joint_reference import JointReference
from mimics_app.world.components.objects import (
    Connections,
    ForceField,
    HapticEffect,
    HapticObject,
    HapticPath,
    InteractionPoints,
)
from mimics_app.world.components.robot import Controller, Robot, Tunnel
from mimics_app.world.components.visible import Sound
from mimics_app.world.files.scene.placing import pose_of
from mimics_app.world.files.scene.scene import Scene

__all__ = ["check_apart", "check_components", "check_features", "check_stages"]

_OF_COMPONENTS: tuple[tuple[type[msgspec.Struct], Callable[[Any, str, Scene], list[Issue]]], ...] = (
    (Robot, check_robot),
    (Controller, check_controller),
    (InteractionPoints, check_points),
    (Connections, check_wires),
    (HapticEffect, check_contact),
    (ForceField, check_contact),
    (Tunnel, check_contact),
    (HapticPath, check_haptic_path),
    (ForceField, check_field_count),
    (ForceField, check_field),
    (JointReference, check_reference),
)
"""Checks of single components, with the type of the component."""

_REACH_CHECKS = 100
"""Number of points along a tunnel whose reachability is checked."""


_GROUP = "visual."


def check_features(scene: Scene) -> list[Issue]:
    """Return the faults of the maps to features: names that the scenario does not know, values that it does not take.

    Args:
        scene: The scene.
    """
    task = scene.section(TaskSpec)
    maps = [
        (f"{pointer}/maps/{number}", target)
        for pointer, parameter in (task.placed_parameters() if task else ())
        for number, target in enumerate(parameter.maps)
        if target.to.startswith(_GROUP)
    ]
    if not maps or not is_playable(scene):
        return []
    known = {each.name: each for each in features_of(scene)}
    return [issue for pointer, target in maps for issue in _faults(target, pointer, known, scene)]


def _faults(target: MapSpec, pointer: str, known: dict[str, Feature[Any]], scene: Scene) -> Iterator[Issue]:
    name = target.to.removeprefix(_GROUP)
    if name not in known:
        yield scene.issue(f"{pointer}/to", f'the scenario of this scene shows no "{name}"', nearest(name, known))
        return
    for value in target.table or [0.0]:
        try:
            known[name].read(value)
        except UsageError as error:
            yield scene.issue(f"{pointer}/{'table' if target.table else 'to'}", error.what, "write what it takes")
            return


def check_stages(scene: Scene) -> list[Issue]:
    """Return the faults that only a stage can find; those of the whole scene only where its components have none.

    A check that cannot be carried out because of a fault reports that one, and the others continue.
    """
    found = [*check_components(scene), *_check_learning(scene)]
    if found:
        return [*found, *_check_scales(scene)]
    for check in (_check_scales, _check_widest_tunnel, _check_reach, _check_carry_reach, check_objects, check_features):
        try:
            found += check(scene)
        except SceneError as error:
            found += error.issues
    return list(dict.fromkeys(found)) or check_stability(scene) or check_parameters(scene)


def check_apart(scene: Scene) -> list[Issue]:
    """Return what can be found in a scene that has other faults: each check is of one part, or is left out."""
    faults = []
    for kind, check in _OF_COMPONENTS:
        for _, component, pointer in scene.components(kind):
            faults += _looked(partial(check, component, pointer, scene))
    for whole in (_check_sounds, _check_learning, _check_scales):
        faults += _looked(partial(whole, scene))
    return faults


def _looked(check: Callable[[], list[Issue]]) -> list[Issue]:
    """Return what a check finds; nothing where another fault keeps it from looking."""
    try:
        return check()
    except Exception:  # noqa: BLE001  whatever it is, it follows from a fault that is reported
        return []


def _check_scales(scene: Scene) -> list[Issue]:
    """Check that no entity that can be touched is scaled, nor an entity above it."""
    faults: list[Issue] = []
    for entity, _, _ in scene.components(HapticObject):
        try:
            pose_of(scene, entity)
        except SceneError as error:
            faults += error.issues
    return faults


def check_components(scene: Scene) -> list[Issue]:
    """Return the faults of single components."""
    return [
        issue
        for kind, check in _OF_COMPONENTS
        for _, component, pointer in scene.components(kind)
        for issue in check(component, pointer, scene)
    ] + [*_check_sounds(scene), *_check_addresses(scene)]


def _check_addresses(scene: Scene) -> list[Issue]:
    """Check that the trackers that listen have a port to listen at."""
    issues = []
    for pointer, address in listening(scene):
        try:
            place_of(address)
        except UsageError as error:
            issues.append(scene.issue(pointer, error.what, error.fix))
    return issues


def _check_sounds(scene: Scene) -> list[Issue]:
    """Return the faults of sounds; a scene without sounds imports nothing of their stage."""
    if not scene.has(Sound):
        return []
    from mimics_app.rendering.audio.scene_sounds import check_head, check_mixer, check_sound

    sounds = [issue for _, sound, pointer in scene.components(Sound) for issue in check_sound(sound, pointer, scene)]
    return [*sounds, *check_head(scene), *check_mixer(scene)]


def _check_learning(scene: Scene) -> list[Issue]:
    """Check that the policy, the goal and the estimator that the task names exist and fit."""
    task = scene.section(TaskSpec)
    if task is None:
        return []
    issues = []
    for name, check in (("learn", check_policy), ("goal", build_goal), ("estimator", check_estimator)):
        words = str(getattr(task, name))
        try:
            if words:
                check(words)
        except UsageError as error:
            issues.append(scene.issue(f"/task/{name}", error.what, error.fix))
        except ValueError as error:
            issues.append(scene.issue(f"/task/{name}", str(error)))
    if task.learn and not issues:
        try:
            check_learning(task.learn, task.goal, build_learning_space(task))
        except UsageError as error:
            issues.append(scene.issue("/task/learn", error.what, error.fix))
    return issues


def _reach_of(scene: Scene) -> Reach:
    """Return the reach of the scene's robot.

    Raises:
        DeviceError: Its device does not exist; the error has file and JSON pointer.
    """
    _, robot, pointer = scene.one(Robot)
    try:
        return Reach(robot)
    except DeviceError as error:
        issue = scene.issue(f"{pointer}/device", error.what, error.fix)
        raise DeviceError(issue.what, issue.fix, issue.file, issue.pointer) from error


def _check_widest_tunnel(scene: Scene) -> list[Issue]:
    """Check that the task widens no tunnel beyond what its tightest bend allows (radius x curvature below 1)."""
    task = scene.section(TaskSpec)
    if task is None or not scene.components(Tunnel):
        return []
    targets = {f"tunnels.{entity}.radius_scale": entity for entity, _, _ in scene.components(Tunnel)}
    targets["tunnel.radius_scale"] = own_tunnel(scene)
    issues = []
    for pointer, parameter in task.placed_parameters():
        for target in parameter.maps:
            entity = targets.get(haptic_target(target))
            if entity is None:
                continue
            limit = tunnel_of_scene(scene, entity)[0].max_radius_scale
            widest = max(target.offset + target.scale * value for value in (parameter.min, parameter.max))
            if widest >= limit:
                what = f"makes the tunnel {widest:g} times as wide: wider than its tightest bend allows"
                issues.append(scene.issue(f"{pointer}/max", what, f"stay below {limit:.3f}"))
    return issues


def _check_reach(scene: Scene) -> list[Issue]:
    """Check that the robot reaches the bisector of the task's own tunnel, short of its end stops."""
    if not scene.components(Tunnel) or not scene.components(Robot):
        return []
    pointer = scene.one(Robot)[2]
    curve, _ = tunnel_of_scene(scene, own_tunnel(scene))
    reach = _reach_of(scene)
    arcs = np.linspace(0.0, curve.length, _REACH_CHECKS)
    for arc, point in zip(arcs, curve.point(curve.parameter_at(arcs)), strict=True):
        if not reach.reaches(point):
            what = f"the robot does not reach the tunnel {arc:.3f} m from its start, at {_place(point)}"
            return [scene.issue(f"{pointer}/robot_to_world", what, "move the robot or the tunnel")]
    return []


def _check_carry_reach(scene: Scene) -> list[Issue]:
    """Check that the robot reaches the mark, and the surface below the box that the object falls from."""
    task = scene.section(TaskSpec)
    carry = None if task is None else task.find(CarrySpec)
    if carry is None or not scene.components(Robot):
        return []
    robot = scene.one(Robot)[1]
    mark = pose_of(scene, carry.to)[0]
    reach = _reach_of(scene)
    if not reach.reaches(mark):
        what = f'the robot does not reach "{carry.to}" at {_place(mark)}'
        return [scene.issue("/task/carry/to", what, "move the robot or the mark")]
    box, height = carry.falls_from, robot.robot_to_world.translation[1]
    corners = [(x, height, z) for x in (box.low[0], box.high[0]) for z in (box.low[2], box.high[2])] if box else []
    for corner in corners:
        if not reach.reaches(np.array(corner)):
            what = f"the robot does not reach what lies below its corner at {_place(np.array(corner))}"
            return [scene.issue("/task/carry/falls_from", what, "make it smaller or move the robot")]
    return []


def _place(point: NDArray[np.float64]) -> str:
    x, y, z = point
    return f"({x:.3f}, {y:.3f}, {z:.3f})"
