"""From a scene to its result, and on: each session is a process of its own, whose window ends with a page of results.

A session lowers the priority of its main thread for good before it makes its picture, and a fault in a driver may end
it: so the next one begins in a fresh process, and whoever opened it is still there.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, fields
from pathlib import Path

from mimics_app.app.play.journey_log import read_journey
from mimics_app.app.settings import RunSettings
from mimics_app.contracts.clock import FRAME_NS, MonotonicClock

__all__ = ["JourneyEnd", "Opening", "play_through", "run_words"]


class Opening:
    """Whoever waits for a session to open; this one only waits."""

    def look(self, doing: str) -> bool:
        """Called once a frame until the first picture, with what is being done; False: the person gave up waiting."""
        return True

    def shown(self) -> None:
        """The session's own picture is there."""


@dataclass(frozen=True, slots=True)
class JourneyEnd:
    """How the last session ended.

    Attributes:
        code: Its exit code.
        other: Whether the person wants another scene.
        error: Why it could not begin or go on, in words; "" where it could.
    """

    code: int
    other: bool
    error: str


_AGAIN, _OTHER = "again", "other"
_LONGEST_END_S = 20.0
"""How long a session that is asked to end may take to close its recording [s]."""


def run_words(settings: RunSettings) -> list[str]:
    """The words of `mimics run` that ask for these settings; what stands at its default is left out."""
    words = [str(settings.scene)]
    defaults = RunSettings(settings.scene)
    for each in fields(RunSettings):
        value = getattr(settings, each.name)
        if each.name in ("scene", "journey") or value == getattr(defaults, each.name):
            continue
        words.append(f"--{each.name.replace('_', '-')}")
        if value is not True:
            words.append("x".join(map(str, value)) if isinstance(value, tuple) else str(value))
    return words


def play_through(settings: RunSettings, opening: Opening | None = None) -> JourneyEnd:
    """Play a scene in a window, again as often as the person wants."""
    while True:
        code, told = _play_once(run_words(settings), opening or Opening())
        if told.get("next") != _AGAIN:
            return JourneyEnd(code, told.get("next") == _OTHER, str(told.get("error", "")))


def _play_once(words: Sequence[str], opening: Opening) -> tuple[int, dict[str, object]]:
    with tempfile.TemporaryDirectory(prefix="mimics-journey-") as folder:
        log = Path(folder) / "journey.jsonl"
        log.touch()
        child = subprocess.Popen([sys.executable, "-m", "mimics_app", "run", *words, "--journey", str(log)])
        try:
            _wait_for_picture(child, log, opening)
            code = child.wait()
        finally:
            _end(child)
        return code, read_journey(log)


def _wait_for_picture(child: subprocess.Popen[bytes], log: Path, opening: Opening) -> None:
    clock = MonotonicClock()
    while child.poll() is None:
        told = read_journey(log)
        if told.get("shown"):
            opening.shown()
            return
        if not opening.look(str(told.get("doing", "Starting"))):
            child.terminate()
        clock.sleep_until_ns(clock.now_ns() + FRAME_NS)


def _end(child: subprocess.Popen[bytes]) -> None:
    """Leave no session behind when its opener is ended."""
    if child.poll() is not None:
        return
    child.terminate()
    try:
        child.wait(_LONGEST_END_S)
    except subprocess.TimeoutExpired:
        child.kill()
