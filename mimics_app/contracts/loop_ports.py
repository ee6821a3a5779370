"""The border between the 1 kHz loop and a device plug-in: two compiled functions over preallocated vectors.

A plug-in is compiled alone, with these fixed signatures, and handed to the loop as first-class functions, so that the
loop's own machine code stays valid whatever is plugged in. Both functions are called once per tick, `read` first:

    status = read(memory, inbox, data, tick)      device -> loop
    write(memory, command, tick)                  loop -> device

Rules: no allocation, no exception, no blocking call, no index out of range. `memory` belongs to the plug-in alone and
holds everything it remembers. Devices think in their own frame (of the HapticMaster the WCS of D2.1 Figure 9); the loop
maps to the world. What joints and points of contact a device has its descriptor says (contracts/device_descriptor.py).

A force field is the same kind of thing for forces: one function of place, velocity and time, in the world frame,

    field(parameters, p, v, t, out)

with its own numbers (shape [FIELD_PARAMETERS]), place [m] and velocity [m/s] relative to the field's own, the session's
time [s], and the force [N] to fill in. It remembers nothing. One that gives a number that is not finite is quarantined:
its force counts as zero until it is disabled and enabled again.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numba import types
from numpy.typing import NDArray

from mimics_app.contracts.loop_fields import MAX_CONTACTS, MAX_JOINTS

if TYPE_CHECKING:
    from mimics_app.contracts.device_descriptor import DeviceDescriptor

__all__ = [
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
    "MAX_FIELDS",
    "READ",
    "WRITE",
    "DevicePlugin",
]

DATA_Q = 0
"""Measured joints [m or rad], MAX_JOINTS places; those behind the device's own stay 0, here and below."""
DATA_DQ = DATA_Q + MAX_JOINTS
"""Measured joint velocities [m/s or rad/s]."""
DATA_FORCE = DATA_DQ + MAX_JOINTS
"""Force of the user on each point of contact, x y z one behind the other, frame of its sensor [N]; HapticMaster: r t z.
"""
DATA_TORQUE = DATA_FORCE + 3 * MAX_CONTACTS
"""Torque of the user on each joint [N or N m], beside what those forces make; of a device with torques."""
DATA_GRASP = DATA_TORQUE + MAX_JOINTS
"""Grasp force [N]."""
DATA_BUTTONS = DATA_GRASP + 1
"""Button bits as a float."""
DATA_AGE = DATA_GRASP + 2
"""Age of this data when read [s]; 0 for data taken at the tick."""
DATA_DELAY = DATA_GRASP + 3
"""Measured time from a command to the data that shows what it did, one tick less [s]; 0 where nothing is measured.
The stability limit counts the larger of this and `DevicePlugin.delay`."""
DATA_LENGTH = DATA_GRASP + 4

COMMAND_DQ = 0
"""Joint velocities [m/s or rad/s]: what an admittance device follows."""
COMMAND_FORCE = COMMAND_DQ + MAX_JOINTS
"""Force on the user at each point of contact, x y z, robot frame [N]: what an impedance device renders."""
COMMAND_TORQUE = COMMAND_FORCE + 3 * MAX_CONTACTS
"""Torque at each joint [N or N m], J^T of those forces: what an impedance device with torques renders."""
COMMAND_VIBRATION = COMMAND_TORQUE + MAX_JOINTS
"""Strength 0-1 for each point of contact, force on the user there over the force limit: for what can only vibrate."""
COMMAND_ENABLED = COMMAND_VIBRATION + MAX_CONTACTS
"""1 while the drives may act; 0 asks the device to go limp or brake on its own."""
COMMAND_STATE = COMMAND_ENABLED + 1
"""SafetyState, for devices that show it."""
COMMAND_LENGTH = COMMAND_ENABLED + 2

INBOX_TARGET = 0
"""Where the pointing device points, for the first point of contact, robot frame [m]."""
INBOX_GRASP = 3
"""Grasp force requested [N]."""
INBOX_BUTTONS = 4
"""Button bits as a float."""
INBOX_ACTIVE = 5
"""1: a pointer is held, or the simulated person may act."""
INBOX_TRIAL = 6
"""Counts trials; a simulated person starts over when it changes."""
INBOX_LENGTH = 7

_VECTOR = types.float64[::1]

READ = types.int64(_VECTOR, _VECTOR, _VECTOR, types.int64)
"""Signature of `read(memory, inbox, data, tick) -> DeviceStatus`."""

WRITE = types.int64(_VECTOR, _VECTOR, types.int64)
"""Signature of `write(memory, command, tick) -> 0 when the command was taken`."""

FIELD_PARAMETERS = 8
"""Numbers of one force field; those a scene leaves out are 0."""

FIELD = types.void(_VECTOR, _VECTOR, _VECTOR, types.float64, _VECTOR)
"""Signature of a force field `field(parameters, p, v, t, out)`; compile it with `typed_kernel(FIELD)`."""

MAX_FIELDS = 4
"""Different force fields of one session."""

FIELDS = types.UniTuple(types.FunctionType(FIELD), MAX_FIELDS)  # type: ignore[no-untyped-call]
"""Compiled type of the force fields of a session, so that the loop's own code is the same whatever they are."""


def _nothing() -> None:
    return None


def _no_trouble() -> str:
    return ""


@dataclass(frozen=True, slots=True)
class DevicePlugin:
    """A device as the loop sees it.

    Attributes:
        name: As in the scene's `robot.device`.
        read: Function compiled with `typed_kernel(READ)`.
        write: Function compiled with `typed_kernel(WRITE)`.
        memory: All the plug-in remembers, float64, shape [n]; changed in place by `read` and `write`.
        close: Called once after the loop has ended.
        delay: From a command to the motion it makes [s], for the stability limit: transport and servo lag.
        follows: What in a command moves it: joint velocities (admittance), a force or torques (impedance), or nothing;
            the strength of its vibration moves nobody.
        real_time: True for a device with a time of its own: it cannot be run faster than the clock on the wall.
        simulated: True for a device that is computed, or a mouse or gamepad over one: no drive acts further when a
            tick comes late, so a late tick never latches a stop.
        trouble: What is wrong with the device in words for a person, "" when nothing is; main thread only.
        descriptor: Its joints, points of contact and kinematics; None: those of the HapticMaster.
    """

    name: str
    read: Callable[..., Any]
    write: Callable[..., Any]
    memory: NDArray[np.float64]
    close: Callable[[], None] = _nothing
    delay: float = 0.0
    follows: Literal["velocity", "force", "torque", "vibration", "nothing"] = "velocity"
    real_time: bool = False
    simulated: bool = False
    trouble: Callable[[], str] = _no_trouble
    descriptor: DeviceDescriptor | None = None
