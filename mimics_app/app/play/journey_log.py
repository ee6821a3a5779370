"""Reports of a session to the process that started it: progress, place of its window, errors, and its recording.

They are lines of JSON in a file, which every platform can read while it is written. The process that started it writes
two kinds of lines too: where its own window is, and that it shows it again.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from mimics_app.contracts.clock import MonotonicClock
from mimics_app.contracts.errors import MimicsError
from mimics_app.contracts.system.phrases import phrase
from mimics_app.contracts.system.regular_file import read_regular

__all__ = ["JourneyLog", "read_journey"]

_LONGEST_WAIT_NS = 3_000_000_000
_POLL_NS = 10_000_000


class JourneyLog:
    """Writer of the reports.

    Args:
        path: The file; None: no reports are requested.
    """

    def __init__(self, path: Path | None) -> None:
        self._path = path

    @property
    def asked(self) -> bool:
        """Whether a process shows the pages before and after the session."""
        return self._path is not None

    @property
    def place(self) -> list[int]:
        """Place of that process's window, see `Surface.place`; [] where it is unknown."""
        found = {} if self._path is None else read_journey(self._path)
        place = found.get("place")
        return place if isinstance(place, list) else []

    def doing(self, what: str) -> None:
        """Report the step of the start-up that begins."""
        self._say({"doing": what})

    def shown(self) -> None:
        """Report that the first picture is shown."""
        self._say({"shown": True})

    def over(self, place: list[int], *, closed: bool) -> None:
        """Report that the picture ends, where its window was and whether the person closed it; wait for the pages."""
        self._say({"over": place, "closed": closed, "doing": phrase("Closing the recording")})
        if self._path is None:
            return
        clock = MonotonicClock()
        latest = clock.now_ns() + _LONGEST_WAIT_NS
        while not read_journey(self._path).get("taken") and clock.now_ns() < latest:
            clock.sleep_until_ns(clock.now_ns() + _POLL_NS)

    def placed(self, place: list[int]) -> None:
        """Report, as the process of the pages, where its window is."""
        self._say({"place": place})

    def taken(self) -> None:
        """Report, as the process of the pages, that its window is shown again."""
        self._say({"taken": True})

    def trial(self, number: int, count: int, label: str) -> None:
        """Report the trial that begins, from 1, the number of trials, and the name of its condition."""
        self._say({"trial": f"trial {number} of {count}: {label}"})

    def recorded(self, folder: Path) -> None:
        """Report that the recording is closed and its report written."""
        self._say({"run": str(folder)})

    def looked_at(self) -> None:
        """Report that the scene had no task and was looked at."""
        self._say({"looked_at": True})

    @contextmanager
    def reporting(self) -> Iterator[None]:
        """Report an error inside the context, the reason why the session cannot begin or continue."""
        try:
            yield
        except MimicsError as error:
            first = error.issues[0]
            self._say({"error": "; ".join(part for part in (first.what, first.fix) if part)})
            raise

    def _say(self, line: dict[str, object]) -> None:
        if self._path is not None:
            with self._path.open("a", encoding="utf-8") as file:
                file.write(json.dumps(line) + "\n")


def read_journey(path: Path) -> dict[str, object]:
    """Return the newest value of each key; an incomplete last line is left for the next call."""
    noted: dict[str, object] = {}
    for line in read_regular(path).decode().splitlines(keepends=True):
        if line.endswith("\n"):
            noted |= json.loads(line)
    return noted
