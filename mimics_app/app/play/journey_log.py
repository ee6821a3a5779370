"""Reports of a session to the process that started it: progress, errors, and the person's choice at the end.

They are lines of JSON in a file, which every platform can read while it is written.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from mimics_app.contracts.errors import MimicsError
from mimics_app.contracts.regular_file import read_regular

__all__ = ["JourneyLog", "read_journey"]


class JourneyLog:
    """Writer of the reports.

    Args:
        path: The file; None: no reports are requested.
    """

    def __init__(self, path: Path | None) -> None:
        self._path = path

    @property
    def asked(self) -> bool:
        """Whether a process waits for the person's choice."""
        return self._path is not None

    def doing(self, what: str) -> None:
        """Report the step of the start-up that begins."""
        self._say({"doing": what})

    def shown(self) -> None:
        """Report that the first picture is shown."""
        self._say({"shown": True})

    def trial(self, number: int, count: int, label: str) -> None:
        """Report the trial that begins, from 1, the number of trials, and the name of its condition."""
        self._say({"trial": f"trial {number} of {count}: {label}"})

    def chose(self, following: str) -> None:
        """Report the person's choice: "again", "other" or "leave"."""
        self._say({"next": following})

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
