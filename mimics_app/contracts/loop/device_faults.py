"""Faults that the loop injects into the data and commands of a simulated device, by name.

`NAME` or `NAME:PLACE`: "encoder_stuck:left knee" is about the joint of that name, "sensor_dead:hand" about the force
sensor at a point of contact. Without a place it is the last joint, or the sensor there; a device without torques has
its sensor at the first point of contact. One fault at a time; "none" ends it.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from mimics_app.contracts.errors import require_choice
from mimics_app.contracts.loop.haptic import Button
from mimics_app.contracts.loop.loop_ports import DATA_BUTTONS, DATA_DQ, DATA_FORCE, DATA_Q, DATA_TORQUE
from mimics_app.contracts.loop.spoiling import Spoiling

if TYPE_CHECKING:
    from mimics_app.contracts.loop.device_descriptor import DeviceDescriptor

__all__ = ["FAULT_NAMES", "FAULT_WORDS", "DeviceFault", "FaultOrder", "fault_order"]


class DeviceFault(NamedTuple):
    """A fault.

    Attributes:
        about: What happens, in words.
        spoiling: What the loop does.
        of: What the place is: "joint", "sensor", or "" for the whole device.
        value: Value of a joint in metres or of a sensor in newtons.
        value_of_turns: Value of a joint in radians or of a sensor in newton metres.
    """

    about: str
    spoiling: Spoiling
    of: str = ""
    value: float = 0.0
    value_of_turns: float = 0.0


_FAULTS = {
    "none": DeviceFault("the fault ends", Spoiling.NOTHING),
    "encoder_stuck": DeviceFault("a joint's encoder keeps its value", Spoiling.FREEZE, "joint"),
    "encoder_lost": DeviceFault("a joint's encoder reads zero", Spoiling.SET, "joint"),
    "encoder_not_finite": DeviceFault("a joint's encoder reads no number", Spoiling.SET, "joint", math.nan, math.nan),
    "encoder_jump": DeviceFault("a joint's encoder has lost pulses", Spoiling.ADD, "joint", 0.01, 0.1),
    "velocity": DeviceFault("a joint's velocity reads too high", Spoiling.SET, "velocity", 3.0, 10.0),
    "sensor_dead": DeviceFault("a force sensor reads zero", Spoiling.SET, "sensor"),
    "sensor_stuck": DeviceFault("a force sensor keeps its value", Spoiling.FREEZE, "sensor"),
    "sensor_not_finite": DeviceFault("a force sensor reads no number", Spoiling.SET, "sensor", math.inf, math.inf),
    "sensor_spike": DeviceFault("a force sensor leaps for one tick", Spoiling.ADD_ONCE, "sensor", 400.0, 120.0),
    "sensor_high": DeviceFault("a force sensor is at its end", Spoiling.SET, "sensor", 300.0, 90.0),
    "sensor_pulls": DeviceFault("a force sensor reads a strong hand", Spoiling.SET, "sensor", 249.0, 75.0),
    "silent": DeviceFault("no data arrive", Spoiling.DROP),
    "garbage": DeviceFault("half of the data arrive damaged, and are not used", Spoiling.DROP_SOME),
    "late": DeviceFault("data arrive 15 ticks late", Spoiling.DELAY),
    "drive_fault": DeviceFault("the device reports a fault", Spoiling.REPORT),
    "button": DeviceFault("the device's stop button is pressed", Spoiling.SET, "button", float(Button.STOP)),
    "deaf": DeviceFault("the device takes no command", Spoiling.REFUSE),
}

FAULT_NAMES = tuple(_FAULTS)
"""Names of the faults, without places."""

FAULT_WORDS = {name: fault.about for name, fault in _FAULTS.items()}
"""What happens in each, for people."""

_VERTICAL = 2
"""Axis of a force sensor that faults are about."""


class FaultOrder(NamedTuple):
    """A fault at its place in the data of a device.

    Attributes:
        spoiling: What the loop does.
        place: Index in the data.
        other: A second index, which is set to 0; -1: none.
        value: The value.
    """

    spoiling: Spoiling
    place: int
    other: int
    value: float


def fault_order(text: str, device: DeviceDescriptor) -> FaultOrder:
    """Return the fault of "NAME" or "NAME:PLACE" for a device.

    Raises:
        UsageError: The fault is unknown, or the device has no such joint or point of contact.
    """
    name, _, place = (part.strip() for part in text.partition(":"))
    require_choice(name, FAULT_NAMES, "fault")
    fault = _FAULTS[name]
    if fault.of == "sensor":
        return _of_sensor(fault, place, device)
    if fault.of in ("joint", "velocity"):
        joint = _joint(place, device)
        value = fault.value if device.joints[joint].unit == "m" else fault.value_of_turns
        if fault.of == "velocity":
            return FaultOrder(fault.spoiling, DATA_DQ + joint, -1, value)
        still = fault.spoiling in (Spoiling.FREEZE, Spoiling.SET)
        return FaultOrder(fault.spoiling, DATA_Q + joint, DATA_DQ + joint if still else -1, value)
    require_choice(place, ("",), f'place of "{name}"')
    return FaultOrder(fault.spoiling, DATA_BUTTONS, -1, fault.value)


def _joint(place: str, device: DeviceDescriptor) -> int:
    names = [joint.name for joint in device.joints]
    if not place:
        return len(names) - 1
    require_choice(place, names, "joint of this device")
    return names.index(place)


def _of_sensor(fault: DeviceFault, place: str, device: DeviceDescriptor) -> FaultOrder:
    """Return a fault of the torque sensor of a joint, or of the force sensor of a point of contact."""
    names = [joint.name for joint in device.joints] if device.torques else list(device.contacts)
    if place:
        require_choice(place, names, "sensor of this device")
    if device.torques:
        joint = names.index(place) if place else len(names) - 1
        return FaultOrder(fault.spoiling, DATA_TORQUE + joint, -1, fault.value_of_turns)
    point = names.index(place) if place else 0
    return FaultOrder(fault.spoiling, DATA_FORCE + 3 * point + _VERTICAL, -1, fault.value)
