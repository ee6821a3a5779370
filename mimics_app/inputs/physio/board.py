"""Body signals from boards that BrainFlow knows: board:NAME, e.g. board:SYNTHETIC_BOARD, optionally @PORT."""

from __future__ import annotations

from typing import Any

import numpy as np

from mimics_app.contracts.clock import SECOND_NS
from mimics_app.contracts.errors import DeviceError, UsageError, nearest
from mimics_app.contracts.messages import SignalBlock
from mimics_app.inputs.physio.integrity import Grid, LiveSignals

__all__ = ["BoardSource"]

_CHANNELS = {
    "ecg": "get_ecg_channels",
    "gsr": "get_eda_channels",
    "emg": "get_emg_channels",
}
_TO_MILLIVOLT = {"ecg": 1e-3, "emg": 1e-3}
"""BrainFlow gives microvolts."""


class BoardSource(LiveSignals):
    """The first channel of each kind of signal a board has.

    Args:
        address: Name of a board id of BrainFlow, after an "@" the port it is at.

    Raises:
        UsageError: brainflow is not installed, or knows no such board.
        DeviceError: The board cannot be had, or has no body signal.
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
        if name not in BoardIds.__members__:
            raise UsageError(f'BrainFlow knows no board "{name}"', nearest(name, BoardIds.__members__))
        number = int(BoardIds[name])
        parameters = BrainFlowInputParams()
        parameters.serial_port = port
        try:
            BoardShim.disable_board_logger()
            self._columns = _columns(BoardShim, BrainFlowError, number)
            self._rate = float(BoardShim.get_sampling_rate(number))
            self._board: Any = BoardShim(number, parameters)
            self._board.prepare_session()
            self._board.start_stream(45_000)
        except ImportError as error:  # it looks for its shared library by what newer setuptools have no more
            raise UsageError(f"brainflow cannot be loaded: {error}", 'pip install "setuptools<81"') from error
        except BrainFlowError as error:
            raise DeviceError(f'the board "{name}" cannot be had: {error}', "is it on, and on which port?") from error
        if not self._columns:
            raise DeviceError(f'the board "{name}" has no channel of a body signal')
        self._grids = {signal: Grid(signal, self._rate) for signal in self._columns}
        self._start_ns: int | None = None
        self._count = 0

    def read(self, now_ns: int) -> tuple[SignalBlock, ...]:
        """What has come; the board's samples are taken one after the other from the first read on."""
        rows = np.asarray(self._board.get_board_data(), float)
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
        """End the stream."""
        self._board.stop_stream()
        self._board.release_session()


def _columns(shim: Any, failure: type[Exception], number: int) -> dict[str, int]:
    """Row of each signal in the board's data; a board says by an error that it has none of a kind."""
    columns: dict[str, int] = {}
    for name, ask in _CHANNELS.items():
        try:
            rows = getattr(shim, ask)(number)
        except failure:
            continue
        if len(rows):
            columns[name] = int(rows[0])
    return columns
