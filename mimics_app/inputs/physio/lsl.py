"""Body signals from streams of the lab streaming layer (LSL): lsl:NAME takes every stream of that name or type.

Channels are known by their labels in the stream's description, else by the stream's type. Times are those of the
sender, corrected by the measured offset of its clock; the offsets are kept.
"""

from __future__ import annotations

from collections.abc import Callable
from types import ModuleType
from typing import TYPE_CHECKING

import numpy as np

from mimics_app.contracts.clock import SECOND_NS, MonotonicClock
from mimics_app.contracts.errors import DeviceError, UsageError
from mimics_app.contracts.messages import SignalBlock
from mimics_app.inputs.physio.integrity import Grid, LiveSignals
from mimics_app.inputs.physio.recording import name_of_channel

if TYPE_CHECKING:
    from pylsl import StreamInfo, StreamInlet

__all__ = ["LslSource", "find_stream"]

_PATIENCE_S = 5.0
"""How long a stream that was found may take to describe itself [s]."""

_ANSWER_S = 3.0
"""How long a stream is waited for [s]: the library asks every 0.5 s, further apart from time to time."""

_AT_ONCE_S = 0.3
"""A wait that is longer than this [s] is announced."""

_MOST = 4096
_GLANCE_S = 0.002
_ASK_OFFSET_NS = 5 * SECOND_NS


def _say_nothing(text: str) -> None:
    """Nobody is there."""


class LslSource(LiveSignals):
    """Every channel of a stream that is a body signal.

    Args:
        name: Of the stream, or its type.

    Attributes:
        offsets: Clock of the sender less ours [s], as measured, newest last.

    Raises:
        UsageError: pylsl is not installed.
        DeviceError: There is no such stream, or no channel of it is a body signal.
    """

    def __init__(self, name: str) -> None:
        super().__init__()
        pylsl = _library()
        self._inlet: StreamInlet = pylsl.StreamInlet(find_stream(name), max_buflen=60, recover=True)
        info = self._inlet.info(_PATIENCE_S)
        self._columns = _columns(info)
        if not self._columns:
            raise DeviceError(
                f'no channel of the LSL stream "{name}" is a body signal', "label them ecg, gsr, emg or resp"
            )
        self._rate = float(info.nominal_srate())
        if self._rate <= 0.0:
            raise DeviceError(f'the LSL stream "{name}" has no regular rate', "send it at one")
        self._grids = {name: Grid(name, self._rate) for name in self._columns}
        self._clock = MonotonicClock()
        self._pylsl = pylsl
        self.offsets: list[float] = []
        self._ask_ns = 0
        self._measure_offset(_PATIENCE_S)

    def read(self, now_ns: int) -> tuple[SignalBlock, ...]:
        """What has come."""
        if now_ns >= self._ask_ns:
            self._ask_ns = now_ns + _ASK_OFFSET_NS
            self._measure_offset(_GLANCE_S)
        samples, times = self._inlet.pull_chunk(timeout=0.0, max_samples=_MOST)
        if not times:
            return ()
        offset = self.offsets[-1] if self.offsets else 0.0
        here = self._pylsl.local_clock()
        t_ns = now_ns - round((here - (times[0] + offset)) * SECOND_NS)
        rows = np.asarray(samples, float)
        blocks = (self._grids[name].take(t_ns, rows[:, i].copy()) for name, i in self._columns.items())
        return tuple(block for block in blocks if block is not None)

    def close(self) -> None:
        """Let the stream go."""
        self._inlet.close_stream()

    def _measure_offset(self, patience_s: float) -> None:
        """Note the offset of the sender's clock; later ones are there at once, the library measures on its own."""
        try:
            self.offsets.append(float(self._inlet.time_correction(patience_s)))
        except (self._pylsl.util.TimeoutError, RuntimeError):
            return  # the sender is away; the old offset stands


def find_stream(name: str, tell: Callable[[str], None] = _say_nothing) -> StreamInfo:
    """The first stream of that name or type that answers.

    Args:
        name: Of the stream, or its type.
        tell: Is called with a line before a wait.

    Raises:
        UsageError: pylsl is not installed.
        DeviceError: No such stream answers.
    """
    pylsl = _library()
    wanted = f"name='{name}' or type='{name}'"
    found = pylsl.resolve_bypred(wanted, 1, _AT_ONCE_S)
    if not found:
        tell(f'waiting up to {_ANSWER_S:g} s for the LSL stream "{name}"')
        found = pylsl.resolve_bypred(wanted, 1, _ANSWER_S)
    if not found:
        there = sorted({stream.name() for stream in pylsl.resolve_streams(_AT_ONCE_S)})
        hint = f"there are: {', '.join(there)}" if there else "no stream is on the network"
        raise DeviceError(f'no LSL stream is called "{name}"', hint)
    stream: StreamInfo = found[0]
    return stream


def _columns(info: object) -> dict[str, int]:
    """Column of each body signal."""
    channel = info.desc().child("channels").child("channel")  # type: ignore[attr-defined]
    labels = []
    for _ in range(info.channel_count()):  # type: ignore[attr-defined]
        labels.append(channel.child_value("label") or channel.child_value("type") or "")
        channel = channel.next_sibling()
    if not any(name_of_channel(label) for label in labels):
        labels = [info.type(), *labels[1:]]  # type: ignore[attr-defined]
    columns: dict[str, int] = {}
    for i, label in enumerate(labels):
        name = name_of_channel(label)
        if name and name not in columns:
            columns[name] = i
    return columns


def _library() -> ModuleType:
    try:
        import pylsl
    except (ImportError, RuntimeError) as error:  # the second: its shared library is not there
        raise UsageError("LSL needs pylsl, which is not installed", 'pip install "mimics_app[lsl]"') from error
    return pylsl
