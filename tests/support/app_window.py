"""The application in a real window on a virtual screen, with a real mouse: what a person would do there."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from mimics_app.app.scenes.loading import load_checked_scene
from mimics_app.recording.run import Run
from mimics_app.rendering.visual.displays.desktop import desktop_views
from mimics_app.world.scene.file import build_world
from tests.support.xvfb import display

__all__ = ["SIZE", "AppWindow", "open_journey", "open_window", "pixel_of"]

SIZE = (1280, 720)


@dataclass
class AppWindow:
    """The running application: its mouse, its record as far as it is written, its screen, its terminal once left."""

    process: subprocess.Popen[str]
    screen: str
    runs: Path
    scene: Path
    terminal: str = ""

    def mouse(self, point_world: np.ndarray) -> None:
        self.tell("mousemove", *map(str, pixel_of(self.scene, point_world)))

    def tell(self, *words: str) -> None:
        subprocess.run(["xdotool", *words], env={**os.environ, "DISPLAY": self.screen}, check=True, timeout=20)

    @property
    def run(self) -> Run:
        return Run.open(next(self.runs.iterdir()))

    @property
    def rows(self) -> Any:
        return self.run.haptic

    def lines(self, kind: str) -> list[dict[str, Any]]:
        return self.run.lines_of("app", kind)

    def picture(self) -> np.ndarray:
        """What the screen shows, shape [height, width, 3]."""
        from PIL import ImageGrab

        return np.asarray(ImageGrab.grab(xdisplay=self.screen).convert("RGB"))

    def keep(self, name: str) -> None:
        """Put what the screen shows into `pictures` beside the runs."""
        from PIL import Image

        folder = self.runs.parent / "pictures"
        folder.mkdir(exist_ok=True)
        Image.fromarray(self.picture()).save(folder / f"{name}.png")

    def wait(self, what: str, condition: Callable[[], bool], seconds: float = 60.0) -> None:
        for _ in range(round(seconds / 0.1)):
            assert self.process.poll() is None, f"the application ended while waiting for {what}"
            if condition():
                return
            time.sleep(0.1)
        pytest.fail(f"no {what} within {seconds} s")

    def leave(self) -> tuple[int, dict[str, Any]]:
        """(exit code, what --json told) after Escape, twice: the first one asks where a trial is under way."""
        self.tell("key", "Escape")
        time.sleep(1.0)
        if self.process.poll() is None:
            self.tell("key", "Escape")
        told, self.terminal = self.process.communicate(timeout=40)
        return self.process.returncode, json.loads(told)


@lru_cache(maxsize=4)
def _clip_from_world(scene: Path) -> np.ndarray:
    """Of the scene's first camera, shape [4, 4]; a world takes seconds to build."""
    return desktop_views(build_world(load_checked_scene(scene)).cameras[0], SIZE)[0].clip_from_world


def pixel_of(scene: Path, point_world: np.ndarray) -> tuple[int, int]:
    """Where the scene's camera shows a point of the world [px], origin top left."""
    clip = _clip_from_world(scene) @ np.append(point_world, 1.0)
    x, y = clip[:2] / clip[3]
    return round((x + 1.0) / 2.0 * SIZE[0]), round((1.0 - y) / 2.0 * SIZE[1])


@contextmanager
def open_journey(scene: Path, runs: Path, *words: str) -> Iterator[AppWindow]:
    """`mimics run SCENE` as a person opens it: with its page of keys before and its page of results after the play."""
    if shutil.which("xdotool") is None:
        pytest.skip("xdotool is not installed: apt-get install xdotool")
    width, height = SIZE
    with display(f"{width}x{height}x24") as screen:
        command = [sys.executable, "-m", "mimics_app", "run", str(scene), "--sound", "off", "--runs", str(runs), *words]
        process = subprocess.Popen(command, env={**os.environ, "DISPLAY": screen}, text=True)
        window = AppWindow(process, screen, runs, scene)
        try:
            window.wait("run folder", lambda: any(runs.glob("*/haptic.arrows")), seconds=150.0)
            yield window
        finally:
            if process.poll() is None:
                process.send_signal(signal.SIGTERM)
            process.wait(timeout=40)


@contextmanager
def open_window(scene: Path, runs: Path, seconds: float) -> Iterator[AppWindow]:
    """`mimics run SCENE` in a window, recorded under `runs`; ended when left. Skips the test without xdotool, Xvfb."""
    if shutil.which("xdotool") is None:
        pytest.skip("xdotool is not installed: apt-get install xdotool")
    width, height = SIZE
    with display(f"{width}x{height}x24") as screen:
        command = [sys.executable, "-m", "mimics_app.app.cli", "run", str(scene), "--seconds", str(seconds)]
        process = subprocess.Popen(
            [*command, "--sound", "off", "--json", "--runs", str(runs)],
            env={**os.environ, "DISPLAY": screen}, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
        )  # fmt: skip
        window = AppWindow(process, screen, runs, scene)
        try:
            window.wait("run folder", lambda: any(runs.glob("*/haptic.arrows")))
            yield window
        finally:
            if process.poll() is None:
                process.send_signal(signal.SIGTERM)
            process.wait(timeout=30)
            for stream in (process.stdout, process.stderr):
                stream.close()
