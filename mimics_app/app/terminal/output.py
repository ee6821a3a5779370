"""Answers of commands: lines of text, or with `--json` exactly one object on stdout and everything else on stderr.

While a command runs with `--json`, stdout itself (the Python stream and file descriptor 1, which libraries and child
processes write to) leads to stderr; only `write_object` reaches the real one.
"""

from __future__ import annotations

import json
import math
import os
import sys
from argparse import Namespace
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, redirect_stdout, suppress
from functools import lru_cache
from pathlib import PurePath
from typing import Any, TextIO

from mimics_app.contracts.errors import Issue, all_sought, listed_issues, more_issues, short_text
from mimics_app.contracts.system.regular_file import read_regular

__all__ = [
    "answer",
    "applicable",
    "errors_of",
    "finite",
    "issue_lines",
    "line_and_column",
    "object_written",
    "one_line",
    "reserved_stdout",
    "say",
    "with_line",
    "write_object",
]


_MOST_CHARACTERS = 400_000
"""Largest length of a searched file [characters]: the search in longer ones takes too long."""


class _ObjectStream:
    """Stream of the one JSON object of a command, and whether it was written."""

    def __init__(self) -> None:
        self.stream: TextIO | None = None
        self.written = False


_target = _ObjectStream()


@contextmanager
def reserved_stdout() -> Iterator[None]:
    """Reserve stdout for `write_object`; everything else written to stdout inside the context goes to stderr."""
    real = sys.stdout
    real.flush()
    saved = _divert_descriptor(real)
    try:
        _target.stream = real if saved is None else os.fdopen(saved, "w", encoding="utf-8")
        _target.written = False
        with redirect_stdout(sys.stderr):
            yield
    finally:
        stream, _target.stream = _target.stream, None
        if saved is not None and stream is not None:
            _flush_libraries()
            with suppress(OSError):  # the reader is gone or the disk full, as `write_object` has reported
                sys.stderr.flush()
                stream.flush()
            os.dup2(saved, 1)
            with suppress(OSError):
                stream.close()


def _flush_libraries() -> None:
    """Write what C libraries have printed and still hold, which would else follow the object when the process ends."""
    if "ctypes" in sys.modules:  # no library of C prints before it is loaded, and loading one imports ctypes
        import ctypes

        with suppress(AttributeError, OSError, TypeError):
            ctypes.CDLL(None).fflush(None)


def _divert_descriptor(real: TextIO) -> int | None:
    """Redirect descriptor 1 to stderr and return a copy of it; None where stdout has no descriptor (in a test)."""
    try:
        if real.fileno() != 1 or sys.stderr.fileno() != 2:
            return None
    except (OSError, ValueError):
        return None
    saved = os.dup(1)
    os.dup2(2, 1)
    return saved


def say(text: str) -> None:
    """Write a line of text for the person at the terminal, to stderr."""
    sys.stderr.write(f"mimics: {one_line(short_text(text))}\n")


def say_nothing(_: object) -> None:
    """Discard a line, where no person is present, or the error of a process that a signal ends."""


def answer(args: Namespace, data: Mapping[str, Any], lines: Iterable[str]) -> None:
    """Answer a command: with `--json` one object, else lines of text on stdout.

    Args:
        args: Arguments of the command.
        data: Object of `--json`, see `write_object`.
        lines: Lines of text, without their ends; not computed with `--json` where they are generated.
    """
    if args.json:
        write_object(args.command, data)
    else:
        sys.stdout.writelines(f"{one_line(line)}\n" for line in lines)


def write_object(command: str, data: Mapping[str, Any], *, schema: str = "", version: int = 1) -> None:
    """Write the answer of a command as one JSON object, `schema` and `command` first.

    Args:
        command: Name of the command.
        data: The rest of the object; numpy scalars and arrays, paths and tuples are taken, numbers that are not finite
            become null.
        schema: Name of the schema where it is not the command's; it is written as `mimics.SCHEMA/VERSION`.
        version: Raised when a key changes its meaning.

    Raises:
        RuntimeError: A second object in one call of the command line.
    """
    if _target.written and _target.stream is not None:
        raise RuntimeError(f"command {command!r} wrote a second JSON object")
    _target.written = True
    answer = {"schema": f"mimics.{schema or command}/{version}", "command": command, **finite(data)}
    stream = _target.stream or sys.stdout
    stream.write(json.dumps(answer, allow_nan=False, ensure_ascii=False) + "\n")
    stream.flush()


def object_written() -> bool:
    """Whether this call of the command line has written its object."""
    return _target.written


def errors_of(issues: Sequence[Issue]) -> dict[str, Any]:
    """Return issues as keys of a JSON object: `errors`, the first ones, and `more_errors`, the number of any others.

    `more_errors_at_least` is true where the search for errors ended early.
    """
    first, more = listed_issues(issues)
    rows = [{"file": i.file, "pointer": i.pointer, "what": i.what, "fix": i.fix, **_place(i)} for i in first]
    counts: dict[str, Any] = {"more_errors": more} if more else {}
    if more and not all_sought(issues):
        counts["more_errors_at_least"] = True
    return {"errors": rows, **counts}


_CONTROLS = {code: f"\\x{code:02x}" for code in (*range(9), *range(11, 32), *range(127, 160))}
_CONTROLS |= {code: f"\\u{code:04x}" for code in (0x200E, 0x200F, *range(0x2028, 0x202F), *range(0x2066, 0x206A))}
"""What a name from a file or an argument must not do to a terminal: colour it, clear it, retitle it, turn its text."""
_IN_A_LINE = _CONTROLS | {ord("\n"): "\\n"}


def one_line(text: str) -> str:
    """Return a text as one line for a terminal, without what would control the terminal."""
    return text.translate(_IN_A_LINE)


def issue_lines(issues: Sequence[Issue]) -> list[str]:
    """Return issues as lines for a terminal: the first ones, and the number of the rest."""
    more = more_issues(issues)
    lines = [f"mimics: {with_line(issue).translate(_CONTROLS)}\n" for issue in listed_issues(issues)[0]]
    return [*lines, f"mimics: {more}\n"] if more else lines


def line_and_column(issue: Issue) -> tuple[int, int] | None:
    """Return line and column, 1 first, of the value of a fault, or of the innermost existing value around it.

    None where the fault has no pointer, or its file is no readable JSON text.
    """
    text = _text_of(issue.file) if issue.pointer else ""
    if not text:
        return None
    from mimics_app.world.files.reading.json_spans import find_span

    steps = [step.replace("~1", "/").replace("~0", "~") for step in issue.pointer.split("/")[1:]]
    while (span := find_span(text, steps)) is None:
        steps.pop()
    before = text[: span[0]]
    return before.count("\n") + 1, span[0] - before.rfind("\n")


@lru_cache(maxsize=4)
def _text_of(file: str) -> str:
    """Return the text of a JSON file; "" for any other file."""
    try:
        text = read_regular(file, _MOST_CHARACTERS + 1).decode("utf-8-sig")
        if not text or len(text) > _MOST_CHARACTERS:
            return ""
        json.loads(text)
    except (OSError, ValueError, RecursionError):
        return ""
    return text


def _place(issue: Issue) -> dict[str, int]:
    """Return line and column of an issue where they are known."""
    found = line_and_column(issue)
    return {} if found is None else {"line": found[0], "column": found[1]}


def with_line(issue: Issue) -> str:
    """Return an issue in one line, with line and column where they are known."""
    found = line_and_column(issue)
    return f"{issue}" if found is None else f"{issue} (line {found[0]}, column {found[1]})"


def finite(value: object) -> Any:
    """Return a value in the types of JSON; NaN and infinities become None.

    Raises:
        TypeError: A value is neither a container, a number, a text, a path nor an array.
    """
    if isinstance(value, float):  # numpy.float64 is one too
        return float(value) if math.isfinite(value) else None
    if isinstance(value, str):
        return _printable(value)
    if value is None or isinstance(value, (bool, int)):
        return value
    if isinstance(value, Mapping):
        return {_printable(str(key)): finite(item) for key, item in value.items()}
    if isinstance(value, (list, tuple, set, frozenset)):
        return [finite(item) for item in value]
    if isinstance(value, PurePath):
        return _printable(str(value))
    if hasattr(value, "tolist"):  # numpy, without importing it
        return finite(value.tolist())
    raise TypeError(f"{type(value).__name__} cannot be written as JSON")


def applicable(data: object) -> Any:
    """Return data without the keys whose value does not apply: None, NaN or infinite. Lists keep their length."""
    if isinstance(data, Mapping):
        return {key: applicable(value) for key, value in data.items() if _applies(value)}
    return [applicable(value) for value in data] if isinstance(data, (list, tuple)) else data


def _applies(value: object) -> bool:
    return math.isfinite(value) if isinstance(value, float) else value is not None


def _printable(text: str) -> str:
    """Return a text without surrogates, which file names with bytes that are not UTF-8 have."""
    return text.encode("utf-8", "backslashreplace").decode()
