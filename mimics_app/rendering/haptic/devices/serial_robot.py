"""Loop side of a robot that exchanges frames on a serial line or by UDP: compiled read and write on its descriptor.

Commands are sent at most as often as the baud rate allows: more would wait, and age, in the system's buffer. Frames in
either direction name the newest one of the other direction, which gives the delay. Protocol:
docs/devices/serial_protocol.md.
"""

from __future__ import annotations

import math

import numpy as np

from mimics_app.compiled.file_descriptors import HUNG_UP, QUIET, READABLE, poll_once, read_bytes, write_bytes
from mimics_app.compiled.kernel import kernel, typed_kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.loop.loop_ports import (
    COMMAND_LENGTH,
    DATA_AGE,
    DATA_BUTTONS,
    DATA_DELAY,
    INBOX_LENGTH,
    READ,
    WRITE,
)
from mimics_app.rendering.haptic.devices.link import LINK_LENGTH, drop_link, link_words, take_link
from mimics_app.rendering.haptic.devices.round_trip import (
    TRIP_LENGTH,
    delay_of,
    ended_trip,
    note_answer,
    note_sent,
    reset_trips,
    silent_for,
)
from mimics_app.rendering.haptic.devices.serial_frames import (
    COMMAND,
    COMMAND_PAYLOAD,
    ECHO,
    END,
    LAST_SEQUENCE,
    LEG_COMMAND,
    LEG_COMMAND_PAYLOAD,
    LEG_STATE,
    LEG_STATE_PAYLOAD,
    LINE_LENGTH,
    MAX_PAYLOAD,
    OVERHEAD,
    SCREEN,
    SCREEN_PAYLOAD,
    SEQUENCE,
    STATE,
    STATE_PAYLOAD,
    accept_sequence,
    make_room,
    next_frame,
    reset_line,
    seal_frame,
    word_at,
)
from mimics_app.rendering.haptic.devices.serial_payloads import (
    FRAME_PLACES,
    PAYLOAD_PLACES,
    ROBOT_FAULT,
    ROBOT_READY,
    fetch_payload,
    pack_command,
    pack_leg_command,
    pack_screen,
    unpack_leg_state,
    unpack_state,
)

__all__ = [
    "BYTES_PER_TICK",
    "LEGS",
    "LINE",
    "OWN_DELAY",
    "SCREEN_WANTED",
    "SERIAL_LENGTH",
    "SKIPPED",
    "TICK",
    "TRIPS",
    "read_serial",
    "write_serial",
]


LINE = LINK_LENGTH  # parser of STATE frames
TRIPS = LINE + LINE_LENGTH
TICK = TRIPS + TRIP_LENGTH  # [s]
BYTES_PER_TICK = TICK + 1  # capacity of the line
CREDIT = TICK + 2  # bytes that may be sent now
OWN_DELAY = TICK + 3  # delay of the robot, from INFO [s]
SCREEN_WANTED = TICK + 4  # 1: a simulated person needs SCREEN frames
SKIPPED = TICK + 5  # commands not sent for want of capacity of the line
_BLOCKED = TICK + 6  # commands not sent because the system's buffer was full
PENDING = TICK + 7  # bytes of the last frame still to write
TAKEN = TICK + 8  # bytes of it that were written
SHOWN = TICK + 9  # tick of the last SCREEN frame
SCREENS = TICK + 10  # SCREEN frames sent
LEGS = TICK + 11  # 1: commands and states are those of the gait orthosis
_NOW = TICK + 12  # inbox as last read
_SENT = _NOW + INBOX_LENGTH  # inbox as last sent
_OUT = _SENT + INBOX_LENGTH  # outgoing frame
_PAYLOAD = _OUT + FRAME_PLACES  # payload of the received frame
_IN = _PAYLOAD + PAYLOAD_PLACES
_IN_PLACES = 128
_POLL = _IN + _IN_PLACES
SERIAL_LENGTH = _POLL + 1

_FRESH, _NO_DATA, _FAULT = 0, 1, 2

_LONGEST = MAX_PAYLOAD + OVERHEAD
"""Bytes of the longest frame."""

_DEAF, _LEG_DEAF = 50, 20
"""Ticks without an acknowledgement after which the robot counts as faulty: its watchdog has disabled it by then."""

_SCREEN_EVERY = 16
"""Smallest number of ticks between two SCREEN frames: a frame of the picture."""


@kernel
def _fill_buffer(memory: Vec, fd: int) -> bool:
    """Read bytes, or all datagrams that have come, into the buffer; return False when the other end is gone."""
    line = memory[LINE : LINE + LINE_LENGTH]
    buffer = memory[_IN : _IN + _IN_PLACES].view(np.uint8)
    start = make_room(line, buffer)
    seen = poll_once(fd, memory[_POLL : _POLL + 1].view(np.int32))
    while seen == READABLE and buffer.shape[0] - start >= _LONGEST:
        got = read_bytes(fd, buffer, start, buffer.shape[0] - start)
        if got == 0:
            return False
        start += max(0, got)
        line[END] = float(start)
        seen = poll_once(fd, memory[_POLL : _POLL + 1].view(np.int32)) if got > 0 else QUIET
    return seen != HUNG_UP


@kernel
def _take_frames(memory: Vec, data: Vec, tick: int) -> int:
    """Read the newest STATE frame into `data`; return FRESH, NO_DATA, or FAULT where any frame reports one.

    Several frames wait after a late tick: a button that was pressed in any of them counts as pressed.
    """
    line = memory[LINE : LINE + LINE_LENGTH]
    trips = memory[TRIPS : TRIPS + TRIP_LENGTH]
    buffer = memory[_IN : _IN + _IN_PLACES].view(np.uint8)
    payload = memory[_PAYLOAD : _PAYLOAD + PAYLOAD_PLACES]
    status, pressed, legs = _NO_DATA, 0, memory[LEGS] != 0.0
    kind, size = (LEG_STATE, LEG_STATE_PAYLOAD) if legs else (STATE, STATE_PAYLOAD)
    frame = next_frame(line, buffer)
    while frame >= 0:
        wanted = buffer[frame + 3] == kind and buffer[frame + 2] == size
        if wanted and accept_sequence(line, word_at(buffer, frame + SEQUENCE), tick):
            fetch_payload(buffer, frame, payload)
            robot = unpack_leg_state(payload, data) if legs else unpack_state(payload, data)
            pressed |= int(data[DATA_BUTTONS])
            data[DATA_BUTTONS] = float(pressed)
            note_answer(trips, ended_trip(trips, word_at(buffer, frame + ECHO)), tick)
            if status != _FAULT:
                status = _FRESH if robot == ROBOT_READY else _FAULT if robot >= ROBOT_FAULT else _NO_DATA
        frame = next_frame(line, buffer)
    if status == _FRESH:
        dt = memory[TICK]
        data[DATA_AGE] += dt * (size + OVERHEAD) / memory[BYTES_PER_TICK]
        data[DATA_DELAY] = delay_of(trips, memory[OWN_DELAY], dt)
    return status


@typed_kernel(READ)
def read_serial(memory: Vec, inbox: Vec, data: Vec, tick: int) -> int:
    """Read the states since the last tick; return FAULT without a line, or while the robot receives nothing."""
    words = link_words(memory)
    trips = memory[TRIPS : TRIPS + TRIP_LENGTH]
    fd, is_new = take_link(words)
    if fd < 0:
        return _FAULT
    if is_new:
        reset_line(memory[LINE : LINE + LINE_LENGTH])
        reset_trips(trips)
        memory[CREDIT] = memory[PENDING] = 0.0
        memory[_SENT] = math.nan
    memory[_NOW : _NOW + INBOX_LENGTH] = inbox
    if not _fill_buffer(memory, fd):
        drop_link(words)
        return _FAULT
    status = _take_frames(memory, data, tick)
    patience = _LEG_DEAF if memory[LEGS] != 0.0 else _DEAF
    return _FAULT if silent_for(trips, tick) > patience else status


@kernel
def _send(memory: Vec, fd: int, length: int) -> None:
    """Write the frame in _OUT; bytes that the system does not accept now are written at the next tick."""
    taken = max(0, write_bytes(fd, memory[_OUT : _OUT + FRAME_PLACES].view(np.uint8), 0, length))
    memory[TAKEN] = float(taken)
    memory[PENDING] = float(length - taken)
    memory[CREDIT] -= float(length)


@kernel
def _send_rest(memory: Vec, fd: int) -> bool:
    """Write the rest of the last frame; return True when all of it was written."""
    if memory[PENDING] > 0.0:
        out = memory[_OUT : _OUT + FRAME_PLACES].view(np.uint8)
        taken = max(0, write_bytes(fd, out, int(memory[TAKEN]), int(memory[PENDING])))
        memory[TAKEN] += float(taken)
        memory[PENDING] -= float(taken)
    return memory[PENDING] == 0.0


@kernel
def _screen_changed(memory: Vec) -> bool:
    for i in range(INBOX_LENGTH):
        if memory[_NOW + i] != memory[_SENT + i]:
            return True
    return False


@kernel
def _show_screen(memory: Vec, fd: int, tick: int) -> None:
    """Send a changed inbox to a simulated person, at most once per frame of the picture."""
    length = SCREEN_PAYLOAD + OVERHEAD
    due = memory[SCREEN_WANTED] == 1.0 and float(tick) - memory[SHOWN] >= _SCREEN_EVERY
    if not due or memory[PENDING] > 0.0 or memory[CREDIT] < length or not _screen_changed(memory):
        return
    memory[_SENT : _SENT + INBOX_LENGTH] = memory[_NOW : _NOW + INBOX_LENGTH]
    pack_screen(memory[_NOW : _NOW + INBOX_LENGTH], memory[_OUT + 1 : _OUT + 1 + PAYLOAD_PLACES])
    memory[SHOWN] = float(tick)
    memory[SCREENS] += 1.0
    out = memory[_OUT : _OUT + FRAME_PLACES].view(np.uint8)
    echo = int(memory[LINE + LAST_SEQUENCE])
    _send(memory, fd, seal_frame(out, SCREEN, int(memory[SCREENS]), echo, SCREEN_PAYLOAD))


@typed_kernel(WRITE)
def write_serial(memory: Vec, command: Vec, tick: int) -> int:
    """Send the command if the line has capacity for it; return 0 when it was sent."""
    fd, _ = take_link(link_words(memory))
    if fd < 0:
        return 1
    legs = memory[LEGS] != 0.0
    kind, size = (LEG_COMMAND, LEG_COMMAND_PAYLOAD) if legs else (COMMAND, COMMAND_PAYLOAD)
    length = size + OVERHEAD
    rate = memory[BYTES_PER_TICK]
    memory[CREDIT] = min(memory[CREDIT] + rate, rate + length)
    if not _send_rest(memory, fd):
        memory[_BLOCKED] += 1.0
        return 1
    if memory[CREDIT] < length:
        memory[SKIPPED] += 1.0
        return 1
    usable = True
    for i in range(COMMAND_LENGTH):
        usable = usable and math.isfinite(command[i])
    if legs:
        pack_leg_command(command, usable, memory[_OUT + 1 : _OUT + 1 + PAYLOAD_PLACES])
    else:
        pack_command(command, usable, memory[_OUT + 1 : _OUT + 1 + PAYLOAD_PLACES])
    number = note_sent(memory[TRIPS : TRIPS + TRIP_LENGTH], tick)
    out = memory[_OUT : _OUT + FRAME_PLACES].view(np.uint8)
    _send(memory, fd, seal_frame(out, kind, number, int(memory[LINE + LAST_SEQUENCE]), size))
    _show_screen(memory, fd, tick)
    return 0 if usable else 1
