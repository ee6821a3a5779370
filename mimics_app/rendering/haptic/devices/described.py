"""Descriptors of devices by name, without opening the device: also for recordings of absent devices."""

from __future__ import annotations

from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.loop.device_descriptor import DeviceDescriptor
from mimics_app.contracts.ports.members import load_member
from mimics_app.rendering.haptic import descriptors
from mimics_app.rendering.haptic.descriptors.hapticmaster import HAPTICMASTER
from mimics_app.rendering.haptic.devices.address import split_device
from mimics_app.rendering.haptic.devices.device_names import BUILT_IN, find_plugin, load_built_in

__all__ = ["descriptor_of"]


def descriptor_of(device: str) -> DeviceDescriptor:
    """Return the descriptor of a device.

    Args:
        device: NAME or NAME:ADDRESS, as in `robot.device`.

    Raises:
        DeviceError: No such device, or its plug-in's descriptor has the wrong type.
    """
    name = split_device(device).name
    if name in BUILT_IN:
        module, _, constant = load_built_in(name).descriptor.partition(":")
        return load_member(descriptors, module, constant, DeviceDescriptor)
    found = getattr(find_plugin(name), "descriptor", HAPTICMASTER)
    if not isinstance(found, DeviceDescriptor):
        raise DeviceError(
            f'the plug-in of device "{name}" has a descriptor of type {type(found).__name__}',
            "decorate its builder with contracts.loop.device_descriptor.described(DeviceDescriptor(...))",
        )
    return found
