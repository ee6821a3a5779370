"""An amplifier on a pseudo-terminal, with a simulated body on its electrodes, for tests and for trying things out."""

from __future__ import annotations

import os
import threading
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from mimics_app.inputs.physio.amplifier_frames import binary_header, binary_samples, text_header, text_sample
from mimics_app.inputs.physio.serial_amplifier import SerialAmplifier

__all__ = ["AmplifierEmulator", "opened"]


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
