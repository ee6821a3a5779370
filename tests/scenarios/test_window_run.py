"""A real window on a virtual screen, a real mouse: the wall holds, letting go is free, Space stops, Escape leaves."""

from __future__ import annotations

import json
import signal
import time
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from mimics_app.app.scenes.loading import load_checked_scene
from mimics_app.contracts.haptic import SafetyState
from mimics_app.contracts.resources import root
from mimics_app.rendering.haptic.scene_tunnel import tunnel_of_scene
from tests.support.app_window import AppWindow, open_window

SCENE = root() / "scenes" / "wavy_tunnel.json"
STIFFNESS = 2000.0
FORCE_BAR = (660, 50, 926, 76)


def force_pixels(window: AppWindow) -> int:
    """Coloured pixels of the force bar."""
    left, top, right, bottom = FORCE_BAR
    picture = window.picture()[top:bottom, left:right].astype(int)
    return int((picture.max(axis=2) - picture.min(axis=2) > 60).sum())


@pytest.fixture
def window(tmp_path) -> Iterator[AppWindow]:
    with open_window(SCENE, tmp_path / "runs", 120.0) as window:
        window.wait("travel", lambda: any(line["state"] == "travel" for line in window.lines("state")))
        yield window


def held(window: AppWindow, point_world: np.ndarray, seconds: float) -> Any:
    """Rows recorded in the last half second of holding the mouse somewhere."""
    window.mouse(point_world)
    time.sleep(seconds)
    return window.rows[-500:]


def test_wall_holds_the_ball_and_letting_go_is_free(window):
    curve, _ = tunnel_of_scene(load_checked_scene(SCENE))
    s = float(curve.parameter_at(0.25 * curve.length)[0])
    inside, outward = curve.point(s)[0], curve.frame(s)[1][0]
    beyond = inside + (float(curve.radius(s)[0]) + 0.030) * outward * np.sign(outward[1])
    for share in np.linspace(0.02, 0.25, 12):  # along the tunnel, so that the ball is led and not thrown
        window.mouse(curve.point(curve.parameter_at(share * curve.length))[0])
        time.sleep(0.15)
    for _ in range(4):  # a stall of the machine ramps the force down and asks for a new soft start
        free = held(window, inside, 2.0)
        calm = force_pixels(window)
        pressed = held(window, beyond, 1.5)
        pushed = force_pixels(window)
        if np.all(pressed["state"] == SafetyState.ACTIVE) and np.all(free["state"] == SafetyState.ACTIVE):
            break
    assert np.all(pressed["state"] == SafetyState.ACTIVE), "the loop was never in time for half a second"
    hand = np.linalg.norm(pressed["f_meas"], axis=1)
    assert np.median(pressed["penetration"]) > 0.0
    assert np.all(pressed["penetration"] <= hand / STIFFNESS + 1e-3)
    assert pushed > calm + 200, "the force bar does not rise"
    back = held(window, inside, 1.0)
    assert np.all(back["penetration"] <= 0.0)
    assert np.linalg.norm(back["f_tunnel"][:, 1:], axis=1).max() < 1e-12, "the wall pulls"
    assert np.linalg.norm(back["hip_world"][-1] - inside) < 2e-3 + 1e-3  # and one pixel of the mouse


def test_space_stops_to_zero_force_and_escape_leaves_with_its_own_exit_code(window):
    window.wait("quality", lambda: any("shadow_size" in line for line in window.lines("quality")))
    window.tell("key", "space")
    window.wait("stop", lambda: window.rows["state"][-1] == SafetyState.E_STOP)
    rows = window.rows
    stop = int(np.argmax(rows["stop_word"] > 0.0))
    assert np.all(rows["f_user_world"][stop + 2 :] == 0.0)
    assert window.leave()[0] == 5
    manifest = json.loads((next(window.runs.iterdir()) / "manifest.json").read_text())
    assert (manifest["status"], manifest["summary"]["safety"]["state"]) == ("clean", "E_STOP")


def test_a_machine_that_stalls_pauses_a_person_at_a_mouse_and_goes_on(window):
    """A third of a second is far beyond what latches a stop of a real device."""
    window.wait("force", lambda: window.rows["state"][-1] == SafetyState.ACTIVE)
    stalled = len(window.rows)
    window.process.send_signal(signal.SIGSTOP)
    time.sleep(0.35)
    window.process.send_signal(signal.SIGCONT)
    window.wait("pause", lambda: np.any(window.rows["state"][stalled:] == SafetyState.DEGRADED))
    paused = stalled + int(np.argmax(window.rows["state"][stalled:] == SafetyState.DEGRADED))
    window.wait("force again", lambda: np.any(window.rows["state"][paused:] == SafetyState.ACTIVE))
    assert not np.any(window.rows["state"] >= SafetyState.SAFE_STOP)
    code, answer = window.leave()
    assert code == 0 and answer["safety"]["stops"] == 0 and answer["safety"]["holds"] >= 1
    assert "short hold 1, it goes on by itself: this computer was too busy" in window.terminal


def test_saved_scene_is_taken_while_running_and_a_broken_one_changes_nothing(tmp_path):
    copy = tmp_path / "wavy_tunnel.json"
    copy.write_text(SCENE.read_text())
    with open_window(copy, tmp_path / "runs", 60.0) as window:
        window.wait("frames", lambda: len(window.lines("frame")) > 5)
        document = json.loads(SCENE.read_text())
        parts = {entity["id"]: entity["components"] for entity in document["entities"]}
        parts["tunnel"]["tunnel"]["damping"] = 33.0
        copy.write_text(json.dumps(document))
        window.wait("reload", lambda: any(line["taken"] for line in window.lines("reload")))
        copy.write_text(json.dumps(document)[:-20])
        window.wait("refusal", lambda: any(not line["taken"] for line in window.lines("reload")))
        del parts["ball"]["ball"]
        copy.write_text(json.dumps(document))
        window.wait("another", lambda: sum(not line["taken"] for line in window.lines("reload")) == 2)
        assert window.process.poll() is None
        blocks = window.run.parameters
        assert any(block["tunnel"]["damping"][0] == 33.0 for block in blocks.values())
    assert window.process.returncode == 143
