"""Descriptors of devices by name, without opening the device: also for recordings of absent devices."""

from __future__ import annotations

from collections.abc import Callable

from mimics_app.contracts.device_descriptor import DeviceDescriptor
from mimics_app.contracts.errors import DeviceError
from mimics_app.rendering.haptic.descriptors.hapticmaster import HAPTICMASTER
from mimics_app.rendering.haptic.devices.address import split_device
from mimics_app.rendering.haptic.devices.device_names import ADDRESSES, find_plugin

__all__ = ["descriptor_of"]


def _leg() -> DeviceDescriptor:
    from mimics_app.rendering.haptic.descriptors.leg import LEG

    return LEG


def _legs() -> DeviceDescriptor:
    from mimics_app.rendering.haptic.descriptors.leg import LEGS

    return LEGS


_OTHERS: dict[str, Callable[[], DeviceDescriptor]] = {"simulated_leg": _leg, "simulated_legs": _legs}
"""Built-in devices other than the HapticMaster; their descriptors are imported on request."""


def descriptor_of(device: str) -> DeviceDescriptor:
    """Return the descriptor of a device.

    Args:
        device: NAME or NAME:ADDRESS, as in `robot.device`.

    Raises:
        DeviceError: No such device, or its plug-in's descriptor has the wrong type.
    """
    name = split_device(device).name
    if name in _OTHERS:
        return _OTHERS[name]()
    if name in ADDRESSES:
        return HAPTICMASTER
    found = getattr(find_plugin(name), "descriptor", HAPTICMASTER)
    if not isinstance(found, DeviceDescriptor):
        raise DeviceError(
            f'the plug-in of device "{name}" has a descriptor of type {type(found).__name__}',
            "decorate its builder with contracts.device_descriptor.described(DeviceDescriptor(...))",
        )
    return found
