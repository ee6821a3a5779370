"""Life cycle of a device: its states, the steps between them, and what drives each step.

States and steps have the names of the hardware components of ros2_control. What makes a step here:

    configure   the builder: it opens the line, asks what answers there and has it calibrate; no power by a command
    activate    the loop: the word COMMAND_ENABLED becomes 1 once the device has answered (SafetyState HOMED)
    deactivate  the loop: the word becomes 0 in the tick of a latched stop; any fault ends so. Besides, the engine at
                the end of a run
    cleanup     the engine: `DevicePlugin.close`; the same name may be configured again, by its builder
    shutdown    the engine, after cleanup: this object is never used again

A device is never cleaned up or shut down with power: unlike there, `shutdown` of an active device is refused, so that
every way out of "active" leads through "inactive".
"""

from __future__ import annotations

from collections.abc import Mapping
from enum import StrEnum

from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.loop.haptic import SafetyState

__all__ = ["LIFE_IN", "LIFE_STEPS", "DeviceLife", "LifeStep", "life_after"]


class DeviceLife(StrEnum):
    """States of a device.

    UNCONFIGURED: a name and its settings; nothing communicates. INACTIVE: it communicates, its drives have no power by
    a command. ACTIVE: its drives follow commands. FINALISED: at its end.
    """

    UNCONFIGURED = "unconfigured"
    INACTIVE = "inactive"
    ACTIVE = "active"
    FINALISED = "finalised"


class LifeStep(StrEnum):
    """Steps of a device from one state to another."""

    CONFIGURE = "configure"
    ACTIVATE = "activate"
    DEACTIVATE = "deactivate"
    CLEANUP = "cleanup"
    SHUTDOWN = "shutdown"


LIFE_STEPS: Mapping[tuple[DeviceLife, LifeStep], DeviceLife] = {
    (DeviceLife.UNCONFIGURED, LifeStep.CONFIGURE): DeviceLife.INACTIVE,
    (DeviceLife.INACTIVE, LifeStep.ACTIVATE): DeviceLife.ACTIVE,
    (DeviceLife.ACTIVE, LifeStep.DEACTIVATE): DeviceLife.INACTIVE,
    (DeviceLife.INACTIVE, LifeStep.CLEANUP): DeviceLife.UNCONFIGURED,
    (DeviceLife.UNCONFIGURED, LifeStep.SHUTDOWN): DeviceLife.FINALISED,
    (DeviceLife.INACTIVE, LifeStep.SHUTDOWN): DeviceLife.FINALISED,
}
"""State after each step that is taken; every other pair is refused."""

LIFE_IN: Mapping[SafetyState, DeviceLife] = {
    SafetyState.OFF: DeviceLife.INACTIVE,
    SafetyState.INIT: DeviceLife.INACTIVE,
    SafetyState.HOMED: DeviceLife.ACTIVE,
    SafetyState.READY: DeviceLife.ACTIVE,
    SafetyState.ACTIVE: DeviceLife.ACTIVE,
    SafetyState.DEGRADED: DeviceLife.ACTIVE,
    SafetyState.SAFE_STOP: DeviceLife.INACTIVE,
    SafetyState.E_STOP: DeviceLife.INACTIVE,
}
"""State of a device in a loop, by the state of the loop's safety machine: COMMAND_ENABLED is 1 where it is active."""

_FIX = {
    DeviceLife.UNCONFIGURED: "build it first",
    DeviceLife.INACTIVE: "it can be activated or cleaned up",
    DeviceLife.ACTIVE: "deactivate it first",
    DeviceLife.FINALISED: "build another one",
}


def life_after(life: DeviceLife, step: LifeStep) -> DeviceLife:
    """Return the state after a step.

    Raises:
        DeviceError: The step is refused in this state.
    """
    after = LIFE_STEPS.get((life, step))
    if after is None:
        raise DeviceError(f'the step "{step}" is refused while the device is {life}', _FIX[life])
    return after
