"""Sequence of sessions of a person at a window: each is a process of its own and ends with a page of results.

A session lowers the priority of its main thread permanently before it opens its picture, and a fault in a driver may
end it. So each session is a new process, and the process that started it survives.
"""

from __future__ import annotations

import signal
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
    """Observer of a session until its first picture; by default it does nothing."""

    def look(self, doing: str) -> bool:
        """Take the present step of the start-up, once a frame; return False to end the session."""
        return True

    def shown(self) -> None:
        """Take note of the session's first picture."""


@dataclass(frozen=True, slots=True)
class JourneyEnd:
    """End of the last session.

    Attributes:
        code: Exit code.
        other: Whether the person chose another scene.
        error: Why it could not begin or continue, in words; "" where it could.
    """

    code: int
    other: bool
    error: str


_AGAIN, _OTHER = "again", "other"
_LONGEST_END_S = 20.0
"""Time-out for a terminated session to close its recording [s]."""


def run_words(settings: RunSettings) -> list[str]:
    """Return the arguments of `mimics run` for these settings, without those at their defaults."""
    words = [str(settings.scene)]
    defaults = RunSettings(settings.scene)
    for each in fields(RunSettings):
        value = getattr(settings, each.name)
        if each.name in ("scene", "journey") or value == getattr(defaults, each.name):
            continue
        word = f"--{each.name.replace('_', '-')}"
        text = "x".join(map(str, value)) if isinstance(value, tuple) else str(value)
        words.append(word if value is True else f"{word}={text}")  # "=": a participant code may begin with a hyphen
    return words


def play_through(settings: RunSettings, opening: Opening | None = None) -> JourneyEnd:
    """Play a scene in a window, and again as long as the person chooses "again"."""
    while True:
        code, noted = _play_once(run_words(settings), opening or Opening())
        if noted.get("next") != _AGAIN:
            return JourneyEnd(code, noted.get("next") == _OTHER, str(noted.get("error", "")))


def _play_once(words: Sequence[str], opening: Opening) -> tuple[int, dict[str, object]]:
    with tempfile.TemporaryDirectory(prefix="mimics-journey-") as folder:
        log = Path(folder) / "journey.jsonl"
        log.touch()
        child = subprocess.Popen([sys.executable, "-m", "mimics_app", "run", *words, "--journey", str(log)])
        try:
            left = not _waited_for_picture(child, log, opening)
            code = child.wait()
        finally:
            _end(child)
        noted = read_journey(log)
        if left:
            return 0, {"next": _OTHER}
        return code, noted if noted.keys() & {"next", "error"} else {**noted, "error": _sudden_end(code)}


def _sudden_end(code: int) -> str:
    """Return why a session ended without a report; "" where it was ended from its terminal."""
    if code >= 0:
        return ""
    how = signal.Signals(-code).name if -code in set(signal.Signals) else f"signal {-code}"
    return f"The session ended suddenly ({how}); what it recorded until then is kept"


def _waited_for_picture(child: subprocess.Popen[bytes], log: Path, opening: Opening) -> bool:
    """Wait for the session's first picture or its end; return False where the person ended the wait."""
    clock = MonotonicClock()
    while child.poll() is None:
        noted = read_journey(log)
        if noted.get("shown"):
            opening.shown()
            return True
        if not opening.look(str(noted.get("doing", "Starting"))):
            child.terminate()
            return False
        clock.sleep_until_ns(clock.now_ns() + FRAME_NS)
    return True


def _end(child: subprocess.Popen[bytes]) -> None:
    """End a session that still runs when the process that started it ends."""
    if child.poll() is not None:
        return
    child.terminate()
    try:
        child.wait(_LONGEST_END_S)
    except subprocess.TimeoutExpired:
        child.kill()
