"""The tree of errors a person can meet, each with the exit code the command line gives it.

MimicsError                 what happened, and what to do
|- UsageError         2     a command or an argument that cannot be
|- SceneError         3     a scene, glTF, texture or action file, or no run folder; carries every issue found
|- DeviceError        4     a device, display or sound output that cannot be had
|- SafetyStop         5     the haptic loop latched SAFE_STOP or E_STOP
`- PartialDataError   6     a recording that ends early or does not agree with itself
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from difflib import get_close_matches

from mimics_app.contracts.plural import counted

__all__ = [
    "MOST_LISTED",
    "MOST_SOUGHT",
    "DeviceError",
    "Issue",
    "MimicsError",
    "PartialDataError",
    "SafetyStop",
    "SceneError",
    "UsageError",
    "all_sought",
    "first_line",
    "listed_issues",
    "more_issues",
    "nearest",
    "short_text",
]

MOST_LISTED = 100
"""Most issues of one call that are reported one by one; of the rest their number is."""

MOST_SOUGHT = 1000
"""Faults of one file after which no more of them are looked for."""

_LONG_VALUE = re.compile(r"""(?P<mark>["'])(?P<quoted>(?:(?!(?P=mark)).){81,})(?P=mark)|[^\s/"']{81,}""", re.DOTALL)
"""A value of a file, in quotes or without, that is longer than a line should be; a path stays whole."""
_HEAD, _TAIL = 50, 25
"""Characters of such a value that are shown of its beginning and its end."""
_MOST_TEXT = 1000
"""Characters of a text that is long for another reason, such as a list of names."""
_MOST_NAMES = 1000
"""Names that are compared for the nearest one; comparing one takes some microseconds."""


@dataclass(frozen=True, slots=True)
class Issue:
    """One fault of one file. Values of the file that are long are shortened in `what` and `fix`.

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

    def __post_init__(self) -> None:
        object.__setattr__(self, "what", short_text(self.what))
        object.__setattr__(self, "fix", short_text(self.fix))

    def __str__(self) -> str:
        place = f"{self.file}#{short_text(self.pointer)}: " if self.pointer else f"{self.file}: " if self.file else ""
        return f"{place}{self.what}" + (f"; {self.fix}" if self.fix else "")


def listed_issues(issues: Sequence[Issue]) -> tuple[list[Issue], int]:
    """The issues that are reported one by one, each once, and how many more there are."""
    once = list(dict.fromkeys(issues))
    return once[:MOST_LISTED], max(len(once) - MOST_LISTED, 0)


def all_sought(issues: Sequence[Issue]) -> bool:
    """Whether these are all the faults there are; of `MOST_SOUGHT` or more some may never have been looked for."""
    return len(issues) < MOST_SOUGHT


def more_issues(issues: Sequence[Issue]) -> str:
    """How many issues there are beside those that are reported one by one, in words; "" for none."""
    more = listed_issues(issues)[1]
    return f"and {'' if all_sought(issues) else 'at least '}{counted(more, 'more errors')}" if more else ""


class MimicsError(Exception):
    """Root of every error that is reported to a person instead of traced."""

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
    """A file that describes the world is wrong, or a folder is no run folder. All faults found are carried at once."""

    exit_code = 3

    def __init__(self, issues: Issue | Iterable[Issue]) -> None:
        self._issues = [issues] if isinstance(issues, Issue) else list(issues)
        more = more_issues(self._issues)
        super().__init__("\n".join([*map(str, listed_issues(self._issues)[0]), *([more] if more else [])]))

    @property
    def issues(self) -> list[Issue]:
        """Every fault found, in the order of the files."""
        return self._issues


class DeviceError(MimicsError):
    """A device, a display or a sound output cannot be had.

    Args:
        what: What is wrong.
        fix: What to do.
        file: Scene file that requests the device, where one does.
        pointer: JSON pointer of the place in it.
    """

    exit_code = 4

    def __init__(self, what: str, fix: str = "", file: str = "", pointer: str = "") -> None:
        super().__init__(what, fix)
        self._place = (file, pointer)

    @property
    def issues(self) -> list[Issue]:
        """The error with the place that requested the device."""
        return [Issue(*self._place, self.what, self.fix)]


class SafetyStop(MimicsError):
    """The haptic loop latched a stop state and the session ended in it."""

    exit_code = 5


class PartialDataError(MimicsError):
    """A recording ends early, misses a part, or does not agree with its replay."""

    exit_code = 6


def first_line(error: Exception) -> str:
    """What a library says of its failure, or the failure's name where it says nothing."""
    return (str(error) or type(error).__name__).splitlines()[0]


def nearest(name: str, known: Iterable[str]) -> str:
    """Return the known name closest in spelling as a hint ("did you mean ..."), or the list of all known ones.

    Of more than a thousand only some with the same first letter are compared, and none are listed.
    """
    names = list(known)
    few = len(names) <= _MOST_NAMES
    names = sorted(names) if few else [each for each in names[: 10 * _MOST_NAMES] if each[:1] == name[:1]][:_MOST_NAMES]
    close = get_close_matches(name, names, n=1, cutoff=0.6)
    if close:
        return f'did you mean "{close[0]}"'
    return "known: " + ", ".join(names) if few else ""


def short_text(text: str) -> str:
    """A text for people in which values of more than 80 characters are shortened to their beginning and their end."""
    if len(text) <= _HEAD:
        return text
    text = _LONG_VALUE.sub(_shortened, text)
    return text if len(text) <= _MOST_TEXT else f"{text[: _MOST_TEXT - _TAIL]} ... {text[-_TAIL:]}"


def _shortened(found: re.Match[str]) -> str:
    value, mark = found["quoted"] or found[0], found["mark"] or ""
    return f"{mark}{value[:_HEAD]}...{value[-_TAIL:]}{mark}"
