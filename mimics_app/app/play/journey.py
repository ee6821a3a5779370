"""From a scene to its result, and on: each session is a process of its own, whose window ends with a page of results.

A session lowers the priority of its main thread for good before it makes its picture, and a fault in a driver may end
it: so the next one begins in a fresh process, and whoever opened it is still there.
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
"""Time-out for a session to close its recording when it is told to end [s]."""


def run_words(settings: RunSettings) -> list[str]:
    """The words of `mimics run` that request these settings; what stands at its default is left out."""
    words = [str(settings.scene)]
    defaults = RunSettings(settings.scene)
    for each in fields(RunSettings):
        value = getattr(settings, each.name)
        if each.name in ("scene", "journey") or value == getattr(defaults, each.name):
            continue
        word = f"--{each.name.replace('_', '-')}"
        text = "x".join(map(str, value)) if isinstance(value, tuple) else str(value)
        words.append(word if value is True else f"{word}={text}")  # a code may begin with a hyphen
    return words


def play_through(settings: RunSettings, opening: Opening | None = None) -> JourneyEnd:
    """Play a scene in a window, again as often as the person wants."""
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
    """Wait until the session's own picture is there, or it has ended; False: the person gave up and it is ending."""
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
    """Leave no session behind when its opener is ended."""
    if child.poll() is not None:
        return
    child.terminate()
    try:
        child.wait(_LONGEST_END_S)
    except subprocess.TimeoutExpired:
        child.kill()
