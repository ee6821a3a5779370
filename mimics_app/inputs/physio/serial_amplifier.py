"""Body signals from an amplifier at a serial port: serial:PORT or serial:PORT@BAUD; its protocols: amplifier_frames."""

from __future__ import annotations

import numpy as np

from mimics_app.contracts.clock import SECOND_NS, Clock, MonotonicClock
from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.messages import SignalBlock
from mimics_app.inputs.physio.amplifier_frames import AmplifierReader, Samples
from mimics_app.inputs.physio.integrity import Grid, LiveSignals
from mimics_app.inputs.physio.recording import name_of_channel

__all__ = ["SerialAmplifier"]

_BAUD = 230_400
_PATIENCE_NS = 3 * SECOND_NS
_NUMBERS = 1 << 32
_SILENT_NS = 2 * SECOND_NS


class SerialAmplifier(LiveSignals):
    """An amplifier that counts its samples: its count says when each was, and what was lost.

    Args:
        address: PORT or PORT@BAUD.
        clock: Of the session.

    Attributes:
        lost: Why nothing comes any more, "" while it does. Signals then end; the session goes on.

    Raises:
        DeviceError: The port cannot be had, or says nothing that an amplifier would.
    """

    def __init__(self, address: str, clock: Clock | None = None) -> None:
        super().__init__()
        import serial

        port, _, baud = address.partition("@")
        self._clock = clock or MonotonicClock()
        try:
            self._port = serial.Serial(port, int(baud or _BAUD), timeout=0, exclusive=True)
        except (serial.SerialException, ValueError, OSError) as error:
            raise DeviceError(
                f'the serial port "{port}" cannot be opened: {error}', "mimics devices lists them"
            ) from error
        self._failures = (serial.SerialException, OSError)
        self._reader = AmplifierReader()
        self._early: list[Samples] = []
        self._columns: dict[str, int] = {}
        self._first: tuple[int, int] | None = None
        self._turns = 0
        self._newest = 0
        self._heard_ns = 0
        self.lost = ""
        self._await_header(port)

    def read(self, now_ns: int) -> tuple[SignalBlock, ...]:
        """What has come."""
        pieces, self._early = self._early + self._receive(), []
        if pieces:
            self._heard_ns, self.lost = now_ns, ""
        elif self._heard_ns and now_ns - self._heard_ns > _SILENT_NS:
            self.lost = "the amplifier is silent"
        blocks = [block for piece in pieces for block in self._place(piece, now_ns)]
        return tuple(blocks)

    @property
    def damaged(self) -> int:
        """Frames and lines that could not be read."""
        return self._reader.damaged

    def close(self) -> None:
        """Let the port go."""
        self._port.close()

    def _receive(self) -> list[Samples]:
        try:
            return self._reader.feed(self._port.read(1 << 16))
        except self._failures as error:
            self.lost = f"the amplifier is gone: {error}"
            return []

    def _place(self, piece: Samples, now_ns: int) -> list[SignalBlock]:
        """Samples at the time their number says."""
        if self._first is None:
            self._first = piece.number, now_ns - round(len(piece.values) / self._reader.rate * SECOND_NS)
            self._newest = piece.number
        if piece.number < self._newest - _NUMBERS // 2:
            self._turns += 1
        self._newest = piece.number
        ahead = piece.number + self._turns * _NUMBERS - self._first[0]
        t_ns = self._first[1] + round(ahead / self._reader.rate * SECOND_NS)
        columns = self._columns.items()
        found = (self._grids[name].take(t_ns, np.ascontiguousarray(piece.values[:, i])) for name, i in columns)
        return [block for block in found if block is not None]

    def _await_header(self, port: str) -> None:
        end_ns = self._clock.now_ns() + _PATIENCE_NS
        while not self._reader.channels:
            self._early += self._receive()
            if self.lost or self._clock.now_ns() > end_ns:
                self._port.close()
                raise DeviceError(
                    f'no amplifier is at "{port}": {self.lost or "no header came"}', "check port, speed and protocol"
                )
            self._clock.sleep_until_ns(self._clock.now_ns() + 5_000_000)
        for i, label in enumerate(self._reader.channels):
            name = name_of_channel(label)
            if name and name not in self._columns:
                self._columns[name] = i
                self._grids[name] = Grid(name, self._reader.rate)
        if not self._columns:
            self._port.close()
            raise DeviceError(
                f'no channel of the amplifier at "{port}" is a body signal', "name them ecg, gsr, emg, resp"
            )
