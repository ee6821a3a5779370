"""The first screen, by keyboard, mouse and gamepad: fed with events, and as a window that xdotool drives."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from mimics_app.contracts.errors import UsageError
from mimics_app.contracts.window_input import GamepadState, InputEvent
from mimics_app.rendering.visual.launcher.launcher import Launcher, ScenarioCard
from mimics_app.rendering.visual.surfaces.contexts import create_surface
from mimics_app.rendering.visual.surfaces.headless import read_pixels
from tests.support.xvfb import display

_ROOT = Path(__file__).parents[2]
OPTIONS = {"profile": ["auto", "fast"], "device": ["simulated", "pointer", "replay"], "patient": ["healthy", "severe"]}
CARDS = [ScenarioCard(f"Scene {n}", "Words about it. " * 5, None, Path(f"scene_{n}.json")) for n in range(7)]


@pytest.fixture
def launcher():
    with create_surface("egl", (1280, 720)) as surface:
        yield Launcher(surface, CARDS, OPTIONS)


def keys(*names: str) -> list[InputEvent]:
    return [InputEvent("key", name, True) for name in names]


def place(launcher: Launcher, kind: str, index: int = 0, step: int = 0) -> tuple[float, float]:
    """Pointer coordinates of the middle of a spot."""
    spots = launcher._page.spots(launcher._scroll)
    x, y, width, height = next(s for s in spots if (s.kind, s.index, s.step) == (kind, index, step)).box
    return 2.0 * (x + 0.5 * width) / launcher._hud.width - 1.0, 2.0 * (y + 0.5 * height) / 720.0 - 1.0


def click(launcher: Launcher, kind: str, index: int = 0, step: int = 0) -> None:
    x, y = place(launcher, kind, index, step)
    launcher.handle([InputEvent("move", x=x, y=y), InputEvent("button", "left", True, x=x, y=y)])
    launcher.handle([InputEvent("button", "left", False, x=x, y=y)])


def test_enter_starts_the_first_scene_with_the_defaults(launcher):
    launcher.handle(keys("enter"))
    assert launcher.done and launcher.choice is not None
    assert launcher.choice.scene == Path("scene_0.json")
    assert launcher.choice.settings == {"profile": "auto", "device": "simulated", "patient": "healthy"}


def test_the_keyboard_reaches_everything(launcher):
    launcher.handle(keys("right", "right", "down", "right", "up", "up", "down", "down", "right", "right", "start"))
    launcher.handle(keys("down", "down", "down", "enter"))
    assert launcher.choice.scene == Path("scene_1.json")


def test_the_gamepad_is_as_good_as_the_keyboard(launcher):
    for name in ("dpad_down", "dpad_right", "dpad_right", "dpad_down", "dpad_right", "dpad_right", "start"):
        launcher.handle([InputEvent("pad", name, True), InputEvent("pad", name, False)])
    assert launcher.choice.scene == Path("scene_3.json")
    assert launcher.choice.settings["device"] == "replay"


def test_a_stick_makes_one_step_per_push(launcher):
    surface = launcher._surface
    for push in (0.9, 1.0, 0.7, 0.1, 0.8, 0.0):
        surface.gamepad = GamepadState("pad", {"left_x": 0.0, "left_y": push})
        launcher.handle([])
    launcher.handle([InputEvent("pad", "start", True)])
    assert launcher.choice.scene == Path(f"scene_{2 * launcher._page.columns}.json")


def test_a_mouse_chooses_scrolls_and_starts(launcher):
    click(launcher, "option", 1, 1)
    click(launcher, "option", 0, -1)
    assert launcher.settings == {"profile": "fast", "device": "pointer", "patient": "healthy"}
    launcher.handle([InputEvent("wheel", y=-50.0)])
    click(launcher, "card", 6)
    assert launcher.choice is None, "one click chooses"
    click(launcher, "start")
    assert launcher.choice.scene == Path("scene_6.json")


def test_a_second_click_starts(launcher):
    click(launcher, "card", 1)
    click(launcher, "card", 1)
    assert launcher.choice.scene == Path("scene_1.json")


def test_escape_b_and_the_windows_cross_leave(launcher):
    launcher.handle(keys("escape"))
    assert launcher.left and launcher.choice is None and launcher.done


def test_the_chosen_card_is_scrolled_into_sight(launcher):
    for _ in range(5):
        launcher.handle(keys("down"))
    launcher.draw()
    index = launcher._chosen
    _, y, _, height = launcher._page.card_box(index, launcher._scroll)
    assert index >= 4
    assert y >= 0.0 and y + height <= 720.0


def test_what_is_chosen_is_seen(launcher):
    launcher.draw()
    assert launcher._surface.ctx.error == "GL_NO_ERROR"
    before = read_pixels(launcher._surface)
    assert before[..., :3].std() > 10.0
    launcher.handle(keys("right"))
    launcher.draw()
    after = read_pixels(launcher._surface)
    assert (np.abs(after.astype(int) - before).max(axis=-1) > 20).mean() > 0.002


def test_it_fits_small_and_odd_windows():
    for size in ((640, 480), (1920, 1080), (500, 900)):
        with create_surface("egl", size) as surface:
            launcher = Launcher(surface, CARDS, OPTIONS)
            launcher.draw()
            assert surface.ctx.error == "GL_NO_ERROR"
            for spot in launcher._page.spots(0.0):
                assert spot.box[2] > 0.0


def test_nothing_to_choose_from_is_refused():
    with create_surface("egl", (64, 64)) as surface:
        with pytest.raises(UsageError):
            Launcher(surface, [], OPTIONS)
        with pytest.raises(UsageError):
            Launcher(surface, CARDS, {"profile": []})


_PROGRAM = """
import json, sys
from tests.golden.test_launcher import CARDS, OPTIONS
from mimics_app.rendering.visual.surfaces.contexts import create_surface
from mimics_app.rendering.visual.launcher.launcher import Launcher
with create_surface("window", (1280, 720), "mimics") as surface:
    launcher = Launcher(surface, CARDS, OPTIONS)
    for _ in range(3000):
        for event in (events := surface.poll()):
            print(event.kind, event.name, file=sys.stderr, flush=True)
        launcher.handle(events)
        if launcher.done:
            break
        launcher.draw()
        surface.swap()
    print(json.dumps({"scene": str(launcher.choice.scene), **launcher.choice.settings}))
"""


def test_a_real_window_obeys_mouse_and_keyboard():
    if shutil.which("xdotool") is None:
        pytest.skip("xdotool is not installed: apt-get install xdotool")
    with display() as name:
        environment = os.environ | {"DISPLAY": name}

        def tell(*words: str) -> None:
            subprocess.run(["xdotool", *words], env=environment, check=True, timeout=60, stdout=subprocess.DEVNULL)
            time.sleep(0.3)  # a frame of the software renderer between two inputs

        window = subprocess.Popen(
            [sys.executable, "-c", _PROGRAM], cwd=_ROOT, env=environment, stdout=subprocess.PIPE, text=True
        )
        try:
            tell("search", "--sync", "--name", "^mimics$")
            time.sleep(1.0)
            tell("mousemove", "1215", "223")  # the right arrow of the device, second of the settings
            tell("click", "1")
            tell("mousemove", "100", "250")  # the first card
            tell("key", "Right")
            tell("key", "Return")
            out, _ = window.communicate(timeout=60)
        finally:
            window.kill()
            window.wait(timeout=10)
    assert json.loads(out) == {"scene": "scene_1.json", "profile": "auto", "device": "pointer", "patient": "healthy"}
