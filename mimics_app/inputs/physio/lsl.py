"""Body signals from a stream of the lab streaming layer (LSL), by its name or type: lsl:NAME.

Channels are identified by their labels in the stream's description, else by the stream's type, and converted from the
unit stated there. Time stamps are those of the sender, corrected by the measured offset of its clock, which the
journal notes.
"""

from __future__ import annotations

from collections.abc import Callable
from types import ModuleType
from typing import TYPE_CHECKING

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.clock import SECOND_NS, MonotonicClock
from mimics_app.contracts.errors import DeviceError, UsageError
from mimics_app.contracts.messages.stage_messages import SignalBlock
from mimics_app.inputs.physio.channel_names import NAMES_HINT, columns_of, say_columns, unit_factor
from mimics_app.inputs.physio.integrity import Grid, LiveSignals

if TYPE_CHECKING:
    from pylsl import StreamInfo, StreamInlet

__all__ = ["LslSource", "find_stream", "lsl_library"]

_PATIENCE_S = 5.0
"""Time-out of a stream's description and of its first clock offset [s]."""

_ANSWER_S = 3.0
"""Time-out of the search for a stream [s]: the library repeats its query every 0.5 s, later at longer intervals."""

_AT_ONCE_S = 0.3
"""Time-out of the first search [s]; a longer wait is announced."""

_MOST = 4096
"""Samples taken in one read."""
_OFFSET_TIMEOUT_S = 0.002
"""Time-out of a clock offset within a session [s]."""
_JUMP_S = 0.05
"""Step of the time stamps within samples that were taken together, beyond which they do not belong together [s]."""
_ASK_OFFSET_NS = 5 * SECOND_NS
"""Period in which the clock offset is measured [ns]."""


def _say_nothing(text: str) -> None:
    """Discard the line."""


class LslSource(LiveSignals):
    """The body signals of one stream.

    Args:
        name: Name of the stream, or its type.

    Attributes:
        clock_offset_s: Newest offset from the sender's clock to this computer's [s]; None before the first.

    Raises:
        UsageError: pylsl is not installed.
        DeviceError: The stream does not exist, or no channel of it is a body signal.
    """

    def __init__(self, name: str) -> None:
        super().__init__()
        self._name = name
        pylsl = self._pylsl = lsl_library()
        self._inlet: StreamInlet = pylsl.StreamInlet(find_stream(name), max_buflen=60, recover=True)
        info = self._description()
        self._columns, self._factors, self.notes = _columns(info)
        if not self._columns:
            raise DeviceError(f'no channel of the LSL stream "{name}" is a body signal', NAMES_HINT)
        if info.channel_format() == pylsl.cf_string:
            raise DeviceError(f'the samples of the LSL stream "{name}" are text', "send numbers, e.g. as float32")
        self._rate = float(info.nominal_srate())
        if self._rate <= 0.0:
            raise DeviceError(f'the LSL stream "{name}" has no regular rate', "send it at a fixed rate")
        self._grids = {name: Grid(name, self._rate) for name in self._columns}
        self._clock = MonotonicClock()
        self.clock_offset_s: float | None = None
        self._ask_ns = 0
        self._ended = False
        self._measure_offset(_PATIENCE_S)

    def read(self, now_ns: int) -> tuple[SignalBlock, ...]:
        """Return the samples received since the last read."""
        if now_ns >= self._ask_ns:
            self._ask_ns = now_ns + _ASK_OFFSET_NS
            self._measure_offset(_OFFSET_TIMEOUT_S)
        try:
            samples, times = self._inlet.pull_chunk(timeout=0.0, max_samples=_MOST)
        except self._pylsl.util.LostError:
            self.lost = f'the LSL stream "{self._name}" has ended; without a source id it cannot be found again'
            self._ended = True
        if self._ended:
            return ()
        self._listen(now_ns, received=bool(times), source=f'the LSL stream "{self._name}"')
        if not times:
            return ()
        return self._blocks(np.asarray(samples, float), np.asarray(times), now_ns)

    def _blocks(self, rows: F8, times: F8, now_ns: int) -> tuple[SignalBlock, ...]:
        """Return samples as blocks; a jump of their time stamps within them begins another one."""
        offset = self.clock_offset_s or 0.0
        here = self._pylsl.local_clock()
        jumps = np.abs(np.diff(times) - 1.0 / self._rate) > _JUMP_S
        blocks = []
        for part in np.split(np.arange(len(times)), np.flatnonzero(jumps) + 1):
            t_ns = now_ns - round((here - (times[part[0]] + offset)) * SECOND_NS)
            for name, i in self._columns.items():
                blocks.append(self._grids[name].take(t_ns, self._factors[name] * rows[part, i], now_ns))
        return tuple(block for block in blocks if block is not None)

    def close(self) -> None:
        """Close the stream."""
        self._inlet.close_stream()

    def _description(self) -> StreamInfo:
        """Return the description of the stream.

        Raises:
            DeviceError: It does not come.
        """
        try:
            return self._inlet.info(_PATIENCE_S)
        except (self._pylsl.util.TimeoutError, self._pylsl.util.LostError, RuntimeError) as error:
            raise DeviceError(f'the LSL stream "{self._name}" does not answer', "start its sender again") from error

    def _measure_offset(self, patience_s: float) -> None:
        """Note the offset of the sender's clock; after the first one the library measures in the background."""
        try:
            self.clock_offset_s = float(self._inlet.time_correction(patience_s))
        except (self._pylsl.util.TimeoutError, self._pylsl.util.LostError, RuntimeError):
            return  # the sender does not answer; the last offset remains valid


def find_stream(name: str, tell: Callable[[str], None] = _say_nothing) -> StreamInfo:
    """Return the first stream of a name or type that answers.

    Args:
        name: Name of the stream, or its type.
        tell: Called with a line of text before a wait.

    Raises:
        UsageError: pylsl is not installed.
        DeviceError: No such stream answers.
    """
    pylsl = lsl_library()
    quoted = _quoted(name)
    wanted = f"name={quoted} or type={quoted}"
    found = pylsl.resolve_bypred(wanted, 1, _AT_ONCE_S)
    if not found:
        tell(f'waiting up to {_ANSWER_S:g} s for the LSL stream "{name}"')
        found = pylsl.resolve_bypred(wanted, 1, _ANSWER_S)
    if not found:
        there = sorted({stream.name() for stream in pylsl.resolve_streams(_AT_ONCE_S)})
        hint = f"there are: {', '.join(there)}" if there else "no stream is on the network"
        raise DeviceError(f'no LSL stream has the name "{name}"', hint)
    stream: StreamInfo = found[0]
    return stream


def _quoted(name: str) -> str:
    """Return a name as a literal of the query, which knows no escapes: XPath 1.0.

    Raises:
        UsageError: It has quotes of both kinds.
    """
    if "'" not in name:
        return f"'{name}'"
    if '"' in name:
        raise UsageError(f"the name {name} has quotes of both kinds", "name the stream by its type, or rename it")
    return f'"{name}"'


def _columns(info: object) -> tuple[dict[str, int], dict[str, float], tuple[str, ...]]:
    """Return the column of each body signal, the factor from its unit to that of the signal, and both in words."""
    channel = info.desc().child("channels").child("channel")  # type: ignore[attr-defined]
    labels, units = [], []
    for _ in range(info.channel_count()):  # type: ignore[attr-defined]
        labels.append(channel.child_value("label") or channel.child_value("type") or "")
        units.append(channel.child_value("unit") or "")
        channel = channel.next_sibling()
    columns = columns_of(labels) or columns_of([info.type()])  # type: ignore[attr-defined]
    return columns, {name: unit_factor(name, units[i]) for name, i in columns.items()}, say_columns(labels, columns)


def lsl_library() -> ModuleType:
    """Return pylsl.

    Raises:
        UsageError: It is not installed.
    """
    try:
        import pylsl
    except (ImportError, RuntimeError) as error:  # RuntimeError: the package without its shared library
        raise UsageError("LSL needs pylsl, which is not installed", 'pip install "mimics_app[lsl]"') from error
    return pylsl
