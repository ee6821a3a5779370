"""Frames and text of the HapticMaster's network interface, in compiled code.

A frame is a header of 8 bytes, of which byte 3 is the length of the text that follows (sources: pyHapticMaster,
O. Tokatli; API 4.2 as used by P. Maurice's HapticMaster programs). Bytes 2 and 3 are read here as one big-endian
number, which agrees with every known frame. Commands are joined with ";", and every answer ends with one:

    set mimics force [0.0000,1.5000,0.0000];get modelpos;get modelvel;get measforce
    "Effect's force set";[0.01,0,0];[0,0,0];[0.2,0,-0.1];
"""

from __future__ import annotations

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import U1, Vec
from mimics_app.rendering.haptic.devices.ascii_numbers import read_number, write_fixed

__all__ = [
    "ERROR",
    "HEADER",
    "NUMBER",
    "VECTOR",
    "WORD",
    "frame_length",
    "put_text",
    "put_vector",
    "seal_text",
    "take_answer",
]


HEADER = 8

_LONGEST_ANSWER = 1900
"""Length of the longest valid text received."""

WORD, NUMBER, VECTOR, ERROR = 0, 1, 2, 3
"""Kinds of answers."""

_OPEN, _CLOSE, _COMMA, _END = ord("["), ord("]"), ord(","), ord(";")
_MINUS, _SPACE = ord("-"), ord(" ")

_BYTE = 8
"""Bits of a byte."""

_LOW_BYTE = 0xFF
"""Mask of the lowest byte."""

_LENGTH_END = 4
"""End of the header's two bytes with the length of the text."""


@kernel
def put_text(words: U1, text: U1, at: int) -> int:
    """Copy words to text[at:]; return their end."""
    for i in range(words.shape[0]):
        text[at + i] = words[i]
    return at + words.shape[0]


@kernel
def put_vector(values: Vec, decimals: int, text: U1, at: int) -> int:
    """Write [a,b,c] to text[at:]; return its end."""
    text[at] = _OPEN
    at += 1
    for i in range(values.shape[0]):
        if i > 0:
            text[at] = _COMMA
            at += 1
        at = write_fixed(values[i], decimals, text, at)
    text[at] = _CLOSE
    return at + 1


@kernel
def seal_text(frame: U1, end: int) -> int:
    """Write the header of the text at frame[HEADER:end]; return the length of the frame."""
    for i in range(HEADER):
        frame[i] = 0
    frame[2] = ((end - HEADER) >> _BYTE) & _LOW_BYTE
    frame[3] = (end - HEADER) & _LOW_BYTE
    return end


@kernel
def frame_length(buffer: U1, begin: int, end: int) -> int:
    """Return the length of the frame at buffer[begin:end]; 0 while incomplete, -1 for an invalid header."""
    if end - begin < HEADER:
        return 0
    length = int(buffer[begin + 2]) << _BYTE | int(buffer[begin + 3])
    strange = buffer[begin] != 0 or buffer[begin + 1] != 0
    for i in range(_LENGTH_END, HEADER):
        strange = strange or buffer[begin + i] != 0
    if strange or length > _LONGEST_ANSWER:
        return -1
    return HEADER + length if end - begin >= HEADER + length else 0


@kernel
def take_answer(text: U1, at: int, end: int, values: Vec) -> tuple[int, int]:
    """Parse the answer at text[at:end]; return (kind, start of the next answer).

    Args:
        text: ASCII text.
        at: Start of the answer.
        end: End of the text.
        values: Out: components of a vector, or a number in the first place, shape [3].
    """
    while at < end and text[at] == _SPACE:
        at += 1
    stop = at
    while stop < end and text[stop] != _END:
        stop += 1
    if at < stop and text[at] == _OPEN:
        place = at + 1
        for i in range(3):
            values[i], after = read_number(text, place, stop)
            if after == place or after >= stop or text[after] != (_COMMA if i < 2 else _CLOSE):
                return ERROR, stop + 1
            place = after + 1
        return VECTOR, stop + 1
    if stop - at >= 3 and text[at] == _MINUS and text[at + 1] == _MINUS and text[at + 2] == _MINUS:
        return ERROR, stop + 1
    values[0], after = read_number(text, at, stop)
    return (NUMBER if after == stop and stop > at else WORD), stop + 1
