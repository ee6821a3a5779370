"""One-way byte channel from the application to the recorder; writing never blocks, and data survive the writer.

The channel is a pipe, which keeps its content after the writer is gone. What the full pipe does not take waits in a
bounded queue until the next call. Both processes keep the reading end, so a new recorder continues where a dead one
stopped. A message is `magic, length, CRC32, kind, payload`: a reader that starts within one resynchronises at the next.
"""

from __future__ import annotations

import os
import struct
import zlib
from collections import deque
from collections.abc import Iterator
from multiprocessing.connection import Connection, Pipe
from typing import Final

__all__ = ["CLOSE", "LINE", "PARAMETERS", "SIGNALS", "TRIAL", "Inbox", "Outbox"]

LINE: Final = b"J"
"""Kind of message: one line of events.jsonl."""
PARAMETERS: Final = b"P"
"""Kind of message: one SCENE record and its rows."""
SIGNALS: Final = b"S"
"""Kind of message: blocks of body signals, see `recording.signal_rows`."""
TRIAL: Final = b"T"
"""Kind of message: one row of trials.csv, with its number."""
CLOSE: Final = b"C"
"""Kind of message: the orderly end, with the summary of the session."""

_NEVER_DROPPED = (TRIAL, CLOSE)
"""Kinds of messages that a full queue takes, too: they are few and small, and without them a session has no end."""
_MAGIC = b"\xa7mj1"
_HEADER = struct.Struct("<4sIIc")
_PIPE_SIZE = 1 << 20  # the most an unprivileged process may request on Linux
_MAX_MESSAGE = 1 << 24
_READ = 1 << 16


class Outbox:
    """Writing end.

    Attributes:
        dropped: Number of messages dropped because the queue was full.
        reader: The reading end, to be passed to the recorder process.
        waiting_bytes: Length of the queue [bytes].
    """

    def __init__(self, limit_bytes: int = 64 << 20) -> None:
        self.reader, self._writer = Pipe(duplex=False)
        self._descriptor = self._writer.fileno()
        os.set_blocking(self._descriptor, False)
        _enlarge(self._descriptor)
        self._queue: deque[memoryview] = deque()
        self._limit = limit_bytes
        self.waiting_bytes = 0
        self.dropped = 0

    def send(self, kind: bytes, payload: bytes) -> bool:
        """Queue one message and write the queue to the pipe; False, and the message dropped, when it is full.

        Trials and the end of the session are never dropped.
        """
        if self.waiting_bytes > self._limit:
            self.flush()
        if self.waiting_bytes > self._limit and kind not in _NEVER_DROPPED:
            self.dropped += 1
            return False
        message = _HEADER.pack(_MAGIC, len(payload), zlib.crc32(payload, zlib.crc32(kind)), kind) + payload
        self._queue.append(memoryview(message))
        self.waiting_bytes += len(message)
        self.flush()
        return True

    def flush(self) -> bool:
        """Write the queue to the pipe; True when it is empty."""
        while self._queue:
            part = self._queue[0]
            try:
                written = os.write(self._descriptor, part)
            except OSError:  # full, which is BlockingIOError, or closed at the end of the session
                return False
            self.waiting_bytes -= written
            if written < len(part):
                self._queue[0] = part[written:]
            else:
                self._queue.popleft()
        return True

    def close(self) -> None:
        """Close both ends; the recorder then reads the end of the channel."""
        self._writer.close()
        self.reader.close()


class Inbox:
    """Reading end, made of the `reader` of an `Outbox`.

    Attributes:
        ended: True once all writers are closed and everything was read.
        skipped_bytes: Number of bytes outside complete messages.
    """

    def __init__(self, reader: Connection) -> None:
        self._reader = reader
        self._descriptor = reader.fileno()
        os.set_blocking(self._descriptor, False)
        self._buffer = bytearray()
        self.ended = False
        self.skipped_bytes = 0

    def messages(self) -> Iterator[tuple[bytes, bytes]]:
        """Yield kind and payload of the messages available, in order; at most the capacity of one pipe."""
        for _ in range(_PIPE_SIZE // _READ):
            if not self._read_more():
                return
            yield from self._whole_messages()

    def _read_more(self) -> bool:
        if self.ended:
            return False
        try:
            chunk = os.read(self._descriptor, _READ)
        except BlockingIOError:
            return False
        self.ended = not chunk
        self._buffer += chunk
        return bool(chunk)

    def _whole_messages(self) -> Iterator[tuple[bytes, bytes]]:
        while True:
            self._skip_to_magic()
            if len(self._buffer) < _HEADER.size:
                return
            _, length, crc, kind = _HEADER.unpack_from(self._buffer)
            end = _HEADER.size + length
            if length <= _MAX_MESSAGE and len(self._buffer) < end:
                return
            payload = bytes(self._buffer[_HEADER.size : end])
            if length > _MAX_MESSAGE or zlib.crc32(payload, zlib.crc32(kind)) != crc:
                self._skip(1)
                continue
            del self._buffer[:end]
            yield kind, payload

    def _skip_to_magic(self) -> None:
        place = self._buffer.find(_MAGIC)
        if place < 0:  # its first bytes may be at the end already
            place = max(0, len(self._buffer) - len(_MAGIC) + 1)
        self._skip(place)

    def _skip(self, count: int) -> None:
        self.skipped_bytes += count
        del self._buffer[:count]


def _enlarge(descriptor: int) -> None:
    """Request a large pipe where the system has one; a small one only makes the queue longer."""
    try:
        import fcntl

        fcntl.fcntl(descriptor, fcntl.F_SETPIPE_SZ, _PIPE_SIZE)  # Linux only
    except (ImportError, AttributeError, OSError):
        return
