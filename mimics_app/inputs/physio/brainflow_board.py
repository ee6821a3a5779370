"""Body signals from boards of the library BrainFlow: board:NAME, e.g. board:SYNTHETIC_BOARD, optionally @PORT."""

from __future__ import annotations

from typing import Any

import numpy as np

from mimics_app.contracts.clock import SECOND_NS
from mimics_app.contracts.errors import DeviceError, UsageError, nearest
from mimics_app.contracts.messages.stage_messages import SignalBlock
from mimics_app.inputs.physio.integrity import Grid, LiveSignals

__all__ = ["BoardSource"]

_CHANNELS = {
    "ecg": "get_ecg_channels",
    "gsr": "get_eda_channels",
    "emg": "get_emg_channels",
}
_TO_MILLIVOLT = {"ecg": 1e-3, "emg": 1e-3}
"""Factor from BrainFlow's microvolts."""


class BoardSource(LiveSignals):
    """The first channel of each kind of signal a board has.

    Args:
        address: Name of a BrainFlow board id, optionally "@" and its serial port.

    Raises:
        UsageError: brainflow is not installed, or has no such board.
        DeviceError: The board cannot be opened, or has no body signal.
    """

    def __init__(self, address: str) -> None:
        super().__init__()
        try:
            from brainflow.board_shim import BoardIds, BoardShim, BrainFlowError, BrainFlowInputParams
        except ImportError as error:
            raise UsageError(
                "boards need brainflow, which is not installed", 'pip install "mimics_app[boards]"'
            ) from error
        name, _, port = address.partition("@")
        self._name = name
        if name not in BoardIds.__members__:
            raise UsageError(f'BrainFlow has no board "{name}"', nearest(name, BoardIds.__members__))
        number = int(BoardIds[name])
        parameters = BrainFlowInputParams()
        parameters.serial_port = port
        try:
            BoardShim.disable_board_logger()
            self._columns = _columns(BoardShim, BrainFlowError, number)
            if not self._columns:
                raise DeviceError(f'the board "{name}" has no channel of a body signal')
            self._rate = float(BoardShim.get_sampling_rate(number))
            self._board: Any = BoardShim(number, parameters)
            self._board.prepare_session()
            self._board.start_stream(45_000)
        except ImportError as error:  # it finds its shared library by pkg_resources, which newer setuptools lack
            raise UsageError(f"brainflow cannot be loaded: {error}", 'pip install "setuptools<81"') from error
        except BrainFlowError as error:
            raise DeviceError(
                f'the board "{name}" cannot be opened: {error}', "switch it on, and check its port: NAME@PORT"
            ) from error
        self._grids = {signal: Grid(signal, self._rate) for signal in self._columns}
        self._start_ns: int | None = None
        self._count = 0

    def read(self, now_ns: int) -> tuple[SignalBlock, ...]:
        """Return the samples received since the last read; their times count from the first read."""
        rows = np.asarray(self._board.get_board_data(), float)
        self._listen(now_ns, received=rows.size > 0, source=f'the board "{self._name}"')
        if rows.size == 0:
            return ()
        if self._start_ns is None:
            self._start_ns = now_ns - round(rows.shape[1] / self._rate * SECOND_NS)
        t_ns = self._start_ns + round(self._count / self._rate * SECOND_NS)
        self._count += rows.shape[1]
        blocks = (
            self._grids[name].take(t_ns, rows[i] * _TO_MILLIVOLT.get(name, 1.0)) for name, i in self._columns.items()
        )
        return tuple(block for block in blocks if block is not None)

    def close(self) -> None:
        """Stop the stream and close the board."""
        self._board.stop_stream()
        self._board.release_session()


def _columns(shim: Any, failure: type[Exception], number: int) -> dict[str, int]:
    """Return the row of each signal in the board's data; BrainFlow raises for signals the board lacks."""
    columns: dict[str, int] = {}
    for name, ask in _CHANNELS.items():
        try:
            rows = getattr(shim, ask)(number)
        except failure:
            continue
        if len(rows):
            columns[name] = int(rows[0])
    return columns
