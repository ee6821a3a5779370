"""Sequence of sessions of a person at a window: each is a process of its own and ends with a page of results.

A session lowers the priority of its main thread permanently before it opens its picture, and a fault in a driver may
end it. So each session is a new process, and the process that started it survives, shows the pages before and after
in a window of its own, and takes that window off the desktop while the session shows its picture.
"""

from __future__ import annotations

import signal
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Literal

from mimics_app.app.play.journey_log import JourneyLog, read_journey
from mimics_app.app.settings import RunSettings
from mimics_app.contracts.clock import FRAME_NS, MonotonicClock
from mimics_app.contracts.system.phrases import phrase

__all__ = ["Following", "JourneyEnd", "Pages", "play_through", "play_words", "run_words"]

Following = Literal["again", "other", "leave", "close"]
"""What comes after a session: the same again, another scene, back to where it was started, the end of everything."""


class Pages:
    """What a person sees before and after a session; by default nothing."""

    def wait(self, doing: str, *, leaves: bool) -> bool:
        """Show the present step for a frame; return False where `leaves` and the person does not want to wait."""
        return True

    def place(self) -> list[int]:
        """Return where the pages are on the desktop, see `Surface.place`; [] for nowhere."""
        return []

    def hide(self) -> None:
        """Give way to the picture of the session."""

    def show(self, place: list[int]) -> None:
        """Take the place of the session's window again, see `Surface.place`."""

    def result(self, folder: Path) -> Following:
        """Show the result of a run until the person chooses."""
        return "leave"


@dataclass(frozen=True, slots=True)
class JourneyEnd:
    """End of the last session.

    Attributes:
        code: Exit code.
        following: What the person wants; "leave" where nobody was asked.
        error: Why it could not begin or continue, in words; "" where it could.
    """

    code: int
    following: Following
    error: str = ""


_FRAMES_AWAY = 3
"""Frames between two looks at a session that shows its picture: the processor is left to it."""

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


def play_through(settings: RunSettings, pages: Pages | None = None) -> JourneyEnd:
    """Play a scene in a window, and again as long as the person chooses "again"."""
    shown = pages or Pages()
    while True:
        end = play_words(run_words(settings), shown)
        if end.following != "again":
            return end


def play_words(words: Sequence[str], pages: Pages) -> JourneyEnd:
    """Play a session once, from the arguments of `mimics run`."""
    with tempfile.TemporaryDirectory(prefix="mimics-journey-") as folder:
        log = Path(folder) / "journey.jsonl"
        log.touch()
        child = subprocess.Popen([sys.executable, "-m", "mimics_app", "run", *words, "--journey", str(log)])
        try:
            waited = _Watch(child, log, pages).watch()
            code = child.wait()
        finally:
            _end(child)
        noted = read_journey(log)
    if not waited:
        return JourneyEnd(0, "leave")
    if "run" in noted:
        following: Following = "close" if noted.get("closed") else pages.result(Path(str(noted["run"])))
        return JourneyEnd(code, following)
    if "looked_at" in noted:
        return JourneyEnd(code, "other")
    return JourneyEnd(code, "leave", str(noted.get("error", "")) or _sudden_end(code))


def _sudden_end(code: int) -> str:
    """Return why a session ended without a report; "" where it was ended from its terminal."""
    if code >= 0:
        return ""
    how = signal.Signals(-code).name if -code in set(signal.Signals) else f"signal {-code}"
    return phrase("The session ended suddenly ({how}); what it recorded until then is kept", how=how)


class _Watch:
    """Watches a session from its start to its end, and shows the pages while it has no picture."""

    def __init__(self, child: subprocess.Popen[bytes], log: Path, pages: Pages) -> None:
        self._child, self._log, self._pages = child, log, pages
        self._hidden = self._over = False

    def watch(self) -> bool:
        """Watch until the session ends; return False where the person did not wait for its picture."""
        clock, report = MonotonicClock(), JourneyLog(self._log)
        placed = False
        while self._child.poll() is None:
            noted = read_journey(self._log)
            self._follow(noted, report)
            leaves = not (self._hidden or self._over)
            if not self._hidden and not self._pages.wait(str(noted.get("doing", phrase("Starting"))), leaves=leaves):
                self._child.terminate()
                return False
            if not placed and (place := self._pages.place()):
                placed = True
                report.placed(place)
            clock.sleep_until_ns(clock.now_ns() + (_FRAMES_AWAY if self._hidden else 1) * FRAME_NS)
        if self._hidden:  # it ended without a word
            self._pages.show([])
        return True

    def _follow(self, noted: dict[str, object], report: JourneyLog) -> None:
        """Give way to the session's picture, and take its place once it is over."""
        if noted.get("shown") and not self._hidden and not self._over:
            self._hidden = True
            self._pages.hide()
        place = noted.get("over")
        if isinstance(place, list) and not self._over:
            self._over = True
            if self._hidden:
                self._hidden = False
                self._pages.show(place)
            report.taken()


def _end(child: subprocess.Popen[bytes]) -> None:
    """End a session that still runs when the process that started it ends."""
    if child.poll() is not None:
        return
    child.terminate()
    try:
        child.wait(_LONGEST_END_S)
    except subprocess.TimeoutExpired:
        child.kill()
