"""Who can play a scene from the launcher: devices with their captions, and why one cannot play a scene."""

from __future__ import annotations

from collections.abc import Mapping

from mimics_app.app.scenes.shipped import ShippedScene
from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.loop.device_descriptor import DeviceDescriptor
from mimics_app.contracts.system.phrases import phrase
from mimics_app.rendering.haptic.devices.described import descriptor_of
from mimics_app.rendering.haptic.devices.device_names import (
    BUILT_IN,
    POINTER,
    REPLAY,
    device_names,
    load_built_in,
)

__all__ = ["ADDRESSED", "AT_WINDOW", "players", "refusals"]

AT_WINDOW = ""
"""Value of the setting "who plays" for the person at the window."""

ADDRESSED = tuple(name for name in BUILT_IN if load_built_in(name).address and not load_built_in(name).optional)
"""Devices that need an address."""


def players() -> dict[str, str]:
    """Return the captions of the devices: the person at the window first, what needs an address last."""
    others = sorted((name for name in device_names() if name not in (POINTER, REPLAY)), key=ADDRESSED.__contains__)
    captions = {name: load_built_in(name).caption if name in BUILT_IN else name for name in others}
    return {AT_WINDOW: load_built_in(POINTER).caption, **captions}


def refusals(scene: ShippedScene) -> Mapping[tuple[str, str], str]:
    """Return why a scene cannot be played, by ("device", value): its robot has another shape than the device."""
    if not scene.device:
        return {}
    captions, wanted = players(), descriptor_of(scene.device)
    fitting = [value for value in captions if _fits(value, wanted) or value.partition(":")[0] in scene.also]
    named = scene.device if scene.device in fitting else next(iter(fitting), scene.device)
    words = phrase(
        "This scene is played with {limb:s}. Choose: {device}", limb=scene.takes, device=captions.get(named, named)
    )
    return {("device", value): words for value in captions if value not in fitting}


def _fits(value: str, wanted: DeviceDescriptor) -> bool:
    """Whether a device has the joints and points of contact that a scene is made for, as far as is known."""
    try:
        there = descriptor_of(value.partition(":")[0] or POINTER)
    except DeviceError:
        return True  # what is wrong with it is said at the start
    return there.extent.joints == wanted.extent.joints and there.contacts == wanted.contacts
