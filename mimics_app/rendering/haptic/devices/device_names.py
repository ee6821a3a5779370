"""Names of devices, and the table of the built-in ones, without importing any device.

Commands check a name here before they import compiled code, so that an unknown one is refused at once.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple, cast

from mimics_app.contracts.errors import DeviceError, nearest
from mimics_app.contracts.plugins import PluginError, PluginGroup
from mimics_app.rendering.haptic.devices.address import split_device

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.devices.request import DeviceBuilder

__all__ = [
    "BUILT_IN",
    "PLUGINS",
    "POINTER",
    "REPLAY",
    "SIMULATED",
    "BuiltIn",
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


class BuiltIn(NamedTuple):
    """A built-in device.

    Attributes:
        builder: "module:function" in this package.
        about: What it is, in a sentence.
        address: Form of its address; "" for none.
        descriptor: "module:name" in `descriptors`.
    """

    builder: str
    about: str
    address: str = ""
    descriptor: str = "hapticmaster:HAPTICMASTER"


BUILT_IN = {
    SIMULATED: BuiltIn(
        "simulated_hapticmaster:build_simulated_hapticmaster", "The simulated HapticMaster, with a simulated person."
    ),
    "simulated_impedance": BuiltIn(
        "simulated_impedance:build_simulated_impedance",
        "A simulated light robot that takes forces, with a simulated person.",
    ),
    POINTER: BuiltIn("pointer:build_pointer", "The simulated robot moved by mouse, gamepad or keyboard."),
    REPLAY: BuiltIn("replay:build_replay", "The sensor data of a recording, as a device."),
    "simulated_leg": BuiltIn(
        "simulated_leg:build_simulated_leg",
        "One simulated leg on a gait orthosis with drives at hip and knee; a simulated person moves the foot.",
        descriptor="leg:LEG",
    ),
    "simulated_legs": BuiltIn(
        "simulated_leg:build_simulated_leg",
        "Two simulated legs on a gait orthosis with four drives; a simulated person moves the first foot.",
        descriptor="leg:LEGS",
    ),
    "serial": BuiltIn(
        "serial_port:build_serial",
        "A robot on a serial line, by the protocol of docs/devices/serial_protocol.md.",
        "PORT[@BAUD]",
    ),
    "hapticmaster": BuiltIn(
        "hapticmaster_port:build_hapticmaster",
        "A HapticMaster on the network, by its command interface.",
        "HOST[:PORT]",
    ),
}
"""Built-in devices by name; each is imported on request. A plug-in cannot use one of these names, and checks its
addresses itself."""


def device_names() -> list[str]:
    """Return the names of all devices: built-in first, then installed plug-ins."""
    return [*BUILT_IN, *sorted(set(PLUGINS.names()) - set(BUILT_IN))]


def find_plugin(name: str) -> DeviceBuilder:
    """Return the builder of a plug-in device.

    Raises:
        DeviceError: No such device, or its plug-in cannot be loaded.
    """
    installed = PLUGINS.names()
    if name not in installed:
        raise DeviceError(f'there is no device "{name}"', nearest(name, [*BUILT_IN, *installed]))
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
    if device.name not in BUILT_IN:
        find_plugin(device.name)
        return
    wanted = BUILT_IN[device.name].address
    if wanted == "" and device.address:
        raise DeviceError(f'"{device.name}" is built in and has no address', f'write "{device.name}"')
    if wanted and not device.address:
        raise DeviceError(f'"{device.name}" needs an address', f"write {device.name}:{wanted}")
