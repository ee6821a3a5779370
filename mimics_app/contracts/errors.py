"""Hierarchy of the errors reported to the user, each with the exit code of the command line.

MimicsError                 what happened, and what to do
|- UsageError         2     invalid command or argument
|- SceneError         3     invalid scene, glTF, texture or action file, or not a run folder; carries all issues
|- OutputError        3     a file or folder cannot be written
|- DeviceError        4     a device, display or sound output is not available
|- SafetyStop         5     the haptic loop latched SAFE_STOP or E_STOP
`- PartialDataError   6     a recording is incomplete or inconsistent
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from os import PathLike, fspath

__all__ = [
    "MOST_LISTED",
    "MOST_SOUGHT",
    "DeviceError",
    "Issue",
    "MimicsError",
    "OutputError",
    "PartialDataError",
    "SafetyStop",
    "SceneError",
    "UsageError",
    "all_sought",
    "counted",
    "first_line",
    "listed_issues",
    "more_issues",
    "nearest",
    "require_choice",
    "require_key",
    "short_text",
    "singular",
]

MOST_LISTED = 100
"""Largest number of issues listed per call; the others are counted."""

MOST_SOUGHT = 1000
"""Number of faults of one file after which its check ends."""

_LONG_VALUE = re.compile(r"""(?P<mark>["'])(?P<quoted>(?:(?!(?P=mark)).){81,})(?P=mark)|[^\s/"']{81,}""", re.DOTALL)
"""Value of a file, quoted or not, of more than 80 characters; paths do not match."""
_LONGEST_NAME = 255
"""Longest name of a file on usual systems; what is longer names none."""
_HEAD, _TAIL = 50, 25
"""Characters shown of the beginning and the end of such a value."""
_MOST_TEXT = 1000
"""Largest length of a text that is long for another reason, such as a list of names."""
_MOST_NAMES = 1000
"""Largest number of names compared for the nearest one, some microseconds each."""
_FEW_NAMES = 5
"""Number of names that are listed unless one is close."""


@dataclass(frozen=True, slots=True)
class Issue:
    """One fault of one file. Values of the file that are long are shortened in `what` and `fix`.

    Attributes:
        file: Path as the user wrote it.
        pointer: JSON pointer (RFC 6901) of the value, or "" for the whole file.
        what: What is wrong, in one sentence.
        fix: What to do, in one sentence; "" if `what` implies it.
    """

    file: str
    pointer: str
    what: str
    fix: str = ""

    def __post_init__(self) -> None:
        if len(self.file) > _LONGEST_NAME:
            parts = self.file.split("/")
            short = [part if len(part) <= _LONGEST_NAME else short_text(part) for part in parts]
            object.__setattr__(self, "file", "/".join(short))
        object.__setattr__(self, "what", short_text(self.what))
        object.__setattr__(self, "fix", short_text(self.fix))

    def __str__(self) -> str:
        place = f"{self.file}#{short_text(self.pointer)}: " if self.pointer else f"{self.file}: " if self.file else ""
        return f"{place}{self.what}" + (f"; {self.fix}" if self.fix else "")


def listed_issues(issues: Sequence[Issue]) -> tuple[list[Issue], int]:
    """Return the distinct issues to list, and the number of the others."""
    once = list(dict.fromkeys(issues))
    return once[:MOST_LISTED], max(len(once) - MOST_LISTED, 0)


def all_sought(issues: Sequence[Issue]) -> bool:
    """Whether these are all the faults: the check of a file ends after `MOST_SOUGHT`."""
    return len(issues) < MOST_SOUGHT


def more_issues(issues: Sequence[Issue]) -> str:
    """Return the number of issues that are not listed, in words; "" for none."""
    more = listed_issues(issues)[1]
    return f"and {'' if all_sought(issues) else 'at least '}{counted(more, 'more errors')}" if more else ""


class MimicsError(Exception):
    """Base class of errors that are reported to the user without a traceback."""

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
    """An invalid command or argument."""

    exit_code = 2


class SceneError(MimicsError):
    """Invalid file of a scene, or a folder that is not a run folder; carries all faults found."""

    exit_code = 3

    def __init__(self, issues: Issue | Iterable[Issue]) -> None:
        self._issues = [issues] if isinstance(issues, Issue) else list(issues)
        more = more_issues(self._issues)
        super().__init__("\n".join([*map(str, listed_issues(self._issues)[0]), *([more] if more else [])]))

    @property
    def issues(self) -> list[Issue]:
        """Every fault found, in the order of the files."""
        return self._issues


class OutputError(MimicsError):
    """A file or folder that a command was to write cannot be written.

    Args:
        path: The file or folder.
        what: What is wrong.
        fix: What to do.
    """

    exit_code = 3

    def __init__(self, path: str | PathLike[str], what: str, fix: str = "") -> None:
        super().__init__(what, fix)
        self.path = fspath(path)

    @property
    def issues(self) -> list[Issue]:
        """The error with its file."""
        return [Issue(self.path, "", self.what, self.fix)]


class DeviceError(MimicsError):
    """A device, a display or a sound output is not available.

    Args:
        what: What is wrong.
        fix: What to do.
        file: Scene file that requests the device, or "".
        pointer: JSON pointer of the request in it.
    """

    exit_code = 4

    def __init__(self, what: str, fix: str = "", file: str = "", pointer: str = "") -> None:
        super().__init__(what, fix)
        self._place = (file, pointer)

    @property
    def issues(self) -> list[Issue]:
        """The error as one issue, with the place that requested the device."""
        return [Issue(*self._place, self.what, self.fix)]


class SafetyStop(MimicsError):
    """The haptic loop latched a stop state and the session ended in it."""

    exit_code = 5


class PartialDataError(MimicsError):
    """A recording ends early, lacks a part, or differs from its replay."""

    exit_code = 6


def first_line(error: Exception) -> str:
    """Return the first line of an error's message, or its type if it has no message."""
    return (str(error) or type(error).__name__).splitlines()[0]


def nearest(name: str, known: Iterable[str]) -> str:
    """Return the known name closest in spelling as a hint ("did you mean ..."), or the list of all known ones.

    Of more than a thousand only some with the same first letter are compared, and none are listed. Up to five are
    listed unless one is close: "rotation" is no help for "position" where "translation" is the third.
    """
    names = list(known)
    few = len(names) <= _MOST_NAMES
    names = sorted(names) if few else [each for each in names[: 10 * _MOST_NAMES] if each[:1] == name[:1]][:_MOST_NAMES]
    close = get_close_matches(name, names, n=1, cutoff=0.65 if len(names) <= _FEW_NAMES else 0.6)
    if close:
        return f'did you mean "{close[0]}"'
    return "known: " + ", ".join(names) if few else ""


def require_choice(name: str, known: Collection[str], what: str) -> None:
    """Raise UsageError where a name that a person gave is not known; `what` is said of it: "experiment"."""
    if name not in known:
        raise UsageError(f'there is no {what} "{name}"', nearest(name, known))


def require_key(name: str, known: Collection[str], what: str) -> None:
    """Raise KeyError where a name that a program gave is not known; `what` is said of it: "node"."""
    if name not in known:
        raise KeyError(f'no {what} "{name}"; {nearest(name, known)}')


def short_text(text: str) -> str:
    """Return a text with values of more than 80 characters shortened to their beginning and end."""
    if len(text) <= _HEAD:
        return text
    text = _LONG_VALUE.sub(_shortened, text)
    return text if len(text) <= _MOST_TEXT else f"{text[: _MOST_TEXT - _TAIL]} ... {text[-_TAIL:]}"


def _shortened(found: re.Match[str]) -> str:
    value, mark = found["quoted"] or found[0], found["mark"] or ""
    return f"{mark}{value[:_HEAD]}...{value[-_TAIL:]}{mark}"


def singular(plural: str) -> str:
    """Return the singular of a regular plural: mesh of meshes, entity of entities, node of nodes; or vertex."""
    if plural == "vertices":
        return "vertex"
    if plural.endswith("ies"):
        return f"{plural[:-3]}y"
    return plural[:-2] if plural.endswith(("shes", "ches", "xes", "sses")) else plural.removesuffix("s")


def counted(number: int, plural: str) -> str:
    """Return a number with its noun, in the singular for 1."""
    return f"{number} {singular(plural) if number == 1 else plural}"
