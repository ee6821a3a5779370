"""Faults of processes for `mimics bench faults`: a stall, an end by a signal, a kill; what the session leaves then.

Faults that only the tests of a checkout make happen (to pictures, sound, disks, lines and pages) are repeated by these.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import tempfile
from collections.abc import Callable, Mapping
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from mimics_app.app.bench.record_bench import measure_record, played_session
from mimics_app.contracts.clock import SECOND_NS, MonotonicClock
from mimics_app.contracts.errors import UsageError
from mimics_app.contracts.loop.haptic import SafetyState
from mimics_app.contracts.system.resources import root
from mimics_app.recording.run import Run

__all__ = ["OF_TESTS", "PROCESS_FAULTS", "measure_by_tests"]

Measure = Callable[[Path, int, Callable[[str], None]], dict[str, Any]]

_PLAYED_S, _STALL_S, _AFTER_S = 6.0, 0.35, 0.8
"""Time before a stall, in which the first trial begins, its length, and time after it [s]."""
_STALLED_NS = 50_000_000.0
_NEXT_TICKS = 100
"""Ticks after a stall in which the force must not be larger than before."""
_LOST_MS = 100.0
_SIGNALS = {signal.SIGTERM: 143, signal.SIGHUP: 129, signal.SIGINT: 130}
"""Signals, and the exit status that each must give."""


def _sleep(seconds: float) -> None:
    clock = MonotonicClock()
    clock.sleep_until_ns(clock.now_ns() + round(seconds * SECOND_NS))


def _stalled(scene: Path, repeats: int, _: Callable[[str], None]) -> dict[str, Any]:
    """Hold a live session for a third of a second: the loop must pause the force, and nothing may burst then."""
    passed, worst = 0, 0.0
    for _number in range(repeats):
        with played_session(scene) as (child, facts):
            _sleep(_PLAYED_S)
            os.kill(child.pid, signal.SIGSTOP)
            _sleep(_STALL_S)
            os.kill(child.pid, signal.SIGCONT)
            _sleep(_AFTER_S)
            child.kill()
            child.wait()
            _sleep(_AFTER_S)  # the recorder drains the rings
            rows = Run.open(facts["folder"]).haptic
        force = np.linalg.norm(rows["f_user_world"].reshape(len(rows), -1), axis=1)
        late = np.flatnonzero(rows["lateness_ns"] > _STALLED_NS)
        if len(late) and late[-1] + _NEXT_TICKS < len(rows):
            at = int(late[0])
            after = force[at : at + _NEXT_TICKS]
            worst = max(worst, float(after.max()))
            passed += bool((rows["state"][at + 1 : at + 3] >= SafetyState.DEGRADED).any()) and bool(
                after.max() <= force[: at + 1].max()
            )
    return {"fault": "the process stalls", "repeat": repeats, "force_max_n": worst, "passed": passed == repeats}


def _ended_by_signals(scene: Path, repeats: int, _: Callable[[str], None]) -> dict[str, Any]:
    """End a run by each signal: it closes its recording and says by its status which one it was."""
    wrong: list[str] = []
    for number in range(repeats):
        sent, status = list(_SIGNALS.items())[number % len(_SIGNALS)]
        with tempfile.TemporaryDirectory(prefix="mimics-bench-") as runs:
            words = [sys.executable, "-m", "mimics_app", "run", str(scene), "--headless", "--seconds", "36000"]
            words += ["--sound", "off", "--pictures", "0", "--runs", runs]
            with subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as child:
                _wait_for_run(Path(runs))
                child.send_signal(sent)
                code = child.wait()
            closed = all((run / "manifest.json").is_file() for run in Path(runs).iterdir())
        if code != status or not closed:
            wrong.append(f"{sent.name}: status {code}{'' if closed else ', recording not closed'}")
    return {"fault": "SIGTERM, SIGHUP or Ctrl-C", "repeat": repeats, "wrong": wrong, "passed": not wrong}


def _wait_for_run(runs: Path) -> None:
    """Wait until a run has recorded something."""
    clock = MonotonicClock()
    end_ns = clock.now_ns() + 60 * SECOND_NS
    while not list(runs.glob("*/haptic.arrows")) and clock.now_ns() < end_ns:
        _sleep(0.05)
    _sleep(0.5)


def _killed(scene: Path, repeats: int, report: Callable[[str], None]) -> dict[str, Any]:
    """Kill the application, and application and recorder."""
    found = measure_record(scene, repeats, report)
    whole = found["trials_lost"] == 0 and found["readable"] == found["kills"]
    return {
        "fault": "the application is killed",
        "repeat": found["kills"],
        "lost_ms": found["lost_ms"],
        "bound_ms": _LOST_MS,
        "passed": whole and found["lost_ms"]["max"] <= _LOST_MS,
    }


PROCESS_FAULTS: Mapping[str, Measure] = {"F05": _stalled, "F10": _ended_by_signals, "F11": _killed}
"""What measures a fault, by its number in docs/faults.md: from scene, number of repeats and what shows progress."""

OF_TESTS = tuple(f"F{number:02d}" for number in (6, 7, 8, 9, 12, 13, 14, 15, 16, 18, 19, 20))
"""Numbers in docs/faults.md of the faults that are repeated by their tests, each in a process of its own."""


def measure_by_tests(number: str, repeats: int, report: Callable[[str], None]) -> dict[str, Any]:
    """Run the tests of a fault so many times.

    Args:
        number: Number of the fault, one of `OF_TESTS`.
        repeats: Number of processes, one after the other.
        report: Called with what is done next.

    Raises:
        UsageError: This is no checkout, or pytest is not installed.
    """
    if find_spec("pytest") is None:
        raise UsageError(f"{number} is repeated by its tests, and pytest is not installed", "sh .ci/dev.sh test first")
    mark = f'fault(id="{number}")'
    files = [str(path) for path in sorted((root() / "tests").rglob("test_*.py")) if mark in path.read_text("utf-8")]
    if not files:
        raise UsageError(f"{number} is repeated by its tests, which are not installed", "run it in a checkout")
    command = [sys.executable, "-m", "pytest", "-q", "-n0", "-p", "no:cacheprovider", "-m", f"{mark} and not slow"]
    failed = 0
    for repeat in range(repeats):
        report(f"faults: {number}, by its tests, {repeat + 1} of {repeats}")
        done = subprocess.run([*command, *files], cwd=root(), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        failed += done.returncode != 0
    tests = [str(Path(file).relative_to(root())) for file in files]
    return {"number": number, "repeat": repeats, "tests": tests, "failed": failed, "passed": not failed}
