"""Who moves the hand in a session."""

from __future__ import annotations

from typing import Literal

from mimics_app.contracts.loop.loop_ports import DevicePlugin
from mimics_app.rendering.haptic.devices.device_names import POINTER

__all__ = ["Mover", "mover_of"]

Mover = Literal["at the pointer", "at the robot", "simulated"]
"""Who moves the hand, as in the header of a recording."""


def mover_of(plugin: DevicePlugin) -> Mover:
    """Return who moves the hand with a device."""
    if plugin.name == POINTER:
        return "at the pointer"
    return "simulated" if plugin.simulated else "at the robot"
