"""The tree of errors a person can meet, each with the exit code the command line gives it.

MimicsError                 what happened, and what to do
|- UsageError         2     a command or an argument that cannot be
|- SceneError         3     a scene, glTF, texture or action file; carries every issue found, not only the first
|- DeviceError        4     a device, display or sound output that cannot be had
|- SafetyStop         5     the haptic loop latched SAFE_STOP or E_STOP
`- PartialDataError   6     a recording that ends early or does not agree with itself
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from difflib import get_close_matches

__all__ = [
    "DeviceError",
    "Issue",
    "MimicsError",
    "PartialDataError",
    "SafetyStop",
    "SceneError",
    "UsageError",
    "nearest",
]


@dataclass(frozen=True, slots=True)
class Issue:
    """One fault of one file.

    Attributes:
        file: Path as the user wrote it.
        pointer: JSON pointer (RFC 6901) of the value, or "" for the whole file.
        what: What is wrong, in one sentence.
        fix: What to do, in one sentence; "" when `what` says it already.
    """

    file: str
    pointer: str
    what: str
    fix: str = ""

    def __str__(self) -> str:
        place = f"{self.file}#{self.pointer}: " if self.pointer else f"{self.file}: " if self.file else ""
        return f"{place}{self.what}" + (f"; {self.fix}" if self.fix else "")


class MimicsError(Exception):
    """Root of every error that is told to a person instead of traced."""

    exit_code = 1

    def __init__(self, what: str, fix: str = "") -> None:
        super().__init__(f"{what}; {fix}" if fix else what)
        self.what = what
        self.fix = fix

    @property
    def issues(self) -> list[Issue]:
        """The error as a list of issues, for `--json`."""
        return [Issue("", "", self.what, self.fix)]


class UsageError(MimicsError):
    """A command or an argument that cannot be."""

    exit_code = 2


class SceneError(MimicsError):
    """A file that describes the world is wrong. All faults found are carried at once."""

    exit_code = 3

    def __init__(self, issues: Issue | Iterable[Issue]) -> None:
        self._issues = [issues] if isinstance(issues, Issue) else list(issues)
        super().__init__("\n".join(str(issue) for issue in self._issues))

    @property
    def issues(self) -> list[Issue]:
        """Every fault found, in the order of the files."""
        return self._issues


class DeviceError(MimicsError):
    """A device, a display or a sound output cannot be had.

    Args:
        what: What is wrong.
        fix: What to do.
        file: Scene file that asks for the device, where one does.
        pointer: JSON pointer of the place in it.
    """

    exit_code = 4

    def __init__(self, what: str, fix: str = "", file: str = "", pointer: str = "") -> None:
        super().__init__(what, fix)
        self._place = (file, pointer)

    @property
    def issues(self) -> list[Issue]:
        """The error with the place that asked for the device."""
        return [Issue(*self._place, self.what, self.fix)]


class SafetyStop(MimicsError):
    """The haptic loop latched a stop state and the session ended in it."""

    exit_code = 5


class PartialDataError(MimicsError):
    """A recording ends early, misses a part, or does not agree with its replay."""

    exit_code = 6


def nearest(name: str, known: Iterable[str]) -> str:
    """Return the known name closest in spelling as a hint ("did you mean ..."), or the list of all known ones."""
    names = sorted(known)
    close = get_close_matches(name, names, n=1, cutoff=0.6)
    return f'did you mean "{close[0]}"' if close else "known: " + ", ".join(names)
