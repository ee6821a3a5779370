"""Pick and place in a real window, with a real mouse: the apple is gripped, lifted over the fence and set down.

Every step waits for what is recorded, not for a time; a machine too slow to follow ends in a step that names itself.
"""

from __future__ import annotations

import numpy as np

from mimics_app.contracts.system.resources import root
from tests.support.app_window import AppWindow, open_window

SCENE = root() / "scenes" / "pick_and_place.json"
MARK = np.array([0.142, 0.16, -0.045])
HIGH = 0.27
"""Height at which the apple is carried: over the fence and the jug [m]."""

NEAR = 0.012
"""A place is reached within this [m]; the weight of the apple pulls the hand 3 mm down."""


def apple(window: AppWindow) -> np.ndarray:
    return np.array(window.lines("frame")[-1]["bodies"][0][:3])


def is_held(window: AppWindow) -> bool:
    return bool(window.rows[-1]["held_body"] == 0)


def lead(window: AppWindow, x: float, y: float, z: float) -> None:
    """Point there until the hand is there; the depth is the scene's own affair."""
    window.mouse(np.array([x, y, z]))
    goal = np.array([x, y])
    window.wait(
        f"hand at {goal}", lambda: bool(np.linalg.norm(window.rows[-1]["hip_world"][:2] - goal) < NEAR), seconds=20.0
    )


def settled(window: AppWindow) -> bool:
    places = [line["bodies"][0][:3] for line in window.lines("frame")[-6:]]
    return len(places) == 6 and float(np.ptp(places, axis=0).max()) < 2e-4


def test_apple_is_gripped_lifted_and_placed_by_mouse(tmp_path):
    with open_window(SCENE, tmp_path / "runs", 120.0) as window:
        window.wait("travel", lambda: any(line["state"] == "travel" for line in window.lines("state")))
        window.wait("apple at rest", lambda: settled(window))
        x, y, z = apple(window)
        lead(window, x, HIGH, z)
        lead(window, x, y, z)
        window.send("mousedown", "1")
        window.wait("grip", lambda: is_held(window), seconds=20.0)
        lead(window, x, HIGH, z)
        window.wait("lift", lambda: apple(window)[1] > HIGH - 0.03, seconds=20.0)
        lead(window, MARK[0], HIGH, MARK[2])
        lead(window, MARK[0], MARK[1] + 0.034, MARK[2])
        window.send("mouseup", "1")
        window.wait("placed", lambda: any(line["state"] == "finished" for line in window.lines("state")), seconds=20.0)
        code, reported = window.leave()
    assert code == 0
    assert reported["task"]["placed"] == 1
    assert reported["task"]["drops"] == 0
