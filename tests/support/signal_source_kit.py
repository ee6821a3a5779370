"""Conformance kit of sources of body signals: what a session takes for granted of one, built in or of a package."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from mimics_app.contracts.clock import SECOND_NS
from mimics_app.contracts.messages.stage_messages import Experience, SignalBlock
from mimics_app.contracts.ports.input_port import SignalSource

BEGUN_NS = 5 * SECOND_NS
"""A session's clock does not begin at 0."""
FRAMES = 90
FRAME_NS = 16_666_667
JITTER_NS = 40_000_000
"""Deviation that `integrity.Grid` allows a live source's time stamps [ns]."""
SHIFT_NS = 2_000_000
"""Shift of a block against the end of the one before, by which a grid follows the clock of an amplifier [ns]."""
HIGHEST_RATE = 20_000.0
"""Highest rate that the processing accepts [Hz]."""
LEAST = 0.5
"""Share of the session's time that its signals cover at least; a live source begins late."""


def on_the_virtual_clock(frame: int) -> int:
    """The time of a frame [ns]."""
    return BEGUN_NS + frame * FRAME_NS


def check_signal_source(source: SignalSource, frame_at: Callable[[int], int] = on_the_virtual_clock) -> None:
    """Read a source as a session does; raises AssertionError at what a source must not do.

    Args:
        source: Open.
        frame_at: Waits for a frame and returns its time [ns]; the amplifier of a live source sends meanwhile.
    """
    heard: dict[str, list[SignalBlock]] = {}
    copies: list[tuple[SignalBlock, np.ndarray]] = []
    for frame in range(FRAMES):
        now_ns = frame_at(frame)
        for blocks in (source.read(now_ns), source.read(now_ns)):
            assert isinstance(blocks, tuple), "the blocks of a read are a tuple, () for none"
            for block in blocks:
                _check_block(block, heard.setdefault(block.name, []), now_ns)
                copies.append((block, block.values.copy()))
        _check_lost(source)
        source.take_experience(Experience(now_ns, speed=0.1, power=0.2, demand=0.5, acting=True))
    assert heard, "it delivers signals"
    for name, blocks in heard.items():
        seconds = sum(len(block.values) for block in blocks) / blocks[0].rate
        assert seconds > LEAST * FRAMES * FRAME_NS / SECOND_NS, f"{name} keeps the pace of the session"
    for block, values in copies:
        np.testing.assert_array_equal(block.values, values, "a block that was delivered stays what it was")
    source.close()


def _check_block(block: SignalBlock, before: list[SignalBlock], now_ns: int) -> None:
    """A block of regular samples after those that came before, none from the future."""
    assert isinstance(block.name, str) and block.name, "a signal has a name"
    values = block.values
    assert isinstance(values, np.ndarray) and values.ndim == 1 and values.dtype == np.float64, "values are float64 [n]"
    assert len(values), "a block has samples"
    assert not np.isinf(values).any(), "a missing sample is NaN"
    assert type(block.t_ns) is int, "time is whole nanoseconds"
    assert 0.0 < block.rate <= HIGHEST_RATE, "the rate can be processed"
    if before:
        assert block.rate == before[0].rate, "the rate of a signal stays"
        assert block.t_ns >= _end_ns(before[-1]) - SHIFT_NS, "each sample comes once, in the order of time"
    before.append(block)
    assert _end_ns(block) <= now_ns + JITTER_NS + SECOND_NS / block.rate, "no sample comes before its time"


def _end_ns(block: SignalBlock) -> float:
    return block.t_ns + len(block.values) / block.rate * SECOND_NS


def _check_lost(source: SignalSource) -> None:
    """A source that may fail during a session says why in one line, "" while it delivers."""
    lost = source.lost
    assert isinstance(lost, str) and "\n" not in lost and not lost, f"it says that it is lost: {lost}"
