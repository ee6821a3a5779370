"""The descriptor of a device by its name: known before it is opened, and for a recording of one that is gone."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from mimics_app.contracts.device_descriptor import DeviceDescriptor
from mimics_app.contracts.errors import DeviceError
from mimics_app.rendering.haptic.descriptors.hapticmaster import HAPTICMASTER
from mimics_app.rendering.haptic.devices.address import split_device
from mimics_app.rendering.haptic.devices.device_names import ADDRESSES, find_plugin

__all__ = ["descriptor_of"]

_OTHERS = {
    "simulated_leg": ("mimics_app.rendering.haptic.descriptors.leg", "LEG"),
    "simulated_legs": ("mimics_app.rendering.haptic.descriptors.leg", "LEGS"),
}
"""Built-in devices that are no HapticMaster: module and name of their descriptor, imported when asked for."""


def descriptor_of(device: str) -> DeviceDescriptor:
    """What the loop must know of a device.

    Args:
        device: NAME or NAME:ADDRESS, as `robot.device` has it.

    Raises:
        DeviceError: No device of that name, or what its plug-in says of it is no descriptor.
    """
    name = split_device(device).name
    if name in _OTHERS:
        module, place = _OTHERS[name]
        found: Any = getattr(import_module(module), place)
    elif name in ADDRESSES:
        return HAPTICMASTER
    else:
        found = getattr(find_plugin(name), "descriptor", HAPTICMASTER)
    if not isinstance(found, DeviceDescriptor):
        raise DeviceError(
            f'the plug-in of device "{name}" has a descriptor of type {type(found).__name__}',
            "decorate its builder with contracts.device_descriptor.described(DeviceDescriptor(...))",
        )
    return found
