"""Names of devices: the built-in ones, which are the modules of `built_in`, and those of installed packages.

Commands check a name here before they import compiled code, so that an unknown one is refused at once.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple, cast

from mimics_app.contracts.errors import DeviceError, nearest
from mimics_app.contracts.ports.members import load_member, member_names
from mimics_app.contracts.ports.plugins import PluginError, PluginGroup
from mimics_app.rendering.haptic.devices import built_in
from mimics_app.rendering.haptic.devices.address import split_device

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.devices.request import DeviceBuilder

__all__ = [
    "BUILT_IN",
    "PLUGINS",
    "POINTER",
    "REPLAY",
    "SIMULATED",
    "BuiltInDevice",
    "check_device_name",
    "device_names",
    "find_plugin",
    "load_built_in",
    "recording_of",
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


_RECORDED = ":log:"
"""Part of an address before the run folder of a recording."""


def recording_of(text: str) -> Path | None:
    """Return the run folder that NAME:log:RUN names, None for another address."""
    name, found, folder = text.partition(_RECORDED)
    return Path(folder) if found and ":" not in name and name in BUILT_IN and folder else None


class BuiltInDevice(NamedTuple):
    """A built-in device: `DEVICE` of its module.

    Attributes:
        about: What it is, in a sentence.
        caption: Who plays with it, for the launcher.
        builder: "module:function" in this package.
        address: Form of its address; "" for none.
        descriptor: "module:name" in `descriptors`.
        optional: True where the address may be left out.
        dynamics: "module:function" in this package, of what is known of its dynamics before it is open; "" for nothing.
        walks: True where the simulated person in it acts without a path or target: it walks.
    """

    about: str
    caption: str
    builder: str
    address: str = ""
    descriptor: str = "hapticmaster:HAPTICMASTER"
    optional: bool = False
    dynamics: str = ""
    walks: bool = False


BUILT_IN = member_names(built_in)
"""Names of the built-in devices. A plug-in cannot use one of these names, and checks its addresses itself."""


def load_built_in(name: str) -> BuiltInDevice:
    """Return the built-in device of a name; what builds it is not imported."""
    return load_member(built_in, name, "DEVICE", BuiltInDevice)


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
    found = load_built_in(device.name)
    if not found.address and device.address:
        raise DeviceError(f'"{device.name}" is built in and has no address', f'write "{device.name}"')
    if found.address and not device.address and not found.optional:
        raise DeviceError(f'"{device.name}" needs an address', f"write {device.name}:{found.address}")
