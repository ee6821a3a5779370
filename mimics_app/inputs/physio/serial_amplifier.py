"""Body signals from an amplifier at a serial port: serial:PORT or serial:PORT@BAUD; protocols: `amplifier_frames`."""

from __future__ import annotations

import numpy as np

from mimics_app.contracts.clock import SECOND_NS, Clock, MonotonicClock
from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.messages.stage_messages import SignalBlock
from mimics_app.inputs.physio.amplifier_frames import AmplifierReader, Samples
from mimics_app.inputs.physio.channel_names import NAMES_HINT, columns_of, say_columns
from mimics_app.inputs.physio.integrity import Grid, LiveSignals

__all__ = ["SerialAmplifier"]

_BAUD = 230_400
_PATIENCE_NS = 3 * SECOND_NS
"""Time-out of the first header [ns]."""
_NUMBERS = 1 << 32
"""Modulus of the sample count."""
_JUMP_S = 2.0
"""Larger jumps of the sample count are accepted only when the next samples continue them [s]."""


class SerialAmplifier(LiveSignals):
    """An amplifier that counts its samples: the count gives the time of each, and what was lost.

    An amplifier that is switched off and on counts from 0 again, and a damaged line may hold any count: a large jump is
    accepted when the next samples continue it, and the time then counts from there.

    Args:
        address: PORT or PORT@BAUD.
        clock: The session's clock.

    Raises:
        DeviceError: The port cannot be opened, or no header of an amplifier arrives.
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
        self._doubted: Samples | None = None
        self._start_ns: int | None = None
        self._place = self._next = 0
        self._await_header(port)

    def read(self, now_ns: int) -> tuple[SignalBlock, ...]:
        """Return the samples received since the last read."""
        pieces, self._early = self._early + self._receive(), []
        if (self._reader.rate, self._reader.channels) != self._header:
            self.lost = "the amplifier now states another rate or other channels; start the session again"
            return ()
        self._listen(now_ns, received=bool(pieces), source="the amplifier")
        # One piece after the other: whether the next one is accepted depends on the count of the last.
        return tuple(block for piece in pieces for good in self._accept(piece) for block in self._blocks(good, now_ns))

    @property
    def damaged(self) -> int:
        """Number of frames and lines that could not be read."""
        return self._reader.damaged

    def close(self) -> None:
        """Close the port."""
        self._port.close()

    def _receive(self) -> list[Samples]:
        try:
            return self._reader.feed(self._port.read(1 << 16))
        except self._failures as error:
            self.lost = f"the amplifier is gone: {error}"
            return []

    def _jump(self, piece: Samples) -> int:
        """Return the number of samples between the expected count and that of a piece; negative for a repetition."""
        return (piece.number - self._next + _NUMBERS // 2) % _NUMBERS - _NUMBERS // 2

    def _accept(self, piece: Samples) -> list[Samples]:
        """Return the pieces whose count is accepted with this one."""
        doubted, self._doubted = self._doubted, None
        if self._start_ns is None or abs(self._jump(piece)) <= _JUMP_S * self._reader.rate:
            return [piece]
        if doubted is not None and piece.number == (doubted.number + len(doubted.values)) % _NUMBERS:
            return [doubted, piece]
        self._doubted = piece
        return []

    def _blocks(self, piece: Samples, now_ns: int) -> list[SignalBlock]:
        """Return the samples as blocks at the time given by their count."""
        rate, jump = self._reader.rate, self._jump(piece)
        if self._start_ns is None or abs(jump) > _JUMP_S * rate:
            self._start_ns, self._place = now_ns - round(len(piece.values) / rate * SECOND_NS), 0
        else:
            self._place += jump
        t_ns = self._start_ns + round(self._place / rate * SECOND_NS)
        self._place += len(piece.values)
        self._next = (piece.number + len(piece.values)) % _NUMBERS
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
        self._header = self._reader.rate, self._reader.channels
        self._columns = columns_of(self._reader.channels)
        self._grids = {name: Grid(name, self._reader.rate, counted=True) for name in self._columns}
        if not self._columns:
            self._port.close()
            raise DeviceError(f'no channel of the amplifier at "{port}" is a body signal', NAMES_HINT)
        self.notes = say_columns(self._reader.channels, self._columns)
