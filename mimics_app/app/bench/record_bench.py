"""`mimics bench record`: live sessions killed at random moments, and how much of each its recording has lost.

The number of ticks that were done is read from the session's shared memory, which outlives its processes.
"""

from __future__ import annotations

import json
import mmap
import os
import random
import signal
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

import numpy as np

from mimics_app.contracts.clock import MonotonicClock
from mimics_app.contracts.errors import DeviceError, MimicsError, UsageError
from mimics_app.contracts.shared_memory.session_memory import ControlWord
from mimics_app.recording.recover import recover
from mimics_app.recording.run import Run

__all__ = ["measure_record", "played_session"]

_KINDS = ("application", "application and recorder")
"""What is killed: after the first the recorder drains the rings, after the second nobody does. (After a power failure
the system's disk caches are lost too: the recorder flushes them once a second.)"""

_FIRST_S, _LAST_S = 0.5, 8.0
"""A session is killed between these times after its loop has started [s]; trials of the wavy tunnel take about 4 s."""

_TICK_MS = 1.0
_PATIENCE_NS = 30_000_000_000
"""Time in which a recorder whose application was killed must have closed the recording."""
_POLL_S = 0.01


@dataclass(frozen=True, slots=True)
class _Killed:
    """What one kill left.

    Attributes:
        lost_ms: Time of the session that is missing at the end of the recording [ms].
        trials_lost: Finished trials that are missing.
        readable: Whether the repaired recording opens without damage and without a gap.
    """

    lost_ms: float
    trials_lost: int
    readable: bool


def measure_record(scene: Path, kills: int, report: Callable[[str], None]) -> dict[str, Any]:
    """Kill sessions, and return losses of all of them, and by what was killed.

    Args:
        scene: Scene that is played.
        kills: Number of sessions per kind of kill.
        report: Called with what is done next.

    Raises:
        UsageError: This system does not show the memory of another process as a file.
        DeviceError: A session did not start.
    """
    if not Path("/proc/self/fd").is_dir():
        raise UsageError("the memory of a killed session is readable on Linux only", "run it on Linux")
    rng = random.Random(1)
    rows: dict[str, list[_Killed]] = {}
    for kind in _KINDS:
        rows[kind] = []
        for number in range(kills):
            report(f"record: {kind} killed, {number + 1} of {kills}")
            rows[kind].append(_kill_one(scene, kind, rng.uniform(_FIRST_S, _LAST_S)))
    together = _summary([row for kind in _KINDS for row in rows[kind]])
    return {**together, "rows": [{"killed": kind, **_summary(rows[kind])} for kind in _KINDS]}


def _summary(killed: Sequence[_Killed]) -> Mapping[str, Any]:
    lost = [each.lost_ms for each in killed]
    return {
        "kills": len(killed),
        "lost_ms": {"p50": statistics.median(lost), "max": max(lost)},
        "trials_lost": sum(each.trials_lost for each in killed),
        "readable": sum(each.readable for each in killed),
    }


def _kill_one(scene: Path, kind: str, after_s: float) -> _Killed:
    """Start a session, kill it after a time, repair its recording and compare."""
    clock = MonotonicClock()
    with played_session(scene) as (child, facts):
        assert child.stdout is not None
        control = _control_words(child.pid, facts["memory"])
        clock.sleep_until_ns(clock.now_ns() + round(after_s * 1e9))
        if kind == _KINDS[1]:
            os.kill(facts["recorder"], signal.SIGSTOP)  # it writes nothing between the two kills
            child.kill()
            os.kill(facts["recorder"], signal.SIGKILL)
        child.kill()
        lines = child.stdout.read().split()
        return _compare(Path(facts["folder"]), int(control[ControlWord.TICKS]), int(lines[-1]) if lines else 0)


@contextmanager
def played_session(scene: Path) -> Iterator[tuple[subprocess.Popen[str], dict[str, Any]]]:
    """Yield a live session in a process of its own, and what it says of itself, see `record_load`; it is killed then.

    Raises:
        DeviceError: It did not start.
    """
    with tempfile.TemporaryDirectory(prefix="mimics-bench-") as runs:
        command = [sys.executable, "-m", "mimics_app.app.bench.record_load", str(scene), runs]
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as child:
            assert child.stdout is not None
            try:
                yield child, _facts(child.stdout)
            finally:
                child.kill()


def _facts(lines: IO[str]) -> dict[str, Any]:
    first = lines.readline()
    if not first:
        raise DeviceError("the session to be killed did not start", "see the lines above")
    facts: dict[str, Any] = json.loads(first)
    return facts


def _control_words(process: int, descriptor: int) -> np.ndarray[Any, np.dtype[np.int64]]:
    """Return the control words of another process's session; they remain after its end. `control` comes first."""
    with open(f"/proc/{process}/fd/{descriptor}", "r+b") as file:
        memory = mmap.mmap(file.fileno(), 0)
    return np.frombuffer(memory, np.int64, len(ControlWord) * 8)


def _compare(folder: Path, ticks: int, trials: int) -> _Killed:
    """Wait for the recorder, repair the recording, and compare it with what the session had done."""
    clock = MonotonicClock()
    end = clock.now_ns() + _PATIENCE_NS
    while Run.open(folder).being_recorded and clock.now_ns() < end:
        clock.sleep_until_ns(clock.now_ns() + round(_POLL_S * 1e9))
    try:
        recover(folder)
        run = Run.open(folder)
        recorded = int(run.haptic["tick"][-1]) + 1 if len(run.haptic) else 0
    except MimicsError:
        return _Killed(ticks * _TICK_MS, trials, readable=False)
    lost = max(ticks - recorded, 0) * _TICK_MS
    return _Killed(lost, max(trials - len(run.trials), 0), readable=not run.damages and not run.gaps)
