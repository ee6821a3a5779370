"""Stalls of the machine: the times at which it let not even a waiting process of the highest priority run.

One process per core sleeps to every millisecond, pinned to its core, with the highest real-time priority. What it
misses by more than a millisecond was taken by the host of a virtual machine, by interrupts or by firmware, and no
program of this machine could have run on that core meanwhile.
"""

from __future__ import annotations

import gc
import json
import signal
import subprocess
import sys
from collections.abc import Sequence
from types import FrameType
from typing import Any

import numpy as np

from mimics_app.contracts.arrays import I8
from mimics_app.contracts.clock import SECOND_NS, TICK_NS, MonotonicClock
from mimics_app.rendering.haptic.scheduler import cores, occupy_core

__all__ = ["StallWitness", "Stalls", "explain_gaps", "summarise"]

_SHORTEST_NS = 1_000_000
"""Delays up to this length do not count [ns]."""
_NOT_HELD_NS = 4_000_000
"""What a queue of live sound may lack of its length when a stall begins [ns]: a block of 1.7 ms that does not fit yet,
a period of 1.3 ms taken at once, and what waking up takes."""
_LONG_NS = 2_000_000
"""Shortest stall that can empty the shortest queue, 6 ms [ns]."""
_WINDOW_NS = 30_000_000
"""Time before a gap in which its cause is looked for [ns]: the longest queue, 15.5 ms, and as much silence."""
_STOP_S = 10.0
"""Time-out of the end of a witness [s]."""

Stalls = I8
"""Shape [n, 2]: begin and end of each stall on the clock of `MonotonicClock` [ns]."""


class StallWitness:
    """Watches every core from construction to `stop`."""

    def __init__(self) -> None:
        command = [sys.executable, "-m", "mimics_app.app.bench.stall_witness"]
        self._children = [subprocess.Popen([*command, str(core)], stdout=subprocess.PIPE) for core in cores()]

    def stop(self) -> Stalls | None:
        """Return the stalls of all cores; None where real-time priority is refused: then nothing was measured."""
        for child in self._children:
            child.send_signal(signal.SIGTERM)
        answers = [json.loads(child.communicate(timeout=_STOP_S)[0] or "null") for child in self._children]
        if not answers or None in answers:
            return None
        return np.array([stall for answer in answers for stall in answer], np.int64).reshape(-1, 2)


def _stalled_before(stalls: Stalls, t_ns: int) -> float:
    """Return for how much of the 30 ms before t_ns any core was stalled [ms]."""
    stalled, since = 0, t_ns - _WINDOW_NS
    for begin, end in stalls[np.argsort(stalls[:, 0])].tolist():
        stalled += max(0, min(end, t_ns) - max(begin, since))
        since = max(since, end)
    return stalled * 1e-6


def summarise(stalls: Stalls) -> dict[str, Any]:
    """Return `count`, `longest_ms` and `total_ms` of the stalls, summed over the cores."""
    length_ms = (stalls[:, 1] - stalls[:, 0]) * 1e-6
    return {"count": len(stalls), "longest_ms": float(length_ms.max(initial=0)), "total_ms": float(length_ms.sum())}


def explain_gaps(stalls: Stalls, gaps: Sequence[Sequence[float]], seconds: float) -> dict[str, Any]:
    """Hold the gaps of a live sound against the stalls of the machine.

    Args:
        stalls: See `Stalls`.
        gaps: Time at which the queue was found empty [ns], and its length then [ms], of each.
        seconds: Length of the measurement [s].

    Returns:
        Those of `summarise`; `before_gap_ms`, the stalled time shortly before each gap; `unexplained`, the gaps
        before which that was shorter than what a queue of this length outlasts; `chance`, the share of all moments
        that have a stall of 2 ms before them, thus at most the share of the gaps that coincidence would explain.
    """
    length = stalls[:, 1] - stalls[:, 0]
    before = [_stalled_before(stalls, int(t_ns)) for t_ns, _ in gaps]
    covered = int((length[length >= _LONG_NS] + _WINDOW_NS).sum())
    return {
        **summarise(stalls),
        "before_gap_ms": before,
        "unexplained": sum(stall < queue - _NOT_HELD_NS * 1e-6 for stall, (_, queue) in zip(before, gaps, strict=True)),
        "chance": min(1.0, covered / (seconds * SECOND_NS)),
    }


def _watch(core: int) -> list[tuple[int, int]] | None:
    """Watch one core until SIGTERM; None without real-time priority."""
    ended = False

    def end(_signal: int, _frame: FrameType | None) -> None:
        nonlocal ended
        ended = True

    signal.signal(signal.SIGTERM, end)
    if not occupy_core(core):
        return None
    gc.disable()
    stalls, clock = [], MonotonicClock()
    due = clock.now_ns()
    while not ended:
        due += TICK_NS
        clock.sleep_until_ns(due)
        now = clock.now_ns()
        if now - due > _SHORTEST_NS:
            stalls.append((due, now))
            due = now
    return stalls


if __name__ == "__main__":
    json.dump(_watch(int(sys.argv[1])), sys.stdout)
