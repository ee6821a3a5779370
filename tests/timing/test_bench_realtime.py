"""`mimics bench realtime`: three loops under one load, each counted. How late they are is for the bench to say."""

from __future__ import annotations

import json
import subprocess
import sys
import time
from pathlib import Path
from types import SimpleNamespace

from mimics_app.app.bench import realtime_load
from mimics_app.app.commands import bench
from mimics_app.lab.python_loop import PythonLoop

ROOT = Path(__file__).resolve().parents[2]
LOOPS = ("product", "rival_python_thread", "unprivileged")
FIGURES = {"recipe", "ticks", "frames", "lateness_us", "missed", "missed_share"}


def test_every_loop_is_measured_and_counted():
    command = [sys.executable, "-m", "mimics_app.app.cli", "bench", "realtime", "--seconds", "2", "--json"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=180, check=False)
    assert done.returncode == 0, done.stderr
    answer = json.loads(done.stdout)
    assert set(answer) == {"schema", "command", *LOOPS}
    for name in LOOPS:
        row = answer[name]
        stalls = row.pop("stalls", None)  # absent where real-time priority is refused
        assert stalls is None or (stalls["count"] >= 0 and stalls["longest_ms"] <= stalls["total_ms"]), name
        assert set(row) == FIGURES, name
        assert row["ticks"] > 0 and row["frames"] > 0
        late = row["lateness_us"]
        assert 0.0 < late["p50"] <= late["p99"] <= late["p99_9"] <= late["max"], name
        assert row["missed"] >= 0 and row["missed_share"] >= 0.0
    recipes = [answer[name]["recipe"] for name in LOOPS]
    assert recipes[1] == "python thread" and "python" not in recipes[0]
    assert not recipes[2].startswith("fifo")


def test_rival_is_the_products_session_and_does_the_work_of_one_tick_per_tick(monkeypatch):
    """No draining of rings, no other scene, no session without recorder: only the caller of the tick is another."""
    calls = []

    session = SimpleNamespace(haptics=SimpleNamespace(advance=calls.append))  # and nothing else to reach for
    monkeypatch.setattr(realtime_load, "_draw_frames", lambda session, seconds: time.sleep(seconds) or 3)
    row = realtime_load._measure_thread(session, 0.05)
    assert calls and set(calls) == {1}
    assert (row["ticks"], row["frames"]) == (len(calls), 3)


def test_a_loop_that_did_not_last_has_no_figures_instead_of_zeros(monkeypatch):
    monkeypatch.setattr(realtime_load, "_draw_frames", lambda session, seconds: 1)
    row = realtime_load._measure_thread(SimpleNamespace(haptics=SimpleNamespace(advance=abs)), 0.0)
    assert set(row) == {"recipe", "ticks", "frames"}
    counted = {"recipe": "x", "ticks": 2000, "frames": 1, "lateness_us": {}, "missed": 3, "missed_share": 0.3}
    assert bench._median_round([row, counted]) is counted
    assert bench._median_round([row]) is row


def test_ticks_that_a_loop_never_came_to_are_late_ones():
    """A tick that takes ten periods leaves nine of ten undone; they were dropped from the figures once."""
    with PythonLoop(lambda: time.sleep(0.01)) as loop:
        time.sleep(0.1)
    assert 0 < loop.ticks
    assert len(loop.late_us) == len(loop.ended_late) >= 5 * loop.ticks
    assert sum(loop.ended_late) >= len(loop.late_us) - 1
    undone = loop.late_us[loop.ticks :]
    assert undone == sorted(undone, reverse=True)
