"""The whole way in a real window, by mouse and keyboard alone: launcher, session, result, report, again, another scene.

`pictures` of the test's folder holds what was on the screen at each step.
"""

from __future__ import annotations

import json
import os
import shutil
import signal
import stat
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from mimics_app.app.play.launching import launcher_settings
from mimics_app.rendering.haptic.devices.device_names import SIMULATED
from tests.support.xvfb import display

pytestmark = pytest.mark.slow

_PATIENCE_S = 150.0
_CALIBRATES_S = 1200.0
"""A calibration takes seven minutes, and kernels may be compiled before."""


class Person:
    """Somebody at the screen, who presses keys, points, and looks."""

    def __init__(self, process: subprocess.Popen[bytes], screen: str, folder: Path) -> None:
        self.process, self._screen, self.folder = process, screen, folder
        (folder / "pictures").mkdir()

    def do(self, *words: str) -> None:
        subprocess.run(["xdotool", *words], env={**os.environ, "DISPLAY": self._screen}, check=True, timeout=30)
        time.sleep(0.5)

    def keys(self, *names: str) -> None:
        for name in names:
            self.do("key", name)

    def sees(self, name: str) -> np.ndarray:
        """What is on the screen, kept under a name, shape [height, width, 3]."""
        from PIL import ImageGrab

        picture = ImageGrab.grab(xdisplay=self._screen).convert("RGB")
        picture.save(self.folder / "pictures" / f"{name}.png")
        return np.asarray(picture)

    def wait(self, what: str, condition: Callable[[], bool], press: str = "", patience_s: float = _PATIENCE_S) -> None:
        """Wait for something; a key that nobody heard is pressed again meanwhile, as a person would."""
        end = time.monotonic() + patience_s
        while not condition():
            assert self.process.poll() is None, f"the application ended while waiting for {what}"
            assert time.monotonic() < end, f"no {what}"
            if press:
                self.do("key", press)
            time.sleep(1.0)

    def wait_for_launcher(self) -> None:
        self.wait("launcher", lambda: _share_of(self.sees("wait"), (14, 18, 24)) > 0.2)

    @property
    def begun(self) -> list[str]:
        """Names of the scenes that were begun, oldest first."""
        runs = sorted((self.folder / "runs").glob("*/session.json"))
        return [json.loads(run.read_text())["scene"]["name"] for run in runs]

    def lines(self, kind: str) -> list[dict[str, Any]]:
        """Lines of a kind in the journal of the newest run, as far as it is written."""
        newest = max((self.folder / "runs").glob("*/events.jsonl"))
        whole = [line for line in newest.read_text().splitlines(keepends=True) if line.endswith("\n")]
        return [line for line in map(json.loads, whole) if (line["source"], line["kind"]) == ("app", kind)]

    def has_come_to(self, state: str) -> bool:
        return any(line["state"] == state for line in self.lines("state"))

    @property
    def reports(self) -> int:
        return len(list((self.folder / "runs").glob("*/report.html")))


def _share_of(picture: np.ndarray, colour: tuple[int, int, int]) -> float:
    """How much of the screen has a colour."""
    return float((np.abs(picture.astype(int) - colour).max(axis=-1) <= 2).mean())


@contextmanager
def at_the_launcher(folder: Path) -> Iterator[Person]:
    """`mimics` alone on a screen of its own, with an account and a browser of its own."""
    if shutil.which("xdotool") is None:
        pytest.skip("xdotool is not installed: apt-get install xdotool")
    browser = folder / "browser"
    browser.write_text(f'#!/bin/sh\necho "$1" >> {folder}/opened\n')
    browser.chmod(browser.stat().st_mode | stat.S_IXUSR)
    with display("1280x720x24") as screen:
        environment = {**os.environ, "DISPLAY": screen, "XDG_CONFIG_HOME": str(folder), "BROWSER": f"{browser} %s"}
        process = subprocess.Popen([sys.executable, "-m", "mimics_app"], cwd=folder, env=environment)
        try:
            person = Person(process, screen, folder)
            person.wait_for_launcher()
            yield person
        finally:
            if process.poll() is None:
                process.send_signal(signal.SIGTERM)
                process.wait(timeout=40)


def _on_to(device: str) -> list[str]:
    """Return the keys from the person at the window to a device in who plays."""
    players = launcher_settings()[0].choices
    return ["Right"] * [choice.value for choice in players].index(device)


def test_from_the_launcher_to_the_result_again_and_to_another_scene(tmp_path: Path) -> None:
    with at_the_launcher(tmp_path) as person:
        person.sees("1_launcher")
        person.do("type", "wavy")
        person.keys("Right", *_on_to(SIMULATED))  # to who plays, and on to the simulated patient
        person.keys("Down", "Down")
        person.do("type", "P1")
        person.keys("Down", "Down", "Right")  # one trial
        person.keys("Down", "Down", "Right", "Right")  # no sound
        person.sees("2_settings")
        person.keys("Down", "Down", "Return")
        person.wait("first session", lambda: person.begun == ["wavy_tunnel"])
        person.sees("3_waiting")
        person.wait("first result", lambda: person.reports == 1)
        time.sleep(2.0)
        person.sees("4_result")
        person.wait("report", (tmp_path / "opened").exists, press="r")
        assert (tmp_path / "opened").read_text().strip().endswith("report.html")
        person.wait("second session", lambda: len(person.begun) == 2, press="n")
        person.wait("second result", lambda: person.reports == 2, press="Escape")
        time.sleep(2.0)
        person.sees("5_again")
        person.do("mousemove", "470", "634")  # Another scene, by the mouse
        person.do("click", "1")
        person.wait_for_launcher()
        person.sees("6_launcher_again")
        person.do("type", "tower")
        person.keys("Return")
        person.wait("third session", lambda: len(person.begun) == 3)
        person.wait("keys of the tower", lambda: person.has_come_to("ready"))
        time.sleep(1.0)
        person.sees("7_tower")
        person.wait("tower", lambda: person.has_come_to("travel"), press="Return")
        person.wait("pause", lambda: bool(person.lines("pause")), press="p")
        time.sleep(1.0)
        person.sees("8_paused")
        person.wait("third result", lambda: person.reports == 3, press="Escape")
        time.sleep(2.0)
        person.keys("Escape")
        person.wait_for_launcher()
        person.sees("9_launcher_after_escape")
        person.keys("Escape")
        assert person.process.wait(timeout=40) == 0
    assert person.begun == ["wavy_tunnel", "wavy_tunnel", "tower"]
    headers = [json.loads(path.read_text()) for path in sorted((tmp_path / "runs").glob("*/session.json"))]
    assert [each["settings"]["participant"] for each in headers] == ["P1"] * 3, "it is remembered"
    assert [each["settings"]["trials"] for each in headers] == [1] * 3
    first = json.loads(sorted((tmp_path / "runs").glob("*/manifest.json"))[0].read_text())["summary"]["task"]
    assert (first["completed"], first["trials"]) == (1, 1), "the simulated patient came to the end"


def test_a_left_sided_patient_is_calibrated_plays_and_has_a_report_in_german(tmp_path: Path) -> None:
    """From the participants' page to the report, by keys alone; the simulated patient plays in real time."""
    kept = tmp_path / "participants" / "sub-P07"

    def there(pattern: str, count: int = 1) -> bool:
        return len(list(kept.glob(f"ses-001/{pattern}"))) == count

    def outcomes() -> int:
        return (kept / "ses-001" / "journal.jsonl").read_text().count('"outcome"')

    with at_the_launcher(tmp_path) as person:
        person.do("type", "wavy")
        person.keys("Right", *_on_to(SIMULATED), "Down", "Down", "Down", "Right", "F2")  # German
        time.sleep(2.0)
        person.do("type", "P07")
        person.keys("Return")
        person.wait("participant", kept.exists)
        time.sleep(2.0)
        person.sees("1_participant")
        person.keys("Down", "Down", "Return")
        time.sleep(2.0)
        person.do("type", "61")
        person.keys("Down", "Right", "Right", "Down", "Right", "Right", "Down")  # right-handed, left side affected
        person.sees("2_form")
        person.keys("Return")
        person.wait("answers", (kept / "answers.jsonl").exists)
        time.sleep(2.0)
        person.keys(*["Down"] * 5, "Return")
        time.sleep(2.0)
        person.keys("Right", "Right", "Escape")
        person.wait("language", lambda: '"de"' in (kept.parent / "participants.jsonl").read_text())
        time.sleep(2.0)
        person.keys(*["Up"] * 7, "Return")
        person.wait("calibration", lambda: there("run-000-1/*/report.html"), patience_s=_CALIBRATES_S)
        time.sleep(3.0)
        person.sees("3_calibrated")
        person.wait("what was measured", lambda: outcomes() == 1, press="c")
        time.sleep(3.0)
        person.sees("4_curves")
        person.wait("tunnel", lambda: there("run-001-1"), press="Return")
        person.wait("result", lambda: there("run-001-1/*/report.html"), patience_s=2.0 * _PATIENCE_S)
        time.sleep(3.0)
        person.sees("5_result")
        person.wait("its outcome", lambda: outcomes() == 2, press="c")
        time.sleep(3.0)
        person.keys(*["Down"] * 6, "Return")
        person.wait("report", (tmp_path / "opened").exists)
        person.sees("6_report")
    page = (kept / "participant.html").read_text(encoding="utf-8")
    assert 'lang="de"' in page and "Welliger Tunnel" in page and "Griffkraft" in page and "Glätte" in page
    (calibration,) = map(json.loads, (kept / "calibrations.jsonl").read_text().splitlines())
    measures = {name: each["value"] for name, each in calibration["calibration"]["measures"].items()}
    assert measures["reach_left"] == pytest.approx(0.17, rel=0.1), "as the person of the scene is made"
    assert measures["reach_up"] == pytest.approx(0.10, rel=0.1) and measures["grip"] == pytest.approx(28.0, rel=0.2)
    (header,) = kept.glob("ses-001/run-001-1/*/session.json")
    settings = json.loads(header.read_text())["settings"]
    assert (settings["side"], settings["language"]) == ("left", "de") and settings["fit"].endswith("fit.json")
    (journal,) = kept.glob("ses-001/run-001-1/*/events.jsonl")
    fitted = [line for line in map(json.loads, journal.read_text().splitlines()) if line["kind"] == "fitted"]
    assert {line["name"] for line in fitted} >= {"paths", "squeeze"}


def test_a_wrong_port_is_reported_and_repaired(tmp_path: Path) -> None:
    with at_the_launcher(tmp_path) as person:
        quiet = person.sees("1_launcher")
        person.do("type", "tower")
        person.keys("Right", *_on_to("serial"), "Down")
        person.do("type", "/dev/ttyNONE")
        person.sees("2_wrong_port")
        for _ in range(7):
            person.keys("Down")
        person.keys("Return")

        def reported() -> bool:
            foot = person.sees("3_shown")[680:]
            return _share_of(foot, (255, 158, 140)) > _share_of(quiet[680:], (255, 158, 140)) + 1e-4

        person.wait("word of what went wrong", reported)
        assert not person.begun, "nothing was recorded"
        person.do("type", "tower")
        person.keys("Right", *["Left"] * len(_on_to("serial")))  # back to the mouse
        person.sees("4_repaired")
        for _ in range(7):
            person.keys("Down")
        person.keys("Return")
        person.wait("session", lambda: person.begun == ["tower"])
