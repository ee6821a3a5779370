"""An amplifier on a pseudo-terminal, with a simulated body on its electrodes, for tests and for trying things out."""

from __future__ import annotations

import binascii
import os
import struct
import threading
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from mimics_app.inputs.physio.serial_amplifier import SerialAmplifier

__all__ = ["AmplifierEmulator", "binary_header", "binary_samples", "opened"]

_NUMBERS = 1 << 32


def text_header(rate: float, channels: Sequence[str]) -> bytes:
    """The header line."""
    return f"# rate={rate:g} channels={','.join(channels)}\n".encode("ascii")


def text_sample(number: int, values: NDArray[np.float64]) -> bytes:
    """The line of one sample."""
    return (f"{number % _NUMBERS}," + ",".join(f"{value:.6g}" for value in values) + "\n").encode("ascii")


def binary_header(rate: float, channels: Sequence[str]) -> bytes:
    """The header frame."""
    names = b"".join(name.encode("ascii")[:8].ljust(8, b"\0") for name in channels)
    return _sealed(struct.pack("<BBI", 1, len(channels), 0) + struct.pack("<f", rate) + names)


def binary_samples(number: int, values: NDArray[np.float64]) -> bytes:
    """The frame of samples [n, channels], n at most 255."""
    return _sealed(struct.pack("<BBI", 2, len(values), number % _NUMBERS) + values.astype("<f4").tobytes())


def _sealed(body: bytes) -> bytes:
    return b"\xa5\x5a" + body + struct.pack("<H", binascii.crc_hqx(body, 0xFFFF))


class AmplifierEmulator:
    """Sends what it is given.

    Args:
        channels: Names.
        rate: [Hz]
        binary: Frames; else lines.

    Attributes:
        port: What a program opens.
    """

    def __init__(self, channels: Sequence[str], rate: float, *, binary: bool) -> None:
        import tty  # only Linux and macOS have it

        self._main, self._other = os.openpty()
        tty.setraw(self._other)
        os.set_blocking(self._main, False)
        self.port = os.ttyname(self._other)
        self._channels, self._rate, self._binary = tuple(channels), rate, binary
        self._number = 0

    def announce(self) -> None:
        """Send the header."""
        make = binary_header if self._binary else text_header
        self._send(make(self._rate, self._channels))

    def send(self, values: NDArray[np.float64]) -> None:
        """Send samples, shape [n, channels]."""
        if self._binary:
            for begin in range(0, len(values), 50):
                self._send(binary_samples(self._number + begin, values[begin : begin + 50]))
        else:
            for i, row in enumerate(values):
                self._send(text_sample(self._number + i, row))
        self._number += len(values)

    def skip(self, samples: int) -> None:
        """Count samples that are never sent: a gap."""
        self._number += samples

    def babble(self, data: bytes) -> None:
        """Send bytes that are nothing."""
        self._send(data)

    def unplug(self) -> None:
        """The cable is pulled."""
        for descriptor in (self._main, self._other):
            os.close(descriptor)

    def _send(self, data: bytes) -> None:
        os.write(self._main, data)


def opened(emulator: AmplifierEmulator) -> SerialAmplifier:
    """The amplifier at the other end, which says its header until somebody listens."""
    heard = threading.Event()

    def announce() -> None:
        while not heard.wait(0.05):
            emulator.announce()

    talk = threading.Thread(target=announce)
    talk.start()
    try:
        return SerialAmplifier(emulator.port)
    finally:
        heard.set()
        talk.join()
