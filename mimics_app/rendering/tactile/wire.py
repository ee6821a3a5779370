"""What is said to a box of vibrators on a serial line: one frame a tap, sent ahead, so that the box keeps the time.

    A5  channel  strength  duration LE16 [ms]  delay LE32 [us]  number LE16  crc8

The delay counts from the frame's last byte. The box answers every frame it takes with 5A, number LE16, crc8. A frame
whose check sum is wrong is not taken; nothing is repeated: a tap that comes late is worse than none.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass

__all__ = [
    "ANSWER_BYTES",
    "FRAME_BYTES",
    "Command",
    "CommandReader",
    "answer_bytes",
    "command_bytes",
    "crc8",
    "read_answers",
]

_COMMAND = struct.Struct("<BBBHIH")
_ANSWER = struct.Struct("<BH")
_COMMAND_MARK, _ANSWER_MARK = 0xA5, 0x5A
FRAME_BYTES, ANSWER_BYTES = _COMMAND.size + 1, _ANSWER.size + 1
_LONGEST_DELAY_US = 1_000_000


@dataclass(frozen=True, slots=True)
class Command:
    """A tap as it is sent to the box.

    Attributes:
        channel: Vibrator, 0 to 255.
        strength: 0 to 255.
        milliseconds: How long.
        delay_us: From the frame's end [us].
        number: Of the tap, modulo 65536.
    """

    channel: int
    strength: int
    milliseconds: int
    delay_us: int
    number: int


def crc8(data: bytes) -> int:
    """Check sum with the polynomial x^8 + x^2 + x + 1, from 0."""
    value = 0
    for byte in data:
        value ^= byte
        for _ in range(8):
            value = (value << 1) ^ 0x07 if value & 0x80 else value << 1
            value &= 0xFF
    return value


def command_bytes(command: Command) -> bytes:
    """The frame of a tap; figures out of their range are drawn into it."""
    body = _COMMAND.pack(
        _COMMAND_MARK,
        command.channel & 0xFF,
        min(max(command.strength, 0), 255),
        min(max(command.milliseconds, 0), 65535),
        min(max(command.delay_us, 0), _LONGEST_DELAY_US),
        command.number & 0xFFFF,
    )
    return body + bytes([crc8(body)])


def answer_bytes(number: int) -> bytes:
    """What the box says of a frame it has taken."""
    body = _ANSWER.pack(_ANSWER_MARK, number & 0xFFFF)
    return body + bytes([crc8(body)])


class CommandReader:
    """Finds whole frames in what arrives.

    Attributes:
        rejected: Frames with a wrong check sum, and bytes between frames.
    """

    def __init__(self) -> None:
        self._waiting = bytearray()
        self.rejected = 0

    def feed(self, data: bytes) -> list[Command]:
        """Take bytes; returns the commands that are whole now."""
        self._waiting += data
        found = []
        while len(self._waiting) >= FRAME_BYTES:
            frame = bytes(self._waiting[:FRAME_BYTES])
            if frame[0] == _COMMAND_MARK and crc8(frame[:-1]) == frame[-1]:
                found.append(Command(*_COMMAND.unpack(frame[:-1])[1:]))
                del self._waiting[:FRAME_BYTES]
            else:
                self.rejected += 1
                del self._waiting[0]
        return found


def read_answers(waiting: bytearray) -> list[int]:
    """Numbers of the frames that were taken; what is read is removed from `waiting`."""
    numbers = []
    while len(waiting) >= ANSWER_BYTES:
        frame = bytes(waiting[:ANSWER_BYTES])
        if frame[0] == _ANSWER_MARK and crc8(frame[:-1]) == frame[-1]:
            numbers.append(int(_ANSWER.unpack(frame[:-1])[1]))
            del waiting[:ANSWER_BYTES]
        else:
            del waiting[0]
    return numbers
