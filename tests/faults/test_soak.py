"""A session that goes on for hours: memory, descriptors, shared memory and the rate of the loop stay as they were."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

import mimics_app as mimics
from mimics_app.contracts.clock import FRAMES_PER_SECOND, SECOND_NS, TICK_NS, TICKS_PER_SECOND
from mimics_app.contracts.system.resources import root
from mimics_app.recording.run import Run
from tests.support.resident import resident_mb

SCENE = root() / "scenes" / "wavy_tunnel.json"
MB_AN_HOUR = 1.0
MOST_PPM = 50.0
STALL_NS = 0.05 * SECOND_NS
"""Lateness beyond which the loop does not catch up [ns]."""
WARM_S = 60.0
"""Session time after which every buffer has been filled once [s]."""


def descriptors(process: int | str = "self") -> int:
    return len(os.listdir(f"/proc/{process}/fd"))


def shared_mappings(process: int | str = "self") -> int:
    return sum("memfd:" in line for line in Path(f"/proc/{process}/maps").read_text().splitlines())


@pytest.mark.fault(id="F18")
@pytest.mark.parametrize(
    ("seconds", "most_mb"),
    [(120.0, 2.0), pytest.param(8 * 3600.0, 8 * MB_AN_HOUR, marks=pytest.mark.slow)],
    ids=["two minutes", "8 h"],
)
def test_a_long_session_needs_no_more_than_a_short_one(seconds: float, most_mb: float) -> None:
    with mimics.open(SCENE, trials=10_000, record=False) as session:
        session.step(WARM_S)
        before = resident_mb(), descriptors(), shared_mappings()
        session.step(seconds)
        after = resident_mb(), descriptors(), shared_mappings()
    assert session.result["frames"] == round((WARM_S + seconds) * FRAMES_PER_SECOND)
    assert after[0] - before[0] < most_mb
    assert after[1:] == before[1:]


@pytest.mark.slow
@pytest.mark.fault(id="F18")
def test_half_an_hour_by_the_wall_clock(tmp_path: Path) -> None:
    """The share of missed ticks of the last third is that of the first, but for what another program takes."""
    words = [sys.executable, "-m", "mimics_app", "run", str(SCENE), "--headless", "--console", "0", "--sound", "off"]
    words += ["--seconds", "1800", "--trials", "10000", "--pictures", "0", "--runs", str(tmp_path / "runs")]
    environment = {**os.environ, "XDG_RUNTIME_DIR": str(tmp_path)}
    with subprocess.Popen(words, cwd=root(), env=environment, stderr=subprocess.DEVNULL) as process:
        time.sleep(300.0)
        begun, held = resident_mb(process.pid), (descriptors(process.pid), shared_mappings(process.pid))
        time.sleep(1200.0)
        assert resident_mb(process.pid) - begun < MB_AN_HOUR / 3.0 + 1.0
        assert (descriptors(process.pid), shared_mappings(process.pid)) == held
        assert process.wait(900.0) == 0
    run = Run.open(next((tmp_path / "runs").iterdir()))
    lines = [line for line in run.lines_of("app", "frame") if "tick" in line]
    ticks, times = (np.array([line[name] for line in lines], float) for name in ("tick", "t_ns"))
    behind, minutes = times - ticks * TICK_NS, ticks // (60 * TICKS_PER_SECOND)
    by_minute = np.array([np.median(behind[minutes == minute]) for minute in np.unique(minutes)])
    assert abs(np.median(np.diff(by_minute))) / (60 * SECOND_NS) * 1e6 < MOST_PPM
    lateness = run.haptic["lateness_ns"]
    stalled = lateness[lateness > STALL_NS].sum()  # after such a stall the loop goes on from where it is
    assert by_minute[-1] - by_minute[0] < stalled + MOST_PPM * 1e-6 * (times[-1] - times[0])
    late = lateness > TICK_NS
    third = len(late) // 3
    assert late[-third:].mean() <= max(2.0 * late[:third].mean(), 1e-3)
