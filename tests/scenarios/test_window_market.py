"""Three apples in a real window by a real mouse, from the page of keys over the count to the page of results.

A person who sees an apple slip takes it again: so does the one here, until the trial is over. `pictures` of the test's
folder holds what was on the screen at each step.
"""

from __future__ import annotations

import csv
import json
import time
from pathlib import Path

import numpy as np
import pytest

from mimics_app.contracts.system.resources import root
from tests.support.app_window import AppWindow, open_journey

pytestmark = pytest.mark.slow

SCENE = root() / "scenes" / "pick_and_place.json"
MARK = np.array([0.142, 0.16, -0.045])
HIGH = 0.27
"""Height at which the apple is carried: over the fence and the jug [m]."""

NEAR = 0.014
"""A place is reached within this [m]."""

PATIENCE_S = 15.0
"""How long the hand is waited for on its way to a place [s]: a second on a machine with nothing else to do."""

OVER = ("finished", "timeout", "aborted")


def states(window: AppWindow) -> list[tuple[str, int]]:
    """(state, trial) in order, trials from 0."""
    return [(line["state"], line["trial"]) for line in window.lines("state")]


def is_over(window: AppWindow, trial: int) -> bool:
    return any(state in OVER and number == trial for state, number in states(window))


def is_held(window: AppWindow) -> bool:
    return bool(window.rows[-1]["held_body"] == 0)


def lead(window: AppWindow, x: float, y: float, z: float) -> None:
    """Point there until the hand is there, or patience ends; the depth is the scene's own affair."""
    window.mouse(np.array([x, y, z]))
    goal, end = np.array([x, y]), time.monotonic() + PATIENCE_S
    while np.linalg.norm(window.rows[-1]["hip_world"][:2] - goal) > NEAR and time.monotonic() < end:
        time.sleep(0.1)


def grip(window: AppWindow) -> None:
    """Open the hand, go to the apple from above, close it."""
    window.send("mouseup", "1")
    x, y, z = window.lines("frame")[-1]["bodies"][0][:3]
    lead(window, x, HIGH, z)
    x, y, z = window.lines("frame")[-1]["bodies"][0][:3]
    lead(window, x, y, z)
    window.send("mousedown", "1")
    end = time.monotonic() + PATIENCE_S
    while not is_held(window) and time.monotonic() < end:
        time.sleep(0.1)


def carry(window: AppWindow) -> None:
    """Lift the apple, bring it over the mark and down, open the hand."""
    x, _, z = window.rows[-1]["hip_world"]
    lead(window, float(x), HIGH, float(z))
    lead(window, MARK[0], HIGH, MARK[2])
    lead(window, MARK[0], MARK[1] + 0.034, MARK[2])
    window.send("mouseup", "1")
    time.sleep(1.5)


def place_one(window: AppWindow, trial: int) -> None:
    window.wait(f"go of trial {trial + 1}", lambda: ("travel", trial) in states(window), seconds=150.0)
    end = time.monotonic() + 280.0
    while not is_over(window, trial):
        assert time.monotonic() < end, f"trial {trial + 1} does not end"
        (carry if is_held(window) else grip)(window)
    window.keep(f"{trial + 3}_placed")


def test_three_apples_to_the_page_of_results(tmp_path: Path) -> None:
    patience = tmp_path / "patience.json"
    patience.write_text(json.dumps([{"trial": trial, "values": {"duration": 300.0}} for trial in range(3)]))
    words = ("--trials", "3", "--participant", "P1", "--action", str(patience))
    with open_journey(SCENE, tmp_path / "runs", *words) as window:
        window.wait("ready", lambda: ("ready", 0) in states(window), seconds=150.0)
        time.sleep(1.0)
        window.keep("1_keys")
        window.send("key", "Return")
        time.sleep(1.0)
        window.keep("2_count")
        for trial in range(3):
            place_one(window, trial)
        window.wait("report", lambda: any(window.runs.glob("*/report.html")), seconds=90.0)
        time.sleep(3.0)
        window.keep("6_result")
        window.send("key", "c")
        assert window.process.wait(timeout=60) == 0
    with next(window.runs.glob("*/trials.csv")).open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [row["outcome"] for row in rows] == ["finished"] * 3
    assert all(float(row["score"]) > 0.0 for row in rows)
