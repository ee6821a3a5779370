"""Serial protocol of a vibrator box: one frame per tap, sent ahead and timed by the box.

    A5  channel  strength  duration LE16 [ms]  delay LE32 [us]  number LE16  crc8

The delay counts from the frame's last byte. The box acknowledges each valid frame with 5A, number LE16, crc8. A frame
with a wrong checksum is dropped and never repeated: a late tap is worse than none.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass

__all__ = [
    "FRAME_BYTES",
    "Command",
    "command_bytes",
    "crc8",
    "read_answers",
]

_COMMAND = struct.Struct("<BBBHIH")
_ANSWER = struct.Struct("<BH")
_COMMAND_MARK, _ANSWER_MARK = 0xA5, 0x5A
FRAME_BYTES, _ANSWER_BYTES = _COMMAND.size + 1, _ANSWER.size + 1
"""Lengths of a command frame and of an acknowledgement, with their checksum."""

_MAX_DELAY_US = 1_000_000


@dataclass(frozen=True, slots=True)
class Command:
    """One tap in the units of the protocol.

    Attributes:
        channel: Vibrator, 0 to 255.
        strength: 0 to 255.
        milliseconds: Duration [ms].
        delay_us: Delay from the frame's last byte [us].
        number: Number of the tap, modulo 65536.
    """

    channel: int
    strength: int
    milliseconds: int
    delay_us: int
    number: int


def crc8(data: bytes) -> int:
    """Checksum with the polynomial x^8 + x^2 + x + 1, from 0."""
    value = 0
    for byte in data:
        value ^= byte
        for _ in range(8):
            value = (value << 1) ^ 0x07 if value & 0x80 else value << 1
            value &= 0xFF
    return value


def command_bytes(command: Command) -> bytes:
    """Return the frame of a tap; values out of range are clamped."""
    body = _COMMAND.pack(
        _COMMAND_MARK,
        command.channel & 0xFF,
        min(max(command.strength, 0), 255),
        min(max(command.milliseconds, 0), 65535),
        min(max(command.delay_us, 0), _MAX_DELAY_US),
        command.number & 0xFFFF,
    )
    return body + bytes([crc8(body)])


def read_answers(waiting: bytearray) -> list[int]:
    """Return the numbers of acknowledged frames; parsed bytes are removed from `waiting`."""
    numbers = []
    while len(waiting) >= _ANSWER_BYTES:
        frame = bytes(waiting[:_ANSWER_BYTES])
        if frame[0] == _ANSWER_MARK and crc8(frame[:-1]) == frame[-1]:
            numbers.append(int(_ANSWER.unpack(frame[:-1])[1]))
            del waiting[:_ANSWER_BYTES]
        else:
            del waiting[0]
    return numbers
