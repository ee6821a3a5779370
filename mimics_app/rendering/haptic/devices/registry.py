"""Finds device builders by name: built-in ones, and plug-ins by entry points of the group mimics_app.devices."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.errors import DeviceError, nearest
from mimics_app.contracts.loop_ports import DevicePlugin
from mimics_app.rendering.haptic.devices.address import split_device
from mimics_app.rendering.haptic.devices.device_objects import DeviceObject
from mimics_app.rendering.haptic.devices.pointer import build_pointer
from mimics_app.rendering.haptic.devices.replay import build_replay
from mimics_app.rendering.haptic.devices.request import DeviceBuilder, DeviceRequest
from mimics_app.rendering.haptic.devices.simulated_hapticmaster import build_simulated_hapticmaster
from mimics_app.rendering.haptic.devices.simulated_impedance import build_simulated_impedance
from mimics_app.rendering.haptic.scene_block import robot_from_world

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

    from mimics_app.world.components.robot import Patient, Robot

__all__ = [
    "BUILT_IN",
    "ENTRY_POINT_GROUP",
    "POINTER",
    "SIMULATED",
    "build_device",
    "check_device_name",
    "device_names",
    "find_builder",
]

ENTRY_POINT_GROUP = "mimics_app.devices"

SIMULATED = "simulated_hapticmaster"
"""The device of a scene that names none, held by a simulated person."""

POINTER = "pointer"
"""The same robot, held by a person at a window."""


def _build_serial(request: DeviceRequest) -> DevicePlugin:
    """A robot on a serial line, by the protocol of docs/devices/serial_protocol.md."""
    from mimics_app.rendering.haptic.devices.serial_port import build_serial

    return build_serial(request)


def _build_hapticmaster(request: DeviceRequest) -> DevicePlugin:
    """A HapticMaster on the network, by its own commands."""
    from mimics_app.rendering.haptic.devices.hapticmaster_port import build_hapticmaster

    return build_hapticmaster(request)


BUILT_IN: dict[str, DeviceBuilder] = {
    SIMULATED: build_simulated_hapticmaster,
    "simulated_impedance": build_simulated_impedance,
    POINTER: build_pointer,
    "replay": build_replay,
    "serial": _build_serial,
    "hapticmaster": _build_hapticmaster,
}
"""Devices that come with the product. A plug-in cannot take one of these names."""

_ADDRESSES = {
    SIMULATED: "",
    "simulated_impedance": "",
    POINTER: "",
    "replay": "",
    "serial": "PORT[@BAUD]",
    "hapticmaster": "HOST[:PORT]",
}
"""What stands behind the colon of a built-in device's name; "": nothing may. Plug-ins judge theirs themselves."""


def _installed() -> dict[str, EntryPoint]:
    from importlib.metadata import entry_points

    return {point.name: point for point in entry_points(group=ENTRY_POINT_GROUP)}


def device_names() -> list[str]:
    """Names of all devices that can be asked for: built-in first, then installed plug-ins."""
    return [*BUILT_IN, *sorted(set(_installed()) - set(BUILT_IN))]


def find_builder(name: str) -> DeviceBuilder:
    """The builder of a device.

    Raises:
        DeviceError: No device of that name, or its plug-in cannot be imported.
    """
    if name in BUILT_IN:
        return BUILT_IN[name]
    installed = _installed()
    if name not in installed:
        raise DeviceError(f'there is no device "{name}"', nearest(name, [*BUILT_IN, *installed]))
    try:
        builder: DeviceBuilder = installed[name].load()
    except (ImportError, AttributeError) as failure:
        raise DeviceError(f'the plug-in of device "{name}" cannot be loaded: {failure}') from failure
    return builder


def check_device_name(text: str) -> None:
    """Whether NAME or NAME:ADDRESS, as `robot.device` and `--device` have it, can be asked for. Opens nothing.

    Raises:
        DeviceError: No device of that name, its plug-in cannot be imported, or the address is missing or one too many.
    """
    device = split_device(text)
    find_builder(device.name)
    wanted = _ADDRESSES.get(device.name)
    if wanted == "" and device.address:
        raise DeviceError(f'"{device.name}" is in this program: it has no address', f'write "{device.name}"')
    if wanted and not device.address:
        raise DeviceError(f'"{device.name}" needs an address', f"write {device.name}:{wanted}")


def build_device(
    robot: Robot,
    patient: Patient | None = None,
    via_points_world: NDArray[np.float64] | None = None,
    seed: int = 0,
    *,
    samples: NDArray[np.void] | None = None,
    objects: tuple[DeviceObject, ...] = (),
) -> DevicePlugin:
    """Build the device a scene asks for.

    Args:
        robot: The scene's robot component; `device` is NAME or NAME:ADDRESS.
        patient: The scene's patient component, for simulated robots.
        via_points_world: Points the simulated person means to pass, world [m], shape [n, 3]; dense enough that straight
            lines between them are good enough (the bisector at 50 or more parameters).
        seed: Of all random numbers.
        samples: SAMPLE rows, for the replay device.
        objects: What a robot that renders objects by itself should make, robot frame.

    Raises:
        DeviceError: No such device, or it cannot be had.
    """
    points = np.zeros((0, 3)) if via_points_world is None else np.asarray(via_points_world, np.float64)
    request = DeviceRequest(
        robot=robot,
        patient=patient,
        way_robot=robot_from_world(robot, points),
        seed=seed,
        samples=samples,
        address=split_device(robot.device).address,
        objects=objects,
    )
    check_device_name(robot.device)
    return find_builder(split_device(robot.device).name)(request)
