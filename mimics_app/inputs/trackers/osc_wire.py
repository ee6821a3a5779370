"""Datagrams of Open Sound Control: messages of numbers, alone or in bundles, which may hold bundles.

A bundle's time tag is when its sender measured. It never delays a message: a clock that is ahead would stop the
tracker.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator
from dataclasses import dataclass

__all__ = ["OscMessage", "read_datagram"]

_BUNDLE = b"#bundle\0"
_HEAD = len(_BUNDLE) + 8
"""Length of a bundle before its elements [bytes]: the word and the time tag."""
_EPOCH_S = 2_208_988_800
"""Seconds from 1900, where time tags begin, to 1970."""
_AT_ONCE = 1
"""Time tag that names no time."""
_NUMBERS = {"f": ">f", "d": ">d", "i": ">i", "h": ">q"}
"""Formats of the arguments that are numbers, by type tag."""
_MOST_NUMBERS = 64


@dataclass(frozen=True, slots=True)
class OscMessage:
    """One message.

    Attributes:
        address: Its address pattern, "/pose/head".
        numbers: Its arguments; None if one of them is not a number, or they are more than 64.
        sent_ns: Time tag of its bundle [ns since 1970]; None if it has none.
    """

    address: str
    numbers: tuple[float, ...] | None
    sent_ns: int | None


def read_datagram(data: bytes) -> Iterator[OscMessage]:
    """Yield the messages of a datagram, in its order.

    Raises:
        ValueError: It is damaged, after the messages before the fault.
    """
    waiting: list[tuple[int, int, int | None]] = [(0, len(data), None)]
    while waiting:
        first, last, sent_ns = waiting.pop()
        if data[first : first + len(_BUNDLE)] == _BUNDLE:
            waiting += reversed(list(_elements(data, first, last)))
        elif first < last:
            yield _message(data[first:last], sent_ns)
        else:
            raise ValueError("an OSC packet without content")


def _elements(data: bytes, first: int, last: int) -> Iterator[tuple[int, int, int | None]]:
    """Yield begin, end and time tag of each element of a bundle."""
    if last - first < _HEAD:
        raise ValueError("an OSC bundle without time tag")
    (tag,) = struct.unpack_from(">Q", data, first + len(_BUNDLE))
    sent_ns = None if tag <= _AT_ONCE else ((tag - (_EPOCH_S << 32)) * 1_000_000_000) >> 32
    at = first + _HEAD
    while at < last:
        if last - at < 4:
            raise ValueError("an OSC bundle that ends within a length")
        (length,) = struct.unpack_from(">i", data, at)
        at += 4
        if not 0 < length <= last - at:
            raise ValueError(f"an element of {length} bytes in an OSC bundle of which {last - at} are left")
        yield at, at + length, sent_ns
        at += length


def _message(data: bytes, sent_ns: int | None) -> OscMessage:
    address, at = _text(data, 0)
    if not address.startswith("/"):
        raise ValueError("an OSC message without address")
    tags, at = _text(data, at)
    if not tags.startswith(","):
        raise ValueError("an OSC message without type tags")
    form = [_NUMBERS.get(tag) for tag in tags[1:]]
    if None in form or len(form) > _MOST_NUMBERS:
        return OscMessage(address, None, sent_ns)
    whole = ">" + "".join(each[1] for each in form if each)
    if struct.calcsize(whole) != len(data) - at:
        raise ValueError("an OSC message shorter or longer than its type tags say")
    return OscMessage(address, tuple(map(float, struct.unpack_from(whole, data, at))), sent_ns)


def _text(data: bytes, at: int) -> tuple[str, int]:
    """Return the text at a place, and the place after its padding to four bytes."""
    end = data.find(b"\0", at)
    if end < 0:
        raise ValueError("an OSC text without end")
    return data[at:end].decode("utf-8", "replace"), end + 4 - end % 4
