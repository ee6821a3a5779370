"""A real window on a virtual screen, a real mouse: the wall holds, letting go is free, Space stops, Escape leaves."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from mimics_app.app.scene_loading import load_checked_scene
from mimics_app.contracts.haptic import SafetyState
from mimics_app.contracts.resources import root
from mimics_app.recording.run import Run
from mimics_app.rendering.haptic.scene_tunnel import tunnel_of_scene
from mimics_app.rendering.visual.displays.desktop import desktop_views
from mimics_app.world.scene.file import build_world
from tests.support.xvfb import display

SCENE = root() / "scenes" / "wavy_tunnel.json"
SIZE = (1280, 720)
STIFFNESS = 2000.0
FORCE_BAR = (660, 50, 926, 76)


@dataclass
class Window:
    """The running application: its mouse, its record as far as it is written, its screen."""

    process: subprocess.Popen[str]
    screen: str
    runs: Path

    def mouse(self, point_world: np.ndarray) -> None:
        self.tell("mousemove", *map(str, pixel_of(point_world)))

    def tell(self, *words: str) -> None:
        subprocess.run(["xdotool", *words], env={**os.environ, "DISPLAY": self.screen}, check=True, timeout=20)

    @property
    def rows(self) -> Any:
        return Run.open(next(self.runs.iterdir())).haptic

    def lines(self, kind: str) -> list[dict[str, Any]]:
        return Run.open(next(self.runs.iterdir())).lines_of("app", kind)

    def force_pixels(self) -> int:
        """Coloured pixels of the force bar."""
        from PIL import ImageGrab

        picture = np.asarray(ImageGrab.grab(xdisplay=self.screen).convert("RGB").crop(FORCE_BAR)).astype(int)
        return int((picture.max(axis=2) - picture.min(axis=2) > 60).sum())

    def wait(self, what: str, condition: Callable[[], bool], seconds: float = 60.0) -> None:
        for _ in range(round(seconds / 0.1)):
            assert self.process.poll() is None, f"the application ended while waiting for {what}"
            if condition():
                return
            time.sleep(0.1)
        pytest.fail(f"no {what} within {seconds} s")


def pixel_of(point_world: np.ndarray) -> tuple[int, int]:
    """Where the scene's camera shows a point of the world [px], origin top left."""
    world = build_world(load_checked_scene(SCENE))
    clip = desktop_views(world.cameras[0], SIZE)[0].clip_from_world @ np.append(point_world, 1.0)
    x, y = clip[:2] / clip[3]
    return round((x + 1.0) / 2.0 * SIZE[0]), round((1.0 - y) / 2.0 * SIZE[1])


@pytest.fixture
def window(tmp_path) -> Iterator[Window]:
    if shutil.which("xdotool") is None:
        pytest.skip("xdotool is not installed: apt-get install xdotool")
    with display("1280x720x24") as screen:
        command = [sys.executable, "-m", "mimics_app.app.cli", "run", str(SCENE), "--seconds", "120", "--sound", "off"]
        environment = {**os.environ, "DISPLAY": screen}
        process = subprocess.Popen(
            [*command, "--runs", str(tmp_path / "runs")], env=environment, text=True, stderr=subprocess.PIPE
        )
        window = Window(process, screen, tmp_path / "runs")
        try:
            window.wait("run folder", lambda: any(window.runs.glob("*/haptic.arrows")))
            window.wait("travel", lambda: any(line["state"] == "travel" for line in window.lines("state")))
            yield window
        finally:
            if process.poll() is None:
                process.send_signal(signal.SIGTERM)
            process.wait(timeout=30)
            process.stderr.close()


def held(window: Window, point_world: np.ndarray, seconds: float) -> Any:
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
        calm = window.force_pixels()
        pressed = held(window, beyond, 1.5)
        pushed = window.force_pixels()
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
    window.tell("key", "Escape")
    assert window.process.wait(timeout=40) == 5
    manifest = json.loads((next(window.runs.iterdir()) / "manifest.json").read_text())
    assert (manifest["status"], manifest["summary"]["safety"]["state"]) == ("clean", "E_STOP")


def test_saved_scene_is_taken_while_running_and_a_broken_one_changes_nothing(tmp_path):
    copy = tmp_path / "wavy_tunnel.json"
    copy.write_text(SCENE.read_text())
    with display("1280x720x24") as screen:
        command = [sys.executable, "-m", "mimics_app.app.cli", "run", str(copy), "--seconds", "60", "--sound", "off"]
        process = subprocess.Popen(
            [*command, "--runs", str(tmp_path / "runs")], env={**os.environ, "DISPLAY": screen}, text=True
        )
        window = Window(process, screen, tmp_path / "runs")
        try:
            window.wait("run folder", lambda: any(window.runs.glob("*/haptic.arrows")))
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
            assert process.poll() is None
            blocks = Run.open(next(window.runs.iterdir())).parameters
            assert any(block["tunnel"]["damping"][0] == 33.0 for block in blocks.values())
        finally:
            process.send_signal(signal.SIGTERM)
            assert process.wait(timeout=30) == 143
