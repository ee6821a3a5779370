"""VRPN's messages over TCP: big-endian header of 24 bytes, bodies padded to eight; types and senders are announced.

The protocol has no authentication, so our own server listens to this machine alone unless set otherwise.
"""

from __future__ import annotations

import socket
import struct
from dataclasses import dataclass

__all__ = [
    "COOKIE",
    "DEFAULT_PORT",
    "PING_TYPE",
    "PONG_TYPE",
    "POSE_TYPE",
    "SENDER_DESCRIPTION",
    "TYPE_DESCRIPTION",
    "Message",
    "MessageReader",
    "announcement",
    "open_socket",
    "pack",
    "pose_body",
]

COOKIE = b"vrpn: ver. 07.35  0".ljust(24, b"\0")
DEFAULT_PORT = 3883
POSE_TYPE = "vrpn_Tracker Pos_Quat"
PING_TYPE, PONG_TYPE = "vrpn_Base ping_message", "vrpn_Base pong_message"
SENDER_DESCRIPTION, TYPE_DESCRIPTION = -1, -2

_HEADER = struct.Struct(">iIIii4x")
_POSE = struct.Struct(">ii7d")
_LARGEST = 1 << 16
"""Largest message that is read [bytes]; a pose has 88."""


@dataclass(frozen=True, slots=True)
class Message:
    """One message: time on the sender's clock [ns], number of the sender, number of the type, body."""

    t_ns: int
    sender: int
    type: int
    body: bytes

    @property
    def text(self) -> str:
        """The name in a description."""
        return self.body[4:].rstrip(b"\0").decode("latin-1")

    @property
    def pose(self) -> tuple[int, tuple[float, ...]] | None:
        """Sensor, and position x y z with quaternion x y z w; None where the body is not a pose."""
        if len(self.body) != _POSE.size:
            return None
        sensor, _, *numbers = _POSE.unpack(self.body)
        return sensor, tuple(numbers)


def pack(sender: int, kind: int, body: bytes, t_ns: int) -> bytes:
    """Return a message with its header."""
    seconds, rest = divmod(t_ns, 1_000_000_000)
    header = _HEADER.pack(_HEADER.size + len(body), seconds & 0xFFFFFFFF, rest // 1000, sender, kind)
    return header + body + bytes(-len(body) % 8)


def announcement(what: int, name: str, number: int = 0) -> bytes:
    """Return the message that announces the name of a sender or a type, and its number in later messages."""
    text = name.encode() + b"\0"
    return pack(number, what, struct.pack(">i", len(text)) + text, 0)


def pose_body(sensor: int, position: tuple[float, float, float], rotation: tuple[float, float, float, float]) -> bytes:
    """Return the body of a pose message."""
    return _POSE.pack(sensor, 0, *position, *rotation)


class MessageReader:
    """Parser of the byte stream."""

    def __init__(self) -> None:
        self._waiting = bytearray()
        self._greeted = False

    def feed(self, data: bytes) -> list[Message]:
        """Take bytes and return the complete messages.

        Raises:
            ValueError: The stream is not VRPN, or is damaged beyond resynchronisation.
        """
        self._waiting += data
        if not self._greeted:
            if len(self._waiting) < len(COOKIE):
                return []
            if not self._waiting.startswith(b"vrpn: ver. 07."):
                raise ValueError("the other end does not speak VRPN 7")
            del self._waiting[: len(COOKIE)]
            self._greeted = True
        messages = []
        while (message := self._next()) is not None:
            messages.append(message)
        return messages

    def _next(self) -> Message | None:
        if len(self._waiting) < _HEADER.size:
            return None
        length, seconds, micros, sender, kind = _HEADER.unpack_from(self._waiting)
        if not _HEADER.size <= length <= _LARGEST:
            raise ValueError(f"a message of {length} bytes is out of range")
        whole = _HEADER.size + (length - _HEADER.size + 7) // 8 * 8
        if len(self._waiting) < whole:
            return None
        body = bytes(self._waiting[_HEADER.size : length])
        del self._waiting[:whole]
        return Message(seconds * 1_000_000_000 + micros * 1000, sender, kind, body)


def open_socket(connection: socket.socket) -> socket.socket:
    """Disable Nagle's algorithm, with which small messages would wait 40 ms for each other, and return the socket."""
    connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    return connection
