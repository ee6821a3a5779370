"""Registry of device builders: built-in ones, and plug-ins by entry points of the group mimics_app.devices."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.device_descriptor import DeviceDescriptor
from mimics_app.contracts.loop_ports import DevicePlugin
from mimics_app.rendering.haptic.devices.address import split_device
from mimics_app.rendering.haptic.devices.described import descriptor_of
from mimics_app.rendering.haptic.devices.device_names import POINTER, SIMULATED, check_device_name, find_plugin
from mimics_app.rendering.haptic.devices.device_objects import DeviceObject
from mimics_app.rendering.haptic.devices.request import DeviceBuilder, DeviceRequest
from mimics_app.rendering.haptic.scene_block import robot_from_world

if TYPE_CHECKING:
    from mimics_app.world.components.robot import Patient, Robot

__all__ = ["BUILT_IN", "build_device", "find_builder"]


def _build_simulated_hapticmaster(request: DeviceRequest) -> DevicePlugin:
    """The simulated HapticMaster, with a simulated person."""
    from mimics_app.rendering.haptic.devices.simulated_hapticmaster import build_simulated_hapticmaster

    return build_simulated_hapticmaster(request)


def _build_simulated_impedance(request: DeviceRequest) -> DevicePlugin:
    """A simulated light robot that takes forces, with a simulated person."""
    from mimics_app.rendering.haptic.devices.simulated_impedance import build_simulated_impedance

    return build_simulated_impedance(request)


def _build_pointer(request: DeviceRequest) -> DevicePlugin:
    """The simulated robot moved by mouse, gamepad or keyboard."""
    from mimics_app.rendering.haptic.devices.pointer import build_pointer

    return build_pointer(request)


def _build_replay(request: DeviceRequest) -> DevicePlugin:
    """The sensor data of a recording, as a device."""
    from mimics_app.rendering.haptic.devices.replay import build_replay

    return build_replay(request)


def _build_serial(request: DeviceRequest) -> DevicePlugin:
    """A robot on a serial line, by the protocol of docs/devices/serial_protocol.md."""
    from mimics_app.rendering.haptic.devices.serial_port import build_serial

    return build_serial(request)


def _build_hapticmaster(request: DeviceRequest) -> DevicePlugin:
    """A HapticMaster on the network, by its command interface."""
    from mimics_app.rendering.haptic.devices.hapticmaster_port import build_hapticmaster

    return build_hapticmaster(request)


def _build_leg(request: DeviceRequest) -> DevicePlugin:
    """One simulated leg on a gait orthosis with drives at hip and knee; a simulated person moves the foot."""
    from mimics_app.rendering.haptic.devices.simulated_leg import build_simulated_leg

    return build_simulated_leg(request)


def _build_legs(request: DeviceRequest) -> DevicePlugin:
    """Two simulated legs on a gait orthosis with four drives; a simulated person moves the first foot."""
    from mimics_app.rendering.haptic.devices.simulated_leg import build_simulated_leg

    return build_simulated_leg(request)


BUILT_IN: dict[str, DeviceBuilder] = {
    SIMULATED: _build_simulated_hapticmaster,
    "simulated_impedance": _build_simulated_impedance,
    POINTER: _build_pointer,
    "replay": _build_replay,
    "simulated_leg": _build_leg,
    "simulated_legs": _build_legs,
    "serial": _build_serial,
    "hapticmaster": _build_hapticmaster,
}
"""Builders of the built-in devices by the names of `device_names.ADDRESSES`; each imports its device on demand."""


def find_builder(name: str) -> DeviceBuilder:
    """Return the builder of a device.

    Raises:
        DeviceError: No such device, or its plug-in cannot be imported.
    """
    return BUILT_IN[name] if name in BUILT_IN else find_plugin(name)


def build_device(
    robot: Robot,
    patient: Patient | None = None,
    via_points_world: NDArray[np.float64] | None = None,
    seed: int = 0,
    *,
    samples: NDArray[np.void] | None = None,
    descriptor: DeviceDescriptor | None = None,
    objects: tuple[DeviceObject, ...] = (),
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

    Raises:
        DeviceError: No such device, or it is not available.
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
    plugin = find_builder(name)(request)
    return plugin if plugin.descriptor is not None else replace(plugin, descriptor=request.descriptor)
