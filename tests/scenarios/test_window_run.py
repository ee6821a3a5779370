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
from mimics_app.contracts.loop.haptic import SafetyState
from mimics_app.contracts.system.resources import root
from mimics_app.rendering.haptic.scene_tunnel import tunnel_of_scene
from tests.support.app_window import SIZE, AppWindow, open_window

SCENE = root() / "scenes" / "wavy_tunnel.json"
STIFFNESS = 2000.0
FORCE_BAR = tuple(SIZE[0] * place // 1280 for place in (660, 50, 926, 76))
RISEN = 200 * SIZE[0] * SIZE[1] // (1280 * 720)
"""Coloured pixels by which the bar grows at least."""

HALF_SECOND = 500
"""In ticks."""

PULL = 1.0
"""A change of the hand's pull beyond the noise of its sensor [N]: two ticks after the mouse has moved."""

DRAG_FELT = 0.05
"""More than the drag along the tunnel makes of the ball's last slow millimetre [N]: 4 N s/m of some mm/s."""


def force_pixels(window: AppWindow) -> int:
    """Coloured pixels of the force bar."""
    left, top, right, bottom = FORCE_BAR
    picture = window.picture()[top:bottom, left:right].astype(int)
    return int((picture.max(axis=2) - picture.min(axis=2) > 60).sum())


@pytest.fixture(scope="module")
def window(tmp_path_factory: pytest.TempPathFactory) -> Iterator[AppWindow]:
    """One session: the wall is pressed first, and the last test leaves."""
    with open_window(SCENE, tmp_path_factory.mktemp("window") / "runs", 240.0) as window:
        window.wait("travel", lambda: any(line["state"] == "travel" for line in window.lines("state")))
        yield window


@pytest.fixture(scope="module")
def edited(tmp_path_factory: pytest.TempPathFactory) -> Iterator[AppWindow]:
    """One session of a scene file that may be changed."""
    folder = tmp_path_factory.mktemp("edited")
    scene = folder / SCENE.name
    scene.write_text(SCENE.read_text())
    with open_window(scene, folder / "runs", 240.0) as window:
        window.wait("frames", lambda: len(window.lines("frame")) > 5)
        yield window


def rows_after(window: AppWindow, point_world: np.ndarray, ticks: int) -> Any:
    """Move the mouse from where it rests; so many rows from the tick at which the hand first pulls otherwise.

    Counted in ticks of the loop: how long a busy machine takes to hand the mouse on, and to record, is not in them.
    """
    known = len(window.rows)
    still = np.median(window.rows["f_meas"][-200:], axis=0)
    window.mouse(point_world)

    def first() -> int | None:
        moved = np.flatnonzero(np.linalg.norm(window.rows["f_meas"][known:] - still, axis=1) > PULL)
        return known + int(moved[0]) if len(moved) else None

    def recorded() -> bool:
        start = first()
        return start is not None and len(window.rows) >= start + ticks

    window.wait("motion of the hand", recorded)
    start = first()
    assert start is not None
    return window.rows[start : start + ticks]


def in_time(rows: Any) -> bool:
    """A tick that is held for some milliseconds repeats its force; only a later one takes the force away."""
    return bool(np.all(rows["state"] == SafetyState.ACTIVE))


def press_and_let_go(window: AppWindow, inside: np.ndarray, beyond: np.ndarray) -> tuple[Any, Any, int]:
    """Rows of holding the mouse beyond the wall, rows of having it back inside, and what the force bar gained [px].

    A stall of the machine ramps the force down and requests a new soft start; then once more.
    """
    for _ in range(5):
        window.mouse(inside)
        known = len(window.rows)
        window.wait("rest", lambda known=known: len(window.rows) >= known + 4000)
        calm = force_pixels(window)
        pressed = rows_after(window, beyond, 2000)
        gained = force_pixels(window) - calm
        back = rows_after(window, inside, 1000)
        if in_time(pressed) and in_time(back):
            return pressed, back, gained
    pytest.fail("the loop was never in time for three seconds")


def test_wall_holds_the_ball_and_letting_go_is_free(window):
    """30 mm beyond the wall: held where the hand's force ends; back inside: free, at the cursor in half a second."""
    curve, _ = tunnel_of_scene(load_checked_scene(SCENE))
    s = float(curve.parameter_at(0.25 * curve.length)[0])
    inside, outward = curve.point(s)[0], curve.frame(s)[1][0]
    outward = outward * np.sign(outward[1])
    for share in np.linspace(0.02, 0.25, 12):  # along the tunnel, so that the ball is led and not flung
        window.mouse(curve.point(curve.parameter_at(share * curve.length))[0])
        time.sleep(0.15)
    pressed, back, gained = press_and_let_go(window, inside, inside + (float(curve.radius(s)[0]) + 0.030) * outward)
    steady = pressed[-500:]
    hand = np.linalg.norm(steady["f_meas"], axis=1)
    assert np.all(steady["penetration"] > 0.0)
    assert np.all(steady["penetration"] <= hand / STIFFNESS + 1e-3)
    assert np.median(steady["f_user_world"] @ -outward) > 0.8 * np.median(hand), "what is felt holds the hand back"
    assert gained > RISEN, "the force bar does not rise"
    free = back[HALF_SECOND:]
    felt = free["f_user_world"]
    along = curve.tangent(free["s"])
    across = felt - np.einsum("ij,ij->i", felt, along)[:, None] * along
    assert np.linalg.norm(across, axis=1).max() < 1e-12, "the wall is felt inside"
    assert np.linalg.norm(felt, axis=1).max() < DRAG_FELT, "and nothing but the drag of a ball at rest"
    assert np.linalg.norm(free["hip_world"] - inside, axis=1).max() < 2e-3


def test_space_stops_to_zero_force_and_escape_leaves_with_its_own_exit_code(window):
    window.wait("quality", lambda: any("shadow_size" in line for line in window.lines("quality")))
    window.send("key", "space")
    window.wait("stop", lambda: window.rows["state"][-1] == SafetyState.E_STOP)
    rows = window.rows
    stop = int(np.argmax(rows["stop_word"] > 0.0))
    assert np.all(rows["f_user_world"][stop + 2 :] == 0.0)
    assert window.leave()[0] == 5
    manifest = json.loads((next(window.runs.iterdir()) / "manifest.json").read_text())
    assert (manifest["status"], manifest["summary"]["safety"]["state"]) == ("clean", "E_STOP")


@pytest.mark.fault(id="F20")
def test_saved_scene_is_taken_while_running_and_a_broken_one_changes_nothing(edited):
    document = json.loads(SCENE.read_text())
    parts = {entity["id"]: entity["components"] for entity in document["entities"]}
    parts["tunnel"]["tunnel"]["damping"] = 33.0
    edited.scene.write_text(json.dumps(document))
    edited.wait("reload", lambda: any(line["taken"] for line in edited.lines("reload")))
    edited.scene.write_text(json.dumps(document)[:-20])
    edited.wait("refusal", lambda: any(not line["taken"] for line in edited.lines("reload")))
    del parts["ball"]["ball"]
    edited.scene.write_text(json.dumps(document))
    edited.wait("another", lambda: sum(not line["taken"] for line in edited.lines("reload")) == 2)
    assert edited.process.poll() is None
    rows = edited.run.rows
    assert any(tables.tunnels["damping"][0] == 33.0 for tables in rows.values())


@pytest.mark.fault(id="F05")
def test_a_machine_that_stalls_pauses_a_person_at_a_mouse_and_goes_on(edited):
    """A third of a second is far beyond what latches a stop of a real device."""
    edited.wait("force", lambda: edited.rows["state"][-1] == SafetyState.ACTIVE)
    stalled = len(edited.rows)
    edited.process.send_signal(signal.SIGSTOP)
    time.sleep(0.35)
    edited.process.send_signal(signal.SIGCONT)
    edited.wait("pause", lambda: np.any(edited.rows["state"][stalled:] == SafetyState.DEGRADED))
    paused = stalled + int(np.argmax(edited.rows["state"][stalled:] == SafetyState.DEGRADED))
    edited.wait("force again", lambda: np.any(edited.rows["state"][paused:] == SafetyState.ACTIVE))
    assert not np.any(edited.rows["state"] >= SafetyState.SAFE_STOP)
    code, answer = edited.leave()
    assert code == 0 and answer["safety"]["stops"] == 0 and answer["safety"]["holds"] >= 1
    assert "force paused (1), it comes back: this computer was too busy" in edited.terminal
