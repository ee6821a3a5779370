"""The names a device can be requested by, and what may follow them. It imports no device.

A command asks here before it imports compiled code: a name that leads nowhere is refused at once.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.contracts.errors import DeviceError, nearest
from mimics_app.rendering.haptic.devices.address import split_device

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

    from mimics_app.rendering.haptic.devices.request import DeviceBuilder

__all__ = [
    "ADDRESSES",
    "ENTRY_POINT_GROUP",
    "POINTER",
    "REPLAY",
    "SIMULATED",
    "check_device_name",
    "device_names",
    "find_plugin",
]

ENTRY_POINT_GROUP = "mimics_app.devices"

SIMULATED = "simulated_hapticmaster"
"""The device of a scene that names none, held by a simulated person."""

POINTER = "pointer"
"""The same robot, held by a person at a window."""

REPLAY = "replay"
"""The device that plays the sensors of a recording."""

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
"""Devices that come with the product, and what stands behind the colon of each name; "": nothing may. A plug-in cannot
take one of these names, and judges its addresses itself."""


def device_names() -> list[str]:
    """Names of all devices that can be requested: built-in first, then installed plug-ins."""
    return [*ADDRESSES, *sorted(set(_installed()) - set(ADDRESSES))]


def find_plugin(name: str) -> DeviceBuilder:
    """The builder of a device of another package.

    Raises:
        DeviceError: No device of that name, or its plug-in cannot be imported.
    """
    installed = _installed()
    if name not in installed:
        raise DeviceError(f'there is no device "{name}"', nearest(name, [*ADDRESSES, *installed]))
    try:
        builder: DeviceBuilder = installed[name].load()
    except Exception as failure:
        what = f'the plug-in of device "{name}" cannot be loaded: {type(failure).__name__}: {failure}'
        raise DeviceError(what) from failure
    return builder


def check_device_name(text: str) -> None:
    """Whether NAME or NAME:ADDRESS, as `robot.device` and `--device` have it, can be requested. Opens nothing.

    Raises:
        DeviceError: No device of that name, its plug-in cannot be imported, or the address is missing or one too many.
    """
    device = split_device(text)
    if device.name not in ADDRESSES:
        find_plugin(device.name)
        return
    wanted = ADDRESSES[device.name]
    if wanted == "" and device.address:
        raise DeviceError(f'"{device.name}" is in this program: it has no address', f'write "{device.name}"')
    if wanted and not device.address:
        raise DeviceError(f'"{device.name}" needs an address', f"write {device.name}:{wanted}")


def _installed() -> dict[str, EntryPoint]:
    from importlib.metadata import entry_points

    return {point.name: point for point in entry_points(group=ENTRY_POINT_GROUP)}
