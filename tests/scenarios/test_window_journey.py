"""From a scene to its result and again, in a real window by keys alone."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from PIL import ImageGrab

from mimics_app.contracts.messages.window_input import InputEvent
from mimics_app.rendering.visual.launcher.result_page import Button, ResultContent, ResultPage
from mimics_app.rendering.visual.surfaces.contexts import create_surface
from mimics_app.rendering.visual.surfaces.headless import read_pixels
from tests.support.xvfb import display

BUTTONS = (Button("again", "Again", "n"), Button("other", "Another scene", "o"), Button("leave", "Close", "c"))
CONTENT = ResultContent("Tunnel", "2 of 3 trials finished.", [("Score", "90")], ("Trial",), [("1",)] * 12, BUTTONS)


@pytest.mark.parametrize(
    ("keys", "choice"),
    [(["enter"], "again"), (["right", "enter"], "other"), (["left", "enter"], "leave"), (["o"], "other"), (["q"], ""),
     (["escape"], "leave")],
)  # fmt: skip
def test_every_button_is_reached_by_keys(keys: list[str], choice: str) -> None:
    with create_surface("egl", (1280, 720)) as surface:
        page = ResultPage(surface, CONTENT)
        page.handle([InputEvent("key", name, True) for name in keys])
        page.draw()
        assert page.choice == choice
        assert read_pixels(surface)[..., :3].std() > 5.0, "there is something to read"


def test_a_click_on_a_button_chooses_it() -> None:
    with create_surface("egl", (1280, 720)) as surface:
        page = ResultPage(surface, CONTENT)
        x, y, width, height = page._button_box(1)
        at = {"x": 2.0 * (x + 0.5 * width) / 1280.0 - 1.0, "y": 2.0 * (y + 0.5 * height) / 720.0 - 1.0}
        page.handle([InputEvent("move", **at), InputEvent("button", "left", True, **at)])
        assert page.choice == "other"


def test_keys_are_shown_and_put_away() -> None:
    content = ResultContent("Tunnel", "", [], (), [], (*BUTTONS, Button("keys", "Keys", "h")), keys=[("Space", "stop")])
    with create_surface("egl", (1280, 720)) as surface:
        page = ResultPage(surface, content)
        page.draw()
        plain = read_pixels(surface).copy()
        page.handle([InputEvent("key", "h", True)])
        page.draw()
        assert (read_pixels(surface) != plain).any() and page.choice == ""
        page.handle([InputEvent("key", "escape", True)])
        page.draw()
        assert (read_pixels(surface) == plain).all() and page.choice == ""
        page.handle([InputEvent("key", "escape", True)])
        assert page.choice == "leave"


def wait(what: str, condition: Callable[[], bool], process: subprocess.Popen[bytes], seconds: float = 150.0) -> None:
    until = time.monotonic() + seconds
    while time.monotonic() < until:
        assert process.poll() is None, f"the application ended while waiting for {what}"
        if condition():
            return
        time.sleep(0.2)
    pytest.fail(f"no {what} within {seconds} s")


def press_until(keys: str, screen: str, what: str, done: Callable[[], bool], process: subprocess.Popen[bytes]) -> None:
    """Keys that are pressed before a window listens are lost: they are pressed again, as a patient person would.

    Escape is asked about once where a trial is under way; pressed again much later it would be meant for the next page.
    """

    def pressed() -> bool:
        words = ["xdotool", "key", "--delay", "300", *keys.split()]
        subprocess.run(words, env={**os.environ, "DISPLAY": screen}, check=True, timeout=20)
        for _ in range(60):
            time.sleep(0.2)
            if done() or process.poll() is not None:
                break
        return done()

    wait(what, pressed, process)


def test_a_session_ends_with_its_result_and_is_played_again(tmp_path: Path) -> None:
    if shutil.which("xdotool") is None:
        pytest.skip("xdotool is not installed: apt-get install xdotool")

    def ended() -> int:
        return len(list(tmp_path.glob("*/report.html")))

    def begun() -> int:
        """Sessions whose task has come to the start of a trial: they have a picture, and hear keys."""
        return sum('"ready"' in journal.read_text() for journal in tmp_path.glob("*/events.jsonl"))

    dark, over = list[float](), threading.Event()

    def watch(screen: str) -> None:
        """Look at the screen, whose ground is black, all the time: once there is a window there always is one."""
        lit = False
        while not over.wait(0.2):
            black = max(high for _, high in ImageGrab.grab(xdisplay=screen).convert("RGB").getextrema()) == 0
            lit = lit or not black
            if lit and black:
                dark.append(time.monotonic())

    words = ["run", "scenes/wavy_tunnel.json", "--sound", "off", "--participant", "P1", "--runs", str(tmp_path)]
    words += ["--size", "640x360"]
    with display("640x360x24") as screen:
        process = subprocess.Popen([sys.executable, "-m", "mimics_app", *words], env={**os.environ, "DISPLAY": screen})
        looking = threading.Thread(target=watch, args=(screen,))
        looking.start()
        try:
            wait("first session", lambda: begun() == 1, process)
            press_until("Escape Escape", screen, "first result", lambda: ended() == 1, process)
            press_until("n", screen, "second session", lambda: begun() == 2, process)
            press_until("Escape Escape", screen, "second result", lambda: ended() == 2, process)
            time.sleep(2.0)
            over.set()
            looking.join()
            assert not dark, "there was no window"
            subprocess.run(["xdotool", "key", "c"], env={**os.environ, "DISPLAY": screen}, check=False, timeout=20)
            assert process.wait(timeout=40) == 0
        finally:
            over.set()
            if process.poll() is None:
                process.send_signal(signal.SIGTERM)
                process.wait(timeout=40)
    headers = [json.loads(path.read_text()) for path in tmp_path.glob("*/session.json")]
    assert [header["settings"]["participant"] for header in headers] == ["P1", "P1"]
    assert all("journey" not in header["settings"] for header in headers)
    assert all(header["live"] for header in headers)
