"""Checks of a scene's robot against its device: number of joints, order of limits, reach, controller."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from mimics_app.contracts.errors import DeviceError, Issue, UsageError
from mimics_app.contracts.loop.controller_slots import Lead
from mimics_app.rendering.haptic.controllers.parameter_vector import parameter_vector
from mimics_app.rendering.haptic.controllers.registry import find_controller
from mimics_app.rendering.haptic.descriptors.joint_limits import joint_limits
from mimics_app.rendering.haptic.devices.button_commands import button_commands
from mimics_app.rendering.haptic.devices.described import descriptor_of
from mimics_app.rendering.haptic.devices.hard_object import hard_object_values
from mimics_app.world.components.objects import Connections, ForceField, HapticEffect, InteractionPoints
from mimics_app.world.components.robot import Controller, Robot, Tunnel

if TYPE_CHECKING:
    from mimics_app.contracts.loop.device_descriptor import DeviceDescriptor
    from mimics_app.world.files.scene.scene import Scene

__all__ = ["check_contact", "check_controller", "check_points", "check_robot", "check_wires"]

_PER_JOINT = ("joint_min", "joint_max", "velocity_limit", "acceleration_limit")


def check_robot(robot: Robot, pointer: str, scene: Scene) -> list[Issue]:
    """Return the faults of the joints; an unknown device is reported elsewhere."""
    try:
        descriptor = descriptor_of(robot.device)
    except DeviceError:
        return []
    count = len(descriptor.joints)
    issues = [
        scene.issue(
            f"{pointer}/{name}",
            f'{len(given)} numbers; the device "{robot.device}" has {count} joints: '
            + ", ".join(joint.name for joint in descriptor.joints),
            "give one for each, or leave it out",
        )
        for name in _PER_JOINT
        if (given := getattr(robot, name)) is not None and len(given) != count
    ]
    try:
        button_commands(robot.buttons)
    except UsageError as error:
        issues.append(scene.issue(f"{pointer}/buttons", error.what, error.fix))
    return issues or _check_own(robot, descriptor, pointer, scene) or _check_range(robot, descriptor, pointer, scene)


def check_controller(chosen: Controller, pointer: str, scene: Scene) -> list[Issue]:
    """Return the faults of the controller of a scene: it is loaded, and its parameters are packed."""
    try:
        plugin = find_controller(chosen.name)
        if plugin.leads is not Lead.PERSON:
            what = f'under the controller "{chosen.name}" the person does not move the robot'
            return [scene.issue(f"{pointer}/name", what, "choose one under which the person leads")]
        descriptor = descriptor_of((scene.first(Robot) or Robot()).device)
    except UsageError as error:
        return [scene.issue(f"{pointer}/name", error.what, error.fix)]
    except DeviceError:
        return []  # the check of the robot reports it
    if why := plugin.refusal(descriptor):
        return [scene.issue(f"{pointer}/name", f'the controller "{chosen.name}" {why}', "choose another one")]
    try:
        solid = hard_object_values(chosen, scene, descriptor)
    except UsageError as error:
        return [scene.issue(f"{pointer}/hard_object", error.what, error.fix)]
    try:
        misfit = plugin.misfit(parameter_vector(plugin, {**chosen.parameters, **solid}))
    except UsageError as error:
        return [scene.issue(f"{pointer}/{'hard_object' if solid else 'parameters'}", error.what, error.fix)]
    if misfit:
        return [scene.issue(f"{pointer}/parameters", f'the controller "{chosen.name}" {misfit}', "change its corners")]
    return []


def _check_own(robot: Robot, descriptor: DeviceDescriptor, pointer: str, scene: Scene) -> list[Issue]:
    """Return the faults of joint limits beyond those of the device: a scene may only narrow them."""
    held = joint_limits(robot, descriptor)
    pairs = zip(_PER_JOINT, (held.lowest, held.highest, held.velocity, held.acceleration), strict=True)
    return [
        scene.issue(
            f"{pointer}/{name}/{i}", f"{asked:g} exceeds the device's own limit, {own:g}", "narrow it or leave it out"
        )
        for name, limits in pairs
        for i, (asked, own) in enumerate(zip(getattr(robot, name) or limits, limits, strict=True))
        if asked != own
    ]


def _check_range(robot: Robot, descriptor: DeviceDescriptor, pointer: str, scene: Scene) -> list[Issue]:
    limits = joint_limits(robot, descriptor)
    issues = [
        scene.issue(f"{pointer}/joint_max/{i}", f"{most:g} is not above joint_min, {least:g}")
        for i, (least, most) in enumerate(zip(limits.lowest, limits.highest, strict=True))
        if least >= most
    ]
    if descriptor.polar and (reach := descriptor.geometry_of(robot)[0] + limits.lowest[0]) <= 0.0:
        what = f"the arm could reach through the axis of the robot: {reach:g} m"
        issues.append(scene.issue(f"{pointer}/joint_min/0", what, "raise it, or axis_offset"))
    return issues


def check_points(points: InteractionPoints, pointer: str, scene: Scene) -> list[Issue]:
    """Return the faults of points of contact that the scene's device does not have."""
    named = {f"{pointer}/points/{i}/contact": point.contact for i, point in enumerate(points.points)}
    return _check_contacts(named, scene)


def check_wires(connections: Connections, pointer: str, scene: Scene) -> list[Issue]:
    """Return the faults of wires from points of contact that the scene's device does not have."""
    named = {f"{pointer}/wires/{i}/contact": wire.contact for i, wire in enumerate(connections.wires)}
    return _check_contacts(named, scene)


def check_contact(acting: HapticEffect | ForceField | Tunnel, pointer: str, scene: Scene) -> list[Issue]:
    """Return the fault of a force on a point of contact that the scene's device does not have."""
    return _check_contacts({f"{pointer}/contact": acting.contact}, scene)


def _check_contacts(named: Mapping[str, str | None], scene: Scene) -> list[Issue]:
    """Return the faults of points of contact by the place where they are named."""
    device = (scene.first(Robot) or Robot()).device
    try:
        contacts = descriptor_of(device).contacts
    except DeviceError:
        return []
    return [
        scene.issue(place, f'the device "{device}" touches with {", ".join(contacts)}', "name one")
        for place, name in named.items()
        if name is not None and name not in contacts
    ]
