"""A box of vibrators that is not there: a pseudo terminal that takes commands and remembers when it would vibrate."""

from __future__ import annotations

import os
import select
import struct
import threading

from mimics_app.contracts.clock import Clock, MonotonicClock
from mimics_app.rendering.tactile.wire import FRAME_BYTES, Command, crc8

__all__ = ["CommandReader", "EmulatedVibrators"]

_LOOK_S = 0.02


class CommandReader:
    """Finds complete command frames in a byte stream.

    Attributes:
        rejected: Bytes that begin no valid frame.
    """

    def __init__(self) -> None:
        self._waiting = bytearray()
        self.rejected = 0

    def feed(self, data: bytes) -> list[Command]:
        """Append received bytes; return the commands that they complete."""
        self._waiting += data
        found = []
        while len(self._waiting) >= FRAME_BYTES:
            frame = bytes(self._waiting[:FRAME_BYTES])
            if frame[0] == 0xA5 and crc8(frame[:-1]) == frame[-1]:
                found.append(Command(*struct.unpack("<BBHIH", frame[1:-1])))
                del self._waiting[:FRAME_BYTES]
            else:
                self.rejected += 1
                del self._waiting[0]
        return found


def answer_bytes(number: int) -> bytes:
    """Return the acknowledgement of a frame."""
    body = struct.pack("<BH", 0x5A, number)
    return body + bytes([crc8(body)])


class EmulatedVibrators:
    """Its `port` is opened like a serial line.

    Attributes:
        port: Name of the terminal's other end.
        taps: Commands taken, each with when it begins to vibrate [ns].
    """

    def __init__(self, clock: Clock | None = None) -> None:
        self._clock = clock or MonotonicClock()
        import termios
        import tty

        self._own, self._other = os.openpty()
        tty.setraw(self._other, termios.TCSANOW)
        self.port = os.ttyname(self._other)
        self.taps: list[tuple[int, Command]] = []
        self._reader = CommandReader()
        self._closing = threading.Event()
        self._thread = threading.Thread(target=self._serve, name="emulated vibrators", daemon=True)
        self._thread.start()

    @property
    def rejected(self) -> int:
        """What was no command."""
        return self._reader.rejected

    def close(self) -> None:
        """End, and take the terminal away."""
        self._closing.set()
        self._thread.join()
        os.close(self._own)
        os.close(self._other)

    def _serve(self) -> None:
        while not self._closing.is_set():
            if not select.select([self._own], [], [], _LOOK_S)[0]:
                continue
            data, now_ns = os.read(self._own, 4096), self._clock.now_ns()
            for command in self._reader.feed(data):
                self.taps.append((now_ns + 1000 * command.delay_us, command))
                os.write(self._own, answer_bytes(command.number))
