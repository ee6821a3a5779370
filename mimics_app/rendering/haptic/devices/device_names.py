"""Names of devices and the form of their addresses, without importing any device.

Commands check a name here before they import compiled code, so that an unknown one is refused at once.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

from mimics_app.contracts.errors import DeviceError, nearest
from mimics_app.contracts.plugins import PluginError, PluginGroup
from mimics_app.rendering.haptic.devices.address import split_device

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.devices.request import DeviceBuilder

__all__ = [
    "ADDRESSES",
    "PLUGINS",
    "POINTER",
    "REPLAY",
    "SIMULATED",
    "check_device_name",
    "device_names",
    "find_plugin",
]


def _fault_of(_: str, loaded: object) -> str:
    return "" if callable(loaded) else "cannot be called to make a device"


PLUGINS = PluginGroup("mimics_app.devices", _fault_of)

SIMULATED = "simulated_hapticmaster"
"""Default device: a simulated HapticMaster held by a simulated person."""

POINTER = "pointer"
"""Simulated HapticMaster moved by mouse, gamepad or keyboard."""

REPLAY = "replay"
"""Device that replays the sensor data of a recording."""

ADDRESSES = {
    SIMULATED: "",
    "simulated_impedance": "",
    POINTER: "",
    REPLAY: "",
    "simulated_leg": "",
    "simulated_legs": "",
    "serial": "PORT[@BAUD]",
    "hapticmaster": "HOST[:PORT]",
}
"""Form of the address of each built-in device; "": no address. A plug-in cannot use one of these names, and checks its
addresses itself."""


def device_names() -> list[str]:
    """Return the names of all devices: built-in first, then installed plug-ins."""
    return [*ADDRESSES, *sorted(set(PLUGINS.names()) - set(ADDRESSES))]


def find_plugin(name: str) -> DeviceBuilder:
    """Return the builder of a plug-in device.

    Raises:
        DeviceError: No such device, or its plug-in cannot be loaded.
    """
    installed = PLUGINS.names()
    if name not in installed:
        raise DeviceError(f'there is no device "{name}"', nearest(name, [*ADDRESSES, *installed]))
    try:
        return cast("DeviceBuilder", PLUGINS.load(name))
    except PluginError as error:
        raise DeviceError(f'the device "{name}" is not available: {error}') from error


def check_device_name(text: str) -> None:
    """Check NAME or NAME:ADDRESS of `robot.device` or `--device` without opening the device.

    Raises:
        DeviceError: No such device, its plug-in cannot be loaded, or an address is missing or not allowed.
    """
    device = split_device(text)
    if device.name not in ADDRESSES:
        find_plugin(device.name)
        return
    wanted = ADDRESSES[device.name]
    if wanted == "" and device.address:
        raise DeviceError(f'"{device.name}" is built in and has no address', f'write "{device.name}"')
    if wanted and not device.address:
        raise DeviceError(f'"{device.name}" needs an address', f"write {device.name}:{wanted}")
