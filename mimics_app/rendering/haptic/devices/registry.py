"""Registry of device builders: built-in ones, and plug-ins by entry points of the group mimics_app.devices."""

from __future__ import annotations

from dataclasses import replace
from types import FunctionType
from typing import TYPE_CHECKING, cast

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.loop.device_descriptor import DeviceDescriptor
from mimics_app.contracts.loop.loop_ports import DevicePlugin
from mimics_app.contracts.ports.members import load_member
from mimics_app.contracts.ports.plugins import PluginError, made_by
from mimics_app.rendering.haptic import devices
from mimics_app.rendering.haptic.devices.address import split_device
from mimics_app.rendering.haptic.devices.described import descriptor_of
from mimics_app.rendering.haptic.devices.device_names import BUILT_IN, check_device_name, find_plugin, load_built_in
from mimics_app.rendering.haptic.devices.device_objects import DeviceObject
from mimics_app.rendering.haptic.devices.request import DeviceBuilder, DeviceRequest
from mimics_app.rendering.haptic.scene_block import robot_from_world

if TYPE_CHECKING:
    from mimics_app.world.components.robot import Patient, Robot

__all__ = ["build_device", "find_builder"]


def find_builder(name: str) -> DeviceBuilder:
    """Return the builder of a device.

    Raises:
        DeviceError: No such device, or its plug-in cannot be imported.
    """
    if name not in BUILT_IN:
        return find_plugin(name)
    module, _, function = load_built_in(name).builder.partition(":")
    return cast("DeviceBuilder", load_member(devices, module, function, FunctionType))


def build_device(
    robot: Robot,
    patient: Patient | None = None,
    via_points_world: NDArray[np.float64] | None = None,
    seed: int = 0,
    *,
    samples: NDArray[np.void] | None = None,
    descriptor: DeviceDescriptor | None = None,
    objects: tuple[DeviceObject, ...] = (),
    given: DeviceBuilder | None = None,
) -> DevicePlugin:
    """Build the device of a scene.

    Args:
        robot: The scene's robot component; `device` is NAME or NAME:ADDRESS.
        patient: The scene's patient component, for simulated robots.
        via_points_world: Polyline that the simulated person intends to follow, world [m], shape [n, 3]; dense enough
            for straight segments (the bisector at 50 or more parameters).
        seed: Seed of all random numbers.
        samples: SAMPLE rows, for the replay device.
        descriptor: Descriptor of the device whose samples are replayed; None: that of the name.
        objects: Objects for a robot that renders objects itself, robot frame.
        given: Builder that a program gives, of a device with the joints of the robot's; None: the one of the name.

    Raises:
        DeviceError: No such device, it is not available, or its plug-in fails.
    """
    check_device_name(robot.device)
    name = split_device(robot.device).name
    points = np.zeros((0, 3)) if via_points_world is None else np.asarray(via_points_world, np.float64)
    request = DeviceRequest(
        robot=robot,
        patient=patient,
        path_robot=robot_from_world(robot, points),
        seed=seed,
        samples=samples,
        address=split_device(robot.device).address,
        objects=objects,
        descriptor=descriptor or descriptor_of(name),
    )
    plugin = _made(name, request) if given is None else _made_by_own(given, request)
    return plugin if plugin.descriptor is not None else replace(plugin, descriptor=request.descriptor)


def _made_by_own(builder: DeviceBuilder, request: DeviceRequest) -> DevicePlugin:
    """Return the device of a builder that a program gives; it has the shape of the one that the scene is made for."""
    try:
        plugin = cast("DevicePlugin", made_by(builder, DevicePlugin, request))
    except PluginError as error:
        raise DeviceError(f"the device that was given cannot be opened: {error}") from error
    own, wanted = plugin.descriptor or request.descriptor, request.descriptor
    if own.extent.joints != wanted.extent.joints or own.contacts != wanted.contacts:
        plugin.close()
        what = f'"{plugin.name}" has other joints or points of contact than "{request.robot.device}"'
        raise DeviceError(what, "give a device of the shape that the scene is made for")
    return plugin


def _made(name: str, request: DeviceRequest) -> DevicePlugin:
    builder = find_builder(name)
    if name in BUILT_IN:
        return builder(request)
    try:
        return cast("DevicePlugin", made_by(builder, DevicePlugin, request))
    except PluginError as error:
        raise DeviceError(f'the device "{name}" cannot be opened: {error}') from error
