"""Port between the 1 kHz loop and a device plug-in: two compiled functions over preallocated vectors.

A plug-in is compiled separately, with these fixed signatures, and passed to the loop as first-class functions, so that
the loop's own machine code does not depend on it. Both functions are called once per tick, `read` first:

    status = read(memory, inbox, data, tick)      device -> loop
    write(memory, command, tick)                  loop -> device

Rules: no allocation, no exception, no blocking call, no index out of range. `memory` belongs to the plug-in and holds
all of its state. Devices use their own frame (the HapticMaster the WCS of D2.1 Figure 9); the loop converts to the
world. The descriptor gives the joints and points of contact of a device (contracts/loop/device_descriptor.py). After
the last tick a device that is not simulated gets some more calls of both, with a command of zeros.

A force field is a plug-in for forces: one function of position, velocity and time, in the world frame,

    field(parameters, p, v, t, out)

with its parameters (shape [FIELD_PARAMETERS]), position [m] and velocity [m/s] relative to the field's own, the
session's time [s], and the force out [N]. It has no state. A field that returns a number that is not finite is
quarantined: its force counts as zero until it is disabled and enabled again.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numba import types
from numpy.typing import NDArray

from mimics_app.contracts.loop.controller_slots import CommandKind
from mimics_app.contracts.loop.loop_fields import MAX_CONTACTS, MAX_JOINTS

if TYPE_CHECKING:
    from mimics_app.contracts.loop.device_descriptor import DeviceDescriptor

__all__ = [
    "COMMAND_BELT",
    "COMMAND_DQ",
    "COMMAND_ENABLED",
    "COMMAND_FORCE",
    "COMMAND_LENGTH",
    "COMMAND_STATE",
    "COMMAND_TORQUE",
    "COMMAND_VIBRATION",
    "DATA_AGE",
    "DATA_BUTTONS",
    "DATA_DELAY",
    "DATA_DQ",
    "DATA_FORCE",
    "DATA_GRASP",
    "DATA_LENGTH",
    "DATA_Q",
    "DATA_TORQUE",
    "FIELD",
    "FIELDS",
    "FIELD_PARAMETERS",
    "INBOX_ACTIVE",
    "INBOX_BUTTONS",
    "INBOX_GRASP",
    "INBOX_LENGTH",
    "INBOX_TARGET",
    "INBOX_TRIAL",
    "LIGHTEST_DEVICE",
    "MAX_FIELDS",
    "READ",
    "WRITE",
    "DevicePlugin",
]

DATA_Q = 0
"""Measured joints [m or rad], MAX_JOINTS places; those beyond the device's stay 0, here and below."""
DATA_DQ = DATA_Q + MAX_JOINTS
"""Measured joint velocities [m/s or rad/s]."""
DATA_FORCE = DATA_DQ + MAX_JOINTS
"""Force of the user on each point of contact, x y z concatenated, sensor frame [N]; HapticMaster: r t z."""
DATA_TORQUE = DATA_FORCE + 3 * MAX_CONTACTS
"""Torque of the user on each joint [N or N m], in addition to those forces; of a device with torques."""
DATA_GRASP = DATA_TORQUE + MAX_JOINTS
"""Grasp force at each point of contact [N]."""
DATA_BUTTONS = DATA_GRASP + MAX_CONTACTS
"""Button bits as a float."""
DATA_AGE = DATA_BUTTONS + 1
"""Age of this data when read [s]; 0 for data taken at the tick."""
DATA_DELAY = DATA_AGE + 1
"""Measured time from a command to the data that shows its effect, less one tick [s]; 0 if not measured. The stability
limit uses the larger of this and `DevicePlugin.delay`."""
DATA_LENGTH = DATA_DELAY + 1

COMMAND_DQ = 0
"""Joint velocities [m/s or rad/s], the command of an admittance device."""
COMMAND_FORCE = COMMAND_DQ + MAX_JOINTS
"""Force on the user at each point of contact, x y z, robot frame [N], the command of an impedance device."""
COMMAND_TORQUE = COMMAND_FORCE + 3 * MAX_CONTACTS
"""Torque at each joint [N or N m], J^T of those forces, the command of an impedance device with torques."""
COMMAND_VIBRATION = COMMAND_TORQUE + MAX_JOINTS
"""Strength 0-1 at each point of contact, force on the user over the force limit, for devices that only vibrate."""
COMMAND_ENABLED = COMMAND_VIBRATION + MAX_CONTACTS
"""1 while the drives may act; 0: the device must go limp or brake."""
COMMAND_STATE = COMMAND_ENABLED + 1
"""SafetyState, for devices that show it."""
COMMAND_BELT = COMMAND_STATE + 1
"""Speed of a treadmill's belt backwards [m/s]: of the reference of the joints, times its amplitude and the share that
the controller gives it; 0 without a reference, and while no controller acts."""
COMMAND_LENGTH = COMMAND_ENABLED + 3

INBOX_TARGET = 0
"""Target of the pointing device or person for each point of contact, x y z concatenated, robot frame [m]."""
INBOX_GRASP = INBOX_TARGET + 3 * MAX_CONTACTS
"""Grasp force requested at each point of contact [N]."""
INBOX_BUTTONS = INBOX_GRASP + MAX_CONTACTS
"""Button bits as a float."""
INBOX_ACTIVE = INBOX_BUTTONS + 1
"""1: a pointer is held, or the simulated person may act."""
INBOX_TRIAL = INBOX_ACTIVE + 1
"""Number of the trial; a change restarts a simulated person."""
INBOX_LENGTH = INBOX_TRIAL + 1

_VECTOR = types.float64[::1]

READ = types.int64(_VECTOR, _VECTOR, _VECTOR, types.int64)
"""Signature of `read(memory, inbox, data, tick) -> DeviceStatus`."""

WRITE = types.int64(_VECTOR, _VECTOR, types.int64)
"""Signature of `write(memory, command, tick) -> 0 when the command was taken`; a device that sends data and takes none
for longer than `stale_stop_s` has a fault."""

FIELD_PARAMETERS = 8
"""Number of parameters of a force field; those missing in a scene are 0."""

FIELD = types.void(_VECTOR, _VECTOR, _VECTOR, types.float64, _VECTOR)
"""Signature of a force field `field(parameters, p, v, t, out)`; compile it with `typed_kernel(FIELD)`."""

LIGHTEST_DEVICE = 0.05
"""Mass [kg] assumed of a device that takes forces and does not state its own; lighter is stricter."""

MAX_FIELDS = 4
"""Largest number of different force fields of a session."""

FIELDS = types.UniTuple(types.FunctionType(FIELD), MAX_FIELDS)  # type: ignore[no-untyped-call]
"""Compiled type of the force fields of a session: first-class, so that the loop's code does not depend on them."""


def _nothing() -> None:
    return None


def _no_trouble() -> str:
    return ""


@dataclass(frozen=True, slots=True)
class DevicePlugin:
    """A device of the loop.

    Attributes:
        name: Name in the scene's `robot.device`.
        read: Function compiled with `typed_kernel(READ)`.
        write: Function compiled with `typed_kernel(WRITE)`.
        memory: State of the plug-in, float64, shape [n]; changed in place by `read` and `write`.
        close: Called once, after the loop has ended and the device was disabled.
        delay: Delay from command to motion [s], for the stability limit: transport and servo lag.
        lag: Part of `delay` that is the first-order lag of a velocity servo [s].
        filtering: Time constant of the filter of the measured velocity [s].
        quantum: Resolution of the measured position at a point of contact [m]; 0: far below a micrometre, or not known.
        mass: Smallest mass at a point of contact of a device that takes forces [kg], without a hand; 0: not known, then
            the stability limit assumes LIGHTEST_DEVICE.
        follows: Part of the command that moves the device: joint velocities (admittance), force or torque (impedance),
            or nothing ("vibration" moves nothing either).
        own_mass: True for a device that renders a virtual mass of its own: the loop's does not move it, so that the
            energy of a contact is not known from it, and the passivity controller is off.
        real_time: True for a device that cannot run faster than real time.
        simulated: True for a computed device, or a mouse or gamepad over one: no real drive keeps acting when a tick is
            late, so that a late tick never latches a stop.
        trouble: Returns the device's present fault in words for the user, "" for none; main thread only.
        descriptor: Joints, points of contact and kinematics; None: those of the HapticMaster.
    """

    name: str
    read: Callable[..., Any]
    write: Callable[..., Any]
    memory: NDArray[np.float64]
    close: Callable[[], None] = _nothing
    delay: float = 0.0
    lag: float = 0.0
    filtering: float = 0.0
    quantum: float = 0.0
    mass: float = 0.0
    follows: Literal["velocity", "force", "torque", "vibration", "nothing"] = "velocity"
    own_mass: bool = False
    real_time: bool = False
    simulated: bool = False
    trouble: Callable[[], str] = _no_trouble
    descriptor: DeviceDescriptor | None = None

    @property
    def takes(self) -> tuple[CommandKind, ...]:
        """What a controller may command while the person leads; a drive to a target may command velocities of any."""
        if self.follows == "torque":
            return (CommandKind.FORCE, CommandKind.TORQUE)
        return (CommandKind.FORCE,) if self.follows == "force" else (CommandKind.VELOCITY,)
