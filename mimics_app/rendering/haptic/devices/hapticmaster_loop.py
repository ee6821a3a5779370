"""Loop side of a HapticMaster on the network (hapticmaster:HOST[:PORT]): compiled read and write on its socket.

The machine runs its own admittance control at 2500 Hz: its virtual mass moves under the measured force and a bias
force, which is sent each tick.

    force stream   while ACTIVE the bias force is the virtual force of this program
    objects        the machine renders the scene's objects itself; the bias force is zero while ACTIVE
    otherwise      (driving to a start) a velocity servo: bias force = gain (wanted - reported velocity), limited

Answers come in the order of the commands, so that the n-th answer ends the round trip of the n-th command. At most
_LARGEST_AHEAD commands are unanswered; a machine that answers more slowly gets fewer.
"""

from __future__ import annotations

import math

import numpy as np

from mimics_app.compiled.file_descriptors import HUNG_UP, READABLE, poll_once, read_bytes, write_bytes
from mimics_app.compiled.kernel import kernel, typed_kernel
from mimics_app.contracts.arrays import U1, Vec
from mimics_app.contracts.loop.haptic import SafetyState
from mimics_app.contracts.loop.loop_ports import (
    COMMAND_DQ,
    COMMAND_ENABLED,
    COMMAND_FORCE,
    COMMAND_LENGTH,
    COMMAND_STATE,
    DATA_AGE,
    DATA_BUTTONS,
    DATA_DELAY,
    DATA_DQ,
    DATA_FORCE,
    DATA_GRASP,
    DATA_Q,
    INBOX_ACTIVE,
    INBOX_BUTTONS,
    INBOX_GRASP,
    INBOX_LENGTH,
    INBOX_TARGET,
    INBOX_TRIAL,
    READ,
    WRITE,
)
from mimics_app.maths.vec import all_finite, clamp_norm, fill
from mimics_app.rendering.haptic.devices.hapticmaster_text import (
    ERROR,
    HEADER,
    NUMBER,
    VECTOR,
    frame_length,
    put_text,
    put_vector,
    seal_text,
    take_answer,
)
from mimics_app.rendering.haptic.devices.link import LINK_LENGTH, drop_link, link_words, take_link
from mimics_app.rendering.haptic.devices.round_trip import (
    TRIP_LENGTH,
    delay_of,
    note_answer,
    note_sent,
    reset_trips,
    silent_for,
    worst_trip,
)
from mimics_app.rendering.haptic.kernels.kinematics import (
    apply_inverse_jacobian,
    apply_jacobian,
    inverse,
    robot_to_tool,
)

__all__ = [
    "AXIS_OFFSET",
    "EMULATED",
    "ERRORS",
    "GAIN",
    "HAPTICMASTER_LENGTH",
    "OBJECTS",
    "OWN_DELAY",
    "SKIPPED",
    "TICK",
    "read_hapticmaster",
    "write_hapticmaster",
]


_LARGEST_AHEAD = 8
"""Largest number of unanswered commands."""

TRIPS = LINK_LENGTH
TICK = TRIPS + TRIP_LENGTH  # [s]
AXIS_OFFSET = TICK + 1  # d1 [m]
GAIN = TICK + 2  # of the velocity servo [N s/m]
OBJECTS = TICK + 3  # 1: the machine renders the objects itself
OWN_DELAY = TICK + 4  # of the machine [s]
EMULATED = TICK + 5  # 1: an emulator, whose simulated person gets the inbox
_ANSWERED = TICK + 6  # frames received
ERRORS = TICK + 7  # answers that are errors
SKIPPED = TICK + 8  # commands not sent because too many were unanswered
_ENABLED = TICK + 9  # 1: the last state sent to the machine is "force"
_FILL = TICK + 10  # bytes in the buffer
_GRASP = TICK + 11  # [N]
_SHOWN = TICK + 12  # tick at which the inbox was last sent
_PENDING = TICK + 13  # bytes of the last frame still to send
_TAKEN = TICK + 14  # bytes of it that were sent
_Q = TICK + 15  # last joints
_X = _Q + 3  # last position, velocity and force, robot frame
_WORK = _X + 9
_NOW = _WORK + 6
_SENT = _NOW + INBOX_LENGTH
_OUT = _SENT + INBOX_LENGTH
_OUT_PLACES = 48
_IN = _OUT + _OUT_PLACES
_IN_PLACES = 512
_POLL = _IN + _IN_PLACES
HAPTICMASTER_LENGTH = _POLL + 1

_FRESH, _NO_DATA, _FAULT = 0, 1, 2
_ACTIVE = int(SafetyState.ACTIVE)

_DEAF = 50
"""Ticks without an answer after which the connection is closed and opened again."""

_SCREEN_EVERY = 16
"""Smallest number of ticks between two transmissions of the inbox."""

_LARGEST_DRIVE = 40.0
"""Force limit of the velocity servo [N]: a person's hand may be on the handle."""

_DECIMALS = 4
"""Decimals of the numbers sent."""


def _words(text: str) -> U1:
    return np.frombuffer(text.encode("ascii"), np.uint8)


_START = _words("set state force;")
_STOP = _words("set state stop;")
_BIAS = _words("set mimics force ")
_ASK = _words(";get modelpos;get modelvel;get measforce")
_ASK_GRASP = _words(";get grasp")
_PERSON = _words(";set person ")


@kernel
def _fill_buffer(memory: Vec, fd: int) -> bool:
    """Receive bytes into the buffer; return False when the other side is gone."""
    buffer = memory[_IN : _IN + _IN_PLACES].view(np.uint8)
    seen = poll_once(fd, memory[_POLL : _POLL + 1].view(np.int32))
    if seen == READABLE:
        start = int(memory[_FILL])
        got = read_bytes(fd, buffer, start, buffer.shape[0] - start)
        if got == 0:
            return False
        memory[_FILL] = float(start + max(0, got))
    return seen != HUNG_UP


@kernel
def _take_text(memory: Vec, begin: int, end: int) -> int:
    """Parse one frame of answers; return FRESH with position, velocity and force in it, FAULT after an error."""
    buffer = memory[_IN : _IN + _IN_PLACES].view(np.uint8)
    values, found = memory[_WORK : _WORK + 3], 0
    while begin < end:
        kind, begin = take_answer(buffer, begin, end, values)
        if kind == ERROR:
            memory[ERRORS] += 1.0
            return _FAULT
        if kind == VECTOR and found < 3:
            memory[_X + 3 * found : _X + 3 * found + 3] = values
            found += 1
        elif kind == NUMBER:
            memory[_GRASP] = values[0]
    return _FRESH if found == 3 else _NO_DATA


@kernel
def _take_frames(memory: Vec, tick: int) -> int:
    """Parse all complete frames; return FRESH, NO_DATA or FAULT, -1 for bytes that are not a frame."""
    buffer = memory[_IN : _IN + _IN_PLACES].view(np.uint8)
    begin, end = 0, int(memory[_FILL])
    status = _NO_DATA
    length = frame_length(buffer, begin, end)
    while length > 0:
        taken = _take_text(memory, begin + HEADER, begin + length)
        status = taken if taken == _FAULT or status == _NO_DATA else status
        memory[_ANSWERED] += 1.0
        note_answer(memory[TRIPS : TRIPS + TRIP_LENGTH], int(memory[_ANSWERED]), tick)
        begin += length
        length = frame_length(buffer, begin, end)
    for i in range(end - begin):
        buffer[i] = buffer[begin + i]
    memory[_FILL] = float(end - begin)
    return -1 if length < 0 else status


@kernel
def _fill_data(memory: Vec, data: Vec) -> None:
    """Convert position, velocity and force from the robot frame to joints and tool frame, into `data`."""
    q, d1 = memory[_Q : _Q + 3], memory[AXIS_OFFSET]
    inverse(memory[_X : _X + 3], d1, q)
    data[DATA_Q : DATA_Q + 3] = q
    apply_inverse_jacobian(q, d1, memory[_X + 3 : _X + 6], data[DATA_DQ : DATA_DQ + 3])
    robot_to_tool(q, memory[_X + 6 : _X + 9], data[DATA_FORCE : DATA_FORCE + 3])
    now = memory[_NOW : _NOW + INBOX_LENGTH]
    data[DATA_GRASP] = max(0.0, memory[_GRASP] if memory[EMULATED] == 1.0 else now[INBOX_GRASP])
    data[DATA_BUTTONS] = max(0.0, now[INBOX_BUTTONS])
    trips, dt = memory[TRIPS : TRIPS + TRIP_LENGTH], memory[TICK]
    data[DATA_AGE] = 0.5 * dt * max(0.0, worst_trip(trips) - 1.0)
    data[DATA_DELAY] = delay_of(trips, memory[OWN_DELAY], dt)


@typed_kernel(READ)
def read_hapticmaster(memory: Vec, inbox: Vec, data: Vec, tick: int) -> int:
    """Read the answers since the last tick; return FAULT without a connection, after an error, or in silence."""
    words = link_words(memory)
    trips = memory[TRIPS : TRIPS + TRIP_LENGTH]
    fd, is_new = take_link(words)
    if fd < 0:
        return _FAULT
    if is_new:
        reset_trips(trips)
        memory[_ANSWERED] = memory[_FILL] = memory[_PENDING] = memory[_ENABLED] = 0.0
        memory[_SENT] = math.nan
    for i in range(INBOX_LENGTH):
        memory[_NOW + i] = inbox[i] if math.isfinite(inbox[i]) else 0.0
    status = _take_frames(memory, tick) if _fill_buffer(memory, fd) else -1
    if status < 0 or silent_for(trips, tick) > _DEAF:
        drop_link(words)
        return _FAULT
    if status == _FRESH:
        _fill_data(memory, data)
    return status


@kernel
def _bias_force(memory: Vec, command: Vec, force: Vec) -> None:
    """Compute the bias force of this tick [N], robot frame."""
    fill(force, 0.0)
    if command[COMMAND_ENABLED] == 0.0:
        return
    if command[COMMAND_STATE] >= _ACTIVE:
        if memory[OBJECTS] == 0.0:
            force[:] = command[COMMAND_FORCE : COMMAND_FORCE + 3]
        return
    wanted = memory[_WORK + 3 : _WORK + 6]
    apply_jacobian(memory[_Q : _Q + 3], memory[AXIS_OFFSET], command[COMMAND_DQ : COMMAND_DQ + 3], wanted)
    for i in range(3):
        force[i] = memory[GAIN] * (wanted[i] - memory[_X + 3 + i])
    clamp_norm(force, _LARGEST_DRIVE)


@kernel
def _screen_is_due(memory: Vec, tick: int) -> bool:
    if memory[EMULATED] == 0.0 or float(tick) - memory[_SHOWN] < _SCREEN_EVERY:
        return False
    for i in range(INBOX_LENGTH):
        if memory[_NOW + i] != memory[_SENT + i]:
            return True
    return False


@kernel
def _show_screen(memory: Vec, text: U1, at: int, tick: int) -> int:
    """Append set person [active,trial,x,y,z,grasp], the inputs of a simulated person; return the end of the text."""
    memory[_SHOWN] = float(tick)
    memory[_SENT : _SENT + INBOX_LENGTH] = memory[_NOW : _NOW + INBOX_LENGTH]
    seen = memory[_WORK : _WORK + 6]
    seen[0], seen[1] = memory[_NOW + INBOX_ACTIVE], memory[_NOW + INBOX_TRIAL]
    seen[2:5] = memory[_NOW + INBOX_TARGET : _NOW + INBOX_TARGET + 3]
    seen[5] = memory[_NOW + INBOX_GRASP]
    return put_vector(seen, _DECIMALS, text, put_text(_PERSON, text, at))


@kernel
def _send_rest(memory: Vec, fd: int) -> bool:
    """Send the rest of the last frame; return True when all of it was sent."""
    out = memory[_OUT : _OUT + _OUT_PLACES].view(np.uint8)
    if memory[_PENDING] > 0.0:
        taken = max(0, write_bytes(fd, out, int(memory[_TAKEN]), int(memory[_PENDING])))
        memory[_TAKEN] += float(taken)
        memory[_PENDING] -= float(taken)
    return memory[_PENDING] == 0.0


@typed_kernel(WRITE)
def write_hapticmaster(memory: Vec, command: Vec, tick: int) -> int:
    """Send bias force and queries; return 0 when they were sent."""
    fd, _ = take_link(link_words(memory))
    trips = memory[TRIPS : TRIPS + TRIP_LENGTH]
    if fd < 0:
        return 1
    if not _send_rest(memory, fd) or trips[0] - memory[_ANSWERED] >= _LARGEST_AHEAD:
        memory[SKIPPED] += 1.0
        return 1
    force, text = memory[_WORK : _WORK + 3], memory[_OUT : _OUT + _OUT_PLACES].view(np.uint8)
    usable = all_finite(command[:COMMAND_LENGTH])
    enabled = 1.0 if usable and command[COMMAND_ENABLED] != 0.0 else 0.0
    if usable:
        _bias_force(memory, command, force)
    else:
        fill(force, 0.0)
    at = HEADER
    if enabled != memory[_ENABLED]:
        at = put_text(_START if enabled == 1.0 else _STOP, text, at)
        memory[_ENABLED] = enabled
    at = put_vector(force, _DECIMALS, text, put_text(_BIAS, text, at))
    at = put_text(_ASK, text, at)
    if memory[EMULATED] == 1.0:
        at = put_text(_ASK_GRASP, text, at)
    if _screen_is_due(memory, tick):
        at = _show_screen(memory, text, at, tick)
    note_sent(trips, tick)
    memory[_TAKEN] = 0.0
    memory[_PENDING] = float(seal_text(text, at))
    _send_rest(memory, fd)
    return 0 if usable else 1
