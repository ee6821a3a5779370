"""A real window on an X server: what a person does to it arrives as events, and its picture follows its size."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

import pytest

from tests.support.xvfb import display

_ROOT = Path(__file__).parents[2]

_PROGRAM = """
import json, sys, time
from mimics_app.rendering.visual.surfaces.contexts import create_surface
from mimics_app.rendering.visual.surfaces.window import WindowSurface
seen, held, sizes = [], [], []
with create_surface("window", (640, 360), "mimics under test") as surface:
    first = surface.pointer()
    while not (seen and seen[-1] == ["key", "escape", False]):
        for event in surface.poll():
            if not event.repeat and event.kind != "move":
                seen.append([event.kind, event.name, event.pressed])
                held.append(sorted(surface.keys | surface.buttons))
        if not sizes or sizes[-1] != surface.size:
            sizes.append(surface.size)
        surface.framebuffer.use()
        surface.framebuffer.clear(0.2, 0.4, 0.6, 1.0)
        surface.present()
        corner = surface.read_screen()[-4:]
        surface.swap()
        time.sleep(0.005)
    print(json.dumps({"seen": seen, "sizes": sizes, "pointer": surface.pointer(), "first": first,
                      "corner": list(corner), "error": surface.ctx.error}))
"""


def test_keys_mouse_wheel_and_full_screen():
    if shutil.which("xdotool") is None:
        pytest.skip("xdotool is not installed: apt-get install xdotool")
    with display("1280x720x24") as name:
        environment = os.environ | {"DISPLAY": name}

        def tell(*words: str) -> None:
            subprocess.run(["xdotool", *words], env=environment, check=True, timeout=60, stdout=subprocess.DEVNULL)
            time.sleep(0.4)

        window = subprocess.Popen(
            [sys.executable, "-c", _PROGRAM], cwd=_ROOT, env=environment, stdout=subprocess.PIPE, text=True
        )
        try:
            tell("search", "--sync", "--name", "^mimics under test$")
            tell("mousemove", "480", "90")
            tell("keydown", "shift", "keydown", "w", "keyup", "w", "keyup", "shift")
            tell("click", "3")
            tell("click", "4")
            tell("key", "F11")
            tell("mousemove", "320", "540")
            tell("key", "Escape")
            out, _ = window.communicate(timeout=60)
        finally:
            window.kill()
            window.wait(timeout=10)
    report = json.loads(out)
    seen = [tuple(event) for event in report["seen"]]
    expected = [
        ("key", "left_shift", True),
        ("key", "w", True),
        ("key", "w", False),
        ("key", "left_shift", False),
        ("button", "right", True),
        ("button", "right", False),
        ("wheel", "", False),
        ("key", "f11", True),
        ("key", "f11", False),
        ("key", "escape", True),
        ("key", "escape", False),
    ]
    assert [event for event in seen if event[0] not in ("resize", "close")] == expected
    assert report["first"] is None, "before the first motion nobody knows where the pointer is"
    assert report["sizes"] == [[640, 360], [1280, 720]]
    assert report["pointer"] == pytest.approx([-0.5, -0.5], abs=0.01)
    assert report["corner"] == [51, 102, 153, 255], "the picture fills the grown window to its last pixel"
    assert report["error"] == "GL_NO_ERROR"
