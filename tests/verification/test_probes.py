"""The probes of this machine, for real: each in a process of its own, whatever happens in it."""

from __future__ import annotations

import subprocess
import sys

import pytest

from mimics_app.app.installation import probes
from mimics_app.app.installation.probes import probe


def test_egl_answers_with_a_context() -> None:
    found = probe("egl")
    assert found["ok"], found
    assert found["version"]
    assert found["renderer"]


def test_scheduler_says_its_recipe_and_leaves_this_process_alone() -> None:
    import os

    before = os.sched_getscheduler(0)
    found = probe("scheduler")
    assert found["ok"], found
    assert found["fifo"] == found["recipe"].startswith("fifo")
    assert os.sched_getscheduler(0) == before


def test_sound_finds_the_library() -> None:
    found = probe("sound")
    assert found["ok"], found
    assert found["hrtf"] is True


def test_window_without_a_display_is_an_answer(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    found = probe("window")
    assert not found["ok"]
    assert "no screen answers" in found["error"]


def _answered_by(monkeypatch: pytest.MonkeyPatch, code: str) -> None:
    real = subprocess.run
    monkeypatch.setattr(
        probes.subprocess, "run", lambda command, **options: real([sys.executable, "-c", code], **options)
    )


def test_driver_that_crashes_is_an_answer(monkeypatch: pytest.MonkeyPatch) -> None:
    _answered_by(monkeypatch, "import os, signal; os.kill(os.getpid(), signal.SIGSEGV)")
    assert probe("egl") == {"ok": False, "error": "the driver crashed (signal 11)"}


def test_driver_that_hangs_is_an_answer(monkeypatch: pytest.MonkeyPatch) -> None:
    _answered_by(monkeypatch, "import time; time.sleep(60)")
    monkeypatch.setattr(probes, "_PATIENCE_S", 0.2)
    found = probe("egl")
    assert not found["ok"]
    assert "no answer" in found["error"]


def test_driver_that_prints_is_not_in_the_way(monkeypatch: pytest.MonkeyPatch) -> None:
    _answered_by(monkeypatch, "print('libGL says hello'); print('{\"ok\": true}')")
    assert probe("egl") == {"ok": True}
