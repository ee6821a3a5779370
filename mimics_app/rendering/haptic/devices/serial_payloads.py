"""Payloads of the serial robot's frames, packed and unpacked in place: float32 first, then small integers.

A payload lies in an aligned buffer of PAYLOAD_PLACES float64 places. Little-endian machines only.
"""

from __future__ import annotations

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import U1, Vec
from mimics_app.contracts.loop.loop_ports import (
    COMMAND_BELT,
    COMMAND_DQ,
    COMMAND_ENABLED,
    COMMAND_FORCE,
    COMMAND_STATE,
    COMMAND_TORQUE,
    DATA_AGE,
    DATA_BUTTONS,
    DATA_DQ,
    DATA_FORCE,
    DATA_GRASP,
    DATA_Q,
    DATA_TORQUE,
    INBOX_ACTIVE,
    INBOX_BUTTONS,
    INBOX_GRASP,
    INBOX_TARGET,
    INBOX_TRIAL,
)
from mimics_app.rendering.haptic.devices.serial_frames import (
    BYTE,
    HEADER,
    LOW_BYTE,
    LOW_WORD,
    MAX_PAYLOAD,
    word_at,
)

__all__ = [
    "FRAME_PLACES",
    "PAYLOAD_PLACES",
    "ROBOT_FAULT",
    "ROBOT_NOT_HOMED",
    "ROBOT_READY",
    "fetch_payload",
    "pack_command",
    "pack_leg_command",
    "pack_leg_state",
    "pack_screen",
    "pack_state",
    "unpack_command",
    "unpack_leg_command",
    "unpack_leg_state",
    "unpack_screen",
    "unpack_state",
]


PAYLOAD_PLACES = MAX_PAYLOAD // 8
FRAME_PLACES = 1 + PAYLOAD_PLACES + 1
"""float64 places of a frame: header (one place, so that the payload is aligned), payload and checksum."""

ROBOT_READY, ROBOT_NOT_HOMED, ROBOT_FAULT = 0, 1, 2
"""Status byte of a STATE frame."""

_MICRO = 1e-6

_STATE_AGE, _SCREEN_TRIAL, _LEG_STATE_AGE = 42, 18, 50
"""Offset of the 16-bit word of a STATE, a SCREEN and a LEG_STATE payload."""

_LEG_JOINTS = 4

_LEG_ENABLED, _LEG_LOOP = 20, 21
"""Offsets of the bytes of a LEG_COMMAND payload: enabled, state of the loop."""

_LEG_BUTTONS, _LEG_STATUS = 48, 49
"""Offsets of the bytes of a LEG_STATE payload: buttons, status."""


@kernel
def fetch_payload(buffer: U1, frame: int, payload: Vec) -> None:
    """Copy the payload of the frame at buffer[frame:] to an aligned buffer."""
    into = payload.view(np.uint8)
    for i in range(int(buffer[frame + 2])):
        into[i] = buffer[frame + HEADER + i]


@kernel
def _put_word(small: U1, place: int, value: float) -> None:
    word = int(min(float(LOW_WORD), max(0.0, value)))
    small[place] = word & LOW_BYTE
    small[place + 1] = word >> BYTE


@kernel
def pack_command(command: Vec, usable: bool, payload: Vec) -> None:
    """Pack six float32 (joint velocities, force), enabled, state; zeros and disabled where `usable` is False."""
    floats, small = payload.view(np.float32), payload.view(np.uint8)
    for i in range(3):
        floats[i] = command[COMMAND_DQ + i] if usable else 0.0
        floats[3 + i] = command[COMMAND_FORCE + i] if usable else 0.0
    small[24] = 1 if usable and command[COMMAND_ENABLED] != 0.0 else 0
    small[25] = int(command[COMMAND_STATE]) & LOW_BYTE if usable else 0


@kernel
def unpack_command(payload: Vec, command: Vec) -> None:
    """Unpack what `pack_command` packed."""
    floats, small = payload.view(np.float32), payload.view(np.uint8)
    for i in range(3):
        command[COMMAND_DQ + i] = floats[i]
        command[COMMAND_FORCE + i] = floats[3 + i]
    command[COMMAND_ENABLED] = float(small[24])
    command[COMMAND_STATE] = float(small[25])


@kernel
def pack_state(data: Vec, status: int, payload: Vec) -> None:
    """Pack ten float32 (joints, velocities, force, grasp), buttons, status, age [us]."""
    floats, small = payload.view(np.float32), payload.view(np.uint8)
    for i in range(3):
        floats[i] = data[DATA_Q + i]
        floats[3 + i] = data[DATA_DQ + i]
        floats[6 + i] = data[DATA_FORCE + i]
    floats[9] = data[DATA_GRASP]
    small[40] = int(data[DATA_BUTTONS]) & LOW_BYTE
    small[41] = status
    _put_word(small, _STATE_AGE, data[DATA_AGE] / _MICRO)


@kernel
def unpack_state(payload: Vec, data: Vec) -> int:
    """Unpack what `pack_state` packed; return the status byte."""
    floats, small = payload.view(np.float32), payload.view(np.uint8)
    for i in range(3):
        data[DATA_Q + i] = floats[i]
        data[DATA_DQ + i] = floats[3 + i]
        data[DATA_FORCE + i] = floats[6 + i]
    data[DATA_GRASP] = floats[9]
    data[DATA_BUTTONS] = float(small[40])
    data[DATA_AGE] = word_at(small, _STATE_AGE) * _MICRO
    return int(small[41])


@kernel
def pack_leg_command(command: Vec, usable: bool, payload: Vec) -> None:
    """Pack five float32 (joint torques, belt), enabled, state; zeros and disabled where `usable` is False."""
    floats, small = payload.view(np.float32), payload.view(np.uint8)
    for i in range(_LEG_JOINTS):
        floats[i] = command[COMMAND_TORQUE + i] if usable else 0.0
    floats[_LEG_JOINTS] = command[COMMAND_BELT] if usable else 0.0
    small[_LEG_ENABLED] = 1 if usable and command[COMMAND_ENABLED] != 0.0 else 0
    small[_LEG_LOOP] = int(command[COMMAND_STATE]) & LOW_BYTE if usable else 0


@kernel
def unpack_leg_command(payload: Vec, command: Vec) -> None:
    """Unpack what `pack_leg_command` packed."""
    floats, small = payload.view(np.float32), payload.view(np.uint8)
    for i in range(_LEG_JOINTS):
        command[COMMAND_TORQUE + i] = floats[i]
    command[COMMAND_BELT] = floats[_LEG_JOINTS]
    command[COMMAND_ENABLED] = float(small[_LEG_ENABLED])
    command[COMMAND_STATE] = float(small[_LEG_LOOP])


@kernel
def pack_leg_state(data: Vec, status: int, payload: Vec) -> None:
    """Pack twelve float32 (joints, velocities, torques of the legs on the drives), buttons, status, age [us]."""
    floats, small = payload.view(np.float32), payload.view(np.uint8)
    for i in range(_LEG_JOINTS):
        floats[i] = data[DATA_Q + i]
        floats[_LEG_JOINTS + i] = data[DATA_DQ + i]
        floats[2 * _LEG_JOINTS + i] = data[DATA_TORQUE + i]
    small[_LEG_BUTTONS] = int(data[DATA_BUTTONS]) & LOW_BYTE
    small[_LEG_STATUS] = status
    _put_word(small, _LEG_STATE_AGE, data[DATA_AGE] / _MICRO)


@kernel
def unpack_leg_state(payload: Vec, data: Vec) -> int:
    """Unpack what `pack_leg_state` packed; return the status byte."""
    floats, small = payload.view(np.float32), payload.view(np.uint8)
    for i in range(_LEG_JOINTS):
        data[DATA_Q + i] = floats[i]
        data[DATA_DQ + i] = floats[_LEG_JOINTS + i]
        data[DATA_TORQUE + i] = floats[2 * _LEG_JOINTS + i]
    data[DATA_BUTTONS] = float(small[_LEG_BUTTONS])
    data[DATA_AGE] = word_at(small, _LEG_STATE_AGE) * _MICRO
    return int(small[_LEG_STATUS])


@kernel
def pack_screen(inbox: Vec, payload: Vec) -> None:
    """Pack four float32 (target, grasp), buttons, active, trial: the inputs of a simulated person."""
    floats, small = payload.view(np.float32), payload.view(np.uint8)
    for i in range(3):
        floats[i] = inbox[INBOX_TARGET + i]
    floats[3] = inbox[INBOX_GRASP]
    small[16] = int(inbox[INBOX_BUTTONS]) & LOW_BYTE
    small[17] = 1 if inbox[INBOX_ACTIVE] != 0.0 else 0
    _put_word(small, _SCREEN_TRIAL, float(int(inbox[INBOX_TRIAL]) & LOW_WORD))


@kernel
def unpack_screen(payload: Vec, inbox: Vec) -> None:
    """Unpack what `pack_screen` packed."""
    floats, small = payload.view(np.float32), payload.view(np.uint8)
    for i in range(3):
        inbox[INBOX_TARGET + i] = floats[i]
    inbox[INBOX_GRASP] = floats[3]
    inbox[INBOX_BUTTONS] = float(small[16])
    inbox[INBOX_ACTIVE] = float(small[17])
    inbox[INBOX_TRIAL] = float(word_at(small, _SCREEN_TRIAL))
