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
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest

from mimics_app.app.scenes.loading import load_checked_scene
from mimics_app.app.session.person_input import pointer_plane
from mimics_app.contracts.loop.haptic import SAMPLE
from mimics_app.contracts.ports.input_port import Ray
from mimics_app.contracts.ports.scenario_port import Scenario
from mimics_app.inputs.interaction.window_reach import pointed
from mimics_app.recording.arrow_format import decode_samples
from mimics_app.recording.arrow_scan import read_index
from mimics_app.recording.run import Run
from mimics_app.recording.run_folder import FILES
from mimics_app.rendering.visual.displays.desktop import desktop_views
from mimics_app.world.files.scene.file import build_world
from tests.support.xvfb import display

__all__ = ["SIZE", "AppWindow", "open_journey", "open_window", "pixel_of"]

SIZE = (640, 360)
"""Of the screen and the window [px]: what software draws in it is a quarter of the usual."""

LOOKED_AT = (1280, 720)
"""The same where pages of words are shown and pictures are kept."""


@dataclass
class AppWindow:
    """The running application: its mouse, its record as far as it is written, its screen, its terminal once left."""

    process: subprocess.Popen[str]
    screen: str
    runs: Path
    scene: Path
    size: tuple[int, int] = SIZE
    terminal: str = ""
    blocks: list[bytes] = field(default_factory=list)
    dtype: Any = SAMPLE

    def mouse(self, point_world: np.ndarray) -> None:
        """Move the pointer to where it asks for a point of the robot's plane."""
        middle, stretch = _reach(self.scene, self.size)
        shown = middle + (np.asarray(point_world) - middle) / stretch
        self.send("mousemove", *map(str, pixel_of(self.scene, shown, self.size)))

    def send(self, *words: str) -> None:
        subprocess.run(["xdotool", *words], env={**os.environ, "DISPLAY": self.screen}, check=True, timeout=20)

    @property
    def run(self) -> Run:
        return Run.open(next(self.runs.iterdir()))

    @property
    def rows(self) -> Any:
        """SAMPLE rows that are recorded by now; a block is read once, however often a test looks."""
        folder = next(self.runs.iterdir())
        index = read_index(folder / FILES["index"])
        with (folder / FILES["haptic"]).open("rb") as file:
            for _, offset, length in index[len(self.blocks) :].tolist():
                file.seek(offset)
                records = decode_samples(file.read(length)).records
                self.blocks.append(records.tobytes())
                self.dtype = records.dtype
        return np.frombuffer(b"".join(self.blocks), self.dtype)  # in a fifth of the time of joining records

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

    def wait(self, what: str, condition: Callable[[], bool], seconds: float = 180.0) -> None:
        for _ in range(round(seconds / 0.1)):
            assert self.process.poll() is None, f"the application ended while waiting for {what}"
            if condition():
                return
            time.sleep(0.1)
        pytest.fail(f"no {what} within {seconds} s")

    def leave(self) -> tuple[int, dict[str, Any]]:
        """(exit code, what --json gave) after Escape, twice: the first one asks where a trial is under way."""
        self.send("key", "Escape")
        time.sleep(1.0)
        if self.process.poll() is None:
            self.send("key", "Escape")
        reported, self.terminal = self.process.communicate(timeout=40)
        return self.process.returncode, json.loads(reported)


@lru_cache(maxsize=4)
def _clip_from_world(scene: Path, size: tuple[int, int]) -> np.ndarray:
    """Of the scene's first camera, shape [4, 4]; a world takes seconds to build."""
    return desktop_views(build_world(load_checked_scene(scene)).cameras[0], size)[0].clip_from_world


@lru_cache(maxsize=4)
def _reach(scene: Path, size: tuple[int, int]) -> tuple[np.ndarray, float]:
    """Middle of the pointer's plane, world [m], and how many times as far as shown the pointer leads from it."""
    plane = pointer_plane(load_checked_scene(scene), cast(Scenario, None), lever=False)
    world_from_clip = np.linalg.inv(_clip_from_world(scene, size))

    def ray(right: float, up: float) -> Ray:
        near, far = (world_from_clip @ (right, up, depth, 1.0) for depth in (-1.0, 0.5))
        near, far = near[:3] / near[3], far[:3] / far[3]
        return tuple(near.tolist()), tuple((far - near).tolist())

    place, middle = (0.1, 0.1), np.array(plane.centre)
    shown, led = plane.crossing(ray(*place)), pointed(plane, ray, *place)
    assert shown is not None and led is not None
    return middle, float(np.linalg.norm(np.array(led) - middle) / np.hypot(*shown))


def pixel_of(scene: Path, point_world: np.ndarray, size: tuple[int, int] = SIZE) -> tuple[int, int]:
    """Where the scene's camera shows a point of the world [px], origin top left."""
    clip = _clip_from_world(scene, size) @ np.append(point_world, 1.0)
    x, y = clip[:2] / clip[3]
    return round((x + 1.0) / 2.0 * size[0]), round((1.0 - y) / 2.0 * size[1])


@contextmanager
def open_journey(scene: Path, runs: Path, *words: str) -> Iterator[AppWindow]:
    """`mimics run SCENE` as a person opens it: with its page of keys before and its page of results after the play."""
    if shutil.which("xdotool") is None:
        pytest.skip("xdotool is not installed: apt-get install xdotool")
    with display(f"{LOOKED_AT[0]}x{LOOKED_AT[1]}x24") as screen:
        command = [sys.executable, "-m", "mimics_app", "run", str(scene), "--sound", "off", "--runs", str(runs), *words]
        process = subprocess.Popen(command, env={**os.environ, "DISPLAY": screen}, text=True)
        window = AppWindow(process, screen, runs, scene, LOOKED_AT)
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
        command = [sys.executable, "-m", "tests.support.slow_screen", "run", str(scene), "--seconds", str(seconds)]
        process = subprocess.Popen(
            [*command, "--size", f"{width}x{height}", "--sound", "off", "--json", "--runs", str(runs)],
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
