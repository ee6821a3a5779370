"""Frames of the serial robot: sync, length, kind, sequence, echo, payload, checksum (docs/devices/serial_protocol.md).

    A5 5A | length u8 | kind u8 | sequence u16 | echo u16 | payload | CRC16 u16          all little endian

Both ends use these compiled functions. The parser drops every byte that cannot begin a valid frame, and so
resynchronises at the first complete frame after garbage.
"""

from __future__ import annotations

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import U1, Vec

__all__ = [
    "ASK",
    "BAD_CHECKSUMS",
    "BEGIN",
    "BITS_PER_BYTE",
    "BYTE",
    "COMMAND",
    "COMMAND_PAYLOAD",
    "DUPLICATES",
    "ECHO",
    "END",
    "ESTABLISHED",
    "FRAMES",
    "GARBAGE",
    "HEADER",
    "INFO",
    "INFO_PAYLOAD",
    "LAST_SEQUENCE",
    "LAST_TICK",
    "LEG_COMMAND",
    "LEG_COMMAND_PAYLOAD",
    "LEG_PROTOCOL",
    "LEG_STATE",
    "LEG_STATE_PAYLOAD",
    "LINE_LENGTH",
    "LOST",
    "LOW_BYTE",
    "LOW_WORD",
    "MAX_PAYLOAD",
    "OVERHEAD",
    "PROTOCOL",
    "REORDERED",
    "SCREEN",
    "SCREEN_PAYLOAD",
    "SEQUENCE",
    "STATE",
    "STATE_PAYLOAD",
    "accept_sequence",
    "crc16",
    "make_room",
    "next_frame",
    "reset_line",
    "seal_frame",
    "word_at",
]


PROTOCOL, LEG_PROTOCOL = 1, 2
"""Version of the protocol, sent in INFO: of a robot with one handle, and of the gait orthosis with two legs."""

HEADER = 8
OVERHEAD = HEADER + 2
BITS_PER_BYTE = 10  # on the line: start, eight, stop
MAX_PAYLOAD = 64

COMMAND, STATE, SCREEN, ASK, INFO = 1, 2, 3, 16, 17
"""Kinds of frames: command, robot state, inputs of a simulated person, identification request, identification."""

LEG_COMMAND, LEG_STATE = 4, 5
"""Command and state of the gait orthosis."""

COMMAND_PAYLOAD = 26
STATE_PAYLOAD = 44
LEG_COMMAND_PAYLOAD = 22
LEG_STATE_PAYLOAD = 52
SCREEN_PAYLOAD = 20
INFO_PAYLOAD = 22

BEGIN = 0  # first byte not parsed yet
END = 1  # end of the received bytes
ESTABLISHED = 2  # 1 once a frame was accepted
LAST_SEQUENCE = 3
LAST_TICK = 4  # tick of its acceptance
FRAMES = 5  # accepted
LOST = 6  # missing sequence numbers
DUPLICATES = 7
REORDERED = 8  # older than the newest
GARBAGE = 9  # bytes outside frames
BAD_CHECKSUMS = 10
LINE_LENGTH = 11
"""Length of a parser's memory, float64."""

SEQUENCE, ECHO = 4, 6
"""Offsets of sequence and echo in a frame."""

LOW_BYTE, LOW_WORD = 0xFF, 0xFFFF
"""Masks of the lowest byte and of the lowest two."""

BYTE = 8
"""Bits of a byte."""

_CRC_START = 0xFFFF
_CRC_FOLD, _CRC_HIGH, _CRC_LOW = 4, 12, 5
"""Shifts of the checksum's polynomial x^16 + x^12 + x^5 + 1, a byte at a time."""

_SYNC_0, _SYNC_1 = 0xA5, 0x5A
_HALF = 0x8000
_PATIENCE = 20
"""Ticks without an accepted frame after which an older sequence number is that of a restarted robot."""


@kernel
def crc16(data: U1, start: int, end: int) -> int:
    """Return the CRC-16/CCITT-FALSE (polynomial 0x1021, from 0xFFFF) of data[start:end]; 0x29B1 for "123456789"."""
    crc = _CRC_START
    for i in range(start, end):
        x = (crc >> BYTE) ^ int(data[i])
        x ^= x >> _CRC_FOLD
        crc = ((crc << BYTE) ^ (x << _CRC_HIGH) ^ (x << _CRC_LOW) ^ x) & LOW_WORD
    return crc


@kernel
def word_at(data: U1, place: int) -> int:
    """Return the unsigned 16-bit number at data[place:place + 2]."""
    return int(data[place]) | int(data[place + 1]) << BYTE


@kernel
def seal_frame(frame: U1, kind: int, sequence: int, echo: int, payload: int) -> int:
    """Write header and checksum around the payload at frame[HEADER:]; return the length of the frame."""
    frame[0] = _SYNC_0
    frame[1] = _SYNC_1
    frame[2] = payload
    frame[3] = kind
    frame[SEQUENCE] = sequence & LOW_BYTE
    frame[SEQUENCE + 1] = (sequence >> BYTE) & LOW_BYTE
    frame[ECHO] = echo & LOW_BYTE
    frame[ECHO + 1] = (echo >> BYTE) & LOW_BYTE
    end = HEADER + payload
    crc = crc16(frame, 2, end)
    frame[end] = crc & LOW_BYTE
    frame[end + 1] = crc >> BYTE
    return end + 2


@kernel
def reset_line(line: Vec) -> None:
    """Discard bytes and sequence of a reopened line; the counters are kept."""
    line[BEGIN] = line[END] = line[ESTABLISHED] = 0.0


@kernel
def make_room(line: Vec, buffer: U1) -> int:
    """Move the unparsed bytes to the front; return the place for the next ones."""
    begin, end = int(line[BEGIN]), int(line[END])
    for i in range(end - begin):
        buffer[i] = buffer[begin + i]
    line[BEGIN] = 0.0
    line[END] = float(end - begin)
    return end - begin


@kernel
def next_frame(line: Vec, buffer: U1) -> int:
    """Return the start of the next complete valid frame in the buffer, -1 for none yet."""
    begin, end = int(line[BEGIN]), int(line[END])
    found = -1
    while end - begin >= OVERHEAD:
        if buffer[begin] != _SYNC_0 or buffer[begin + 1] != _SYNC_1 or buffer[begin + 2] > MAX_PAYLOAD:
            begin += 1
            line[GARBAGE] += 1.0
            continue
        total = OVERHEAD + int(buffer[begin + 2])
        if end - begin < total:
            break
        if crc16(buffer, begin + 2, begin + total - 2) != word_at(buffer, begin + total - 2):
            begin += 1
            line[BAD_CHECKSUMS] += 1.0
            line[GARBAGE] += 1.0
            continue
        found = begin
        begin += total
        break
    line[BEGIN] = float(begin)
    return found


@kernel
def accept_sequence(line: Vec, sequence: int, tick: int) -> bool:
    """Whether a frame is newer than all before; missing, duplicate and late ones are counted."""
    ahead = (sequence - int(line[LAST_SEQUENCE])) & LOW_WORD
    restarted = tick - int(line[LAST_TICK]) > _PATIENCE
    if line[ESTABLISHED] == 1.0 and not (restarted and ahead >= _HALF):
        if ahead == 0:
            line[DUPLICATES] += 1.0
            return False
        if ahead >= _HALF:
            line[REORDERED] += 1.0
            return False
        line[LOST] += float(ahead - 1)
    line[ESTABLISHED] = 1.0
    line[LAST_SEQUENCE] = float(sequence)
    line[LAST_TICK] = float(tick)
    line[FRAMES] += 1.0
    return True
