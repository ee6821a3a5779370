"""Converters of command-line values; each rejects a value out of range with a sentence."""

from __future__ import annotations

import os
from argparse import ArgumentParser, ArgumentTypeError, _ArgumentGroup
from collections.abc import Callable, Sequence
from pathlib import Path

from mimics_app.app.settings import PROFILES
from mimics_app.app.terminal.participant import canonical_code, why_no_code
from mimics_app.contracts.errors import OutputError, UsageError
from mimics_app.contracts.ports.display_choice import DISPLAY_KINDS, display_names, kind_of_display, parse_display
from mimics_app.contracts.system.whole_file import why_not_writable

__all__ = [
    "Container",
    "add_display_argument",
    "add_profile_argument",
    "add_size_argument",
    "add_window_size_argument",
    "display_forms",
    "file_to_write",
    "folder_to_write",
    "frame_count",
    "participant_code",
    "path_to_write",
    "picture_file",
    "positive_time",
    "random_seed",
    "real_number",
    "sound_file",
    "whole_number",
]

Container = ArgumentParser | _ArgumentGroup
"""What arguments are added to: a parser, or a group of its arguments in --help."""

_MOST_DIGITS = 20
"""Largest number of digits: larger numbers have no use, and conversion of very long ones takes seconds."""


def whole_number(what: str, allowed: range) -> Callable[[str], int]:
    """Return a converter of whole numbers.

    Args:
        what: Name of the number for the error message, e.g. "number of frames".
        allowed: Numbers that are accepted.
    """

    def read(text: str) -> int:
        digits = text.removeprefix("-")
        if not (digits.isascii() and digits.isdigit() and len(digits) <= _MOST_DIGITS and int(text) in allowed):
            raise ArgumentTypeError(f"{text} is not a {what} from {allowed.start} to {allowed.stop - 1}")
        return int(text)

    return read


def file_to_write(text: str) -> Path:
    """A file that a command writes: no folder, nor an empty name, which is the working folder's.

    Raises:
        OutputError: The folder of a new file cannot be written to, or created.
    """
    if not text or os.path.isdir(text):
        raise ArgumentTypeError(f'"{text}" is a folder; name a file to write')
    return path_to_write(text)


def path_to_write(text: str) -> Path:
    """A file or folder that a command writes.

    Raises:
        OutputError: It is new, and the folder around it cannot be written to, or created.
    """
    path = Path(text)
    if not os.path.exists(text):
        _check_folder(path, path.parent)
    return path


def folder_to_write(text: str) -> Path:
    """A folder that a command writes files into, and creates where it is missing.

    Raises:
        OutputError: It cannot be written to, or created.
    """
    folder = Path(text)
    _check_folder(folder, folder)
    return folder


def _check_folder(output: Path, folder: Path) -> None:
    why = why_not_writable(folder)
    if why:
        raise OutputError(output, f"cannot be written: {why}", "name another folder")


def picture_file(text: str) -> Path:
    """A picture that a command writes, in the format of its ending."""
    return _ending_in(text, (".png", ".jpg", ".jpeg"))


def sound_file(text: str) -> Path:
    """A sound that a command writes."""
    return _ending_in(text, (".wav",))


def _ending_in(text: str, endings: Sequence[str]) -> Path:
    file = file_to_write(text)
    if file.suffix.lower() not in endings:
        raise ArgumentTypeError(f'"{text}" does not end in {" or ".join(endings)}')
    return file


def participant_code(text: str) -> str:
    """Return a participant code in canonical form; a name is refused."""
    code = canonical_code(text)
    why = why_no_code(code)
    if why:
        raise ArgumentTypeError(why)
    return code


def real_number(what: str, fits: Callable[[float], bool]) -> Callable[[str], float]:
    """Return a converter of real numbers.

    Args:
        what: Name of the number with its bounds for the error message, e.g. "share between 0 and 1".
        fits: Whether a number is accepted; false for NaN, which stands for any other text.
    """

    def read(text: str) -> float:
        try:
            value = float(text)
        except ValueError:
            value = float("nan")
        if not fits(value):
            raise ArgumentTypeError(f"{text} is not a {what}")
        return value

    return read


positive_time = real_number("time between 0 and 1e6 s", lambda seconds: 0.0 < seconds < 1e6)
"""Converter of a length of time [s]."""

random_seed = whole_number("seed", range(10**18))
"""Converter of a seed."""

frame_count = whole_number("number of frames", range(1, 100_001))
"""Converter of a number of frames."""


def _picture_size(text: str) -> tuple[int, int]:
    """Return width and height [px] of a size such as 1280x720."""
    width, _, height = text.partition("x")
    if not (width.isdigit() and height.isdigit() and 1 <= int(width) <= 8192 and 1 <= int(height) <= 8192):
        raise ArgumentTypeError(f"invalid picture size {text}; write it like 1280x720")
    return int(width), int(height)


def add_size_argument(parser: Container, what: str = "size of the picture [px]") -> None:
    """Add the option --size with its usual value and a description."""
    parser.add_argument("--size", type=_picture_size, default="1280x720", metavar="WxH", help=what)


def add_profile_argument(
    parser: Container, what: str = "accuracy of physics and picture: draft is cheapest, study most accurate"
) -> None:
    """Add the option of the profile."""
    parser.add_argument("--profile", choices=PROFILES, default="training", help=what)


def add_window_size_argument(parser: Container) -> None:
    """Add the option --size of a picture that may be in a window."""
    what = "size of the picture [px] (default: 1280x720; a window: its last size, else one for the monitor)"
    parser.add_argument("--size", type=_picture_size, metavar="WxH", help=what)


def add_display_argument(parser: Container) -> None:
    """Add the option --display."""
    forms = ", ".join(_form(kind) for kind in DISPLAY_KINDS)
    what = f"instead of the scene's: {forms}, or an installed one"
    parser.add_argument(
        "--display",
        type=_display_kind,
        default="",
        metavar="KIND[:FILE]",
        help=what,
    )


def display_forms() -> dict[str, str]:
    """Return the kinds of display and the form in which --display takes each: KIND, KIND[:FILE] or KIND:FILE."""
    return {kind: _form(kind) for kind in display_names()}


def _form(kind: str) -> str:
    return kind + {"never": "", "may": "[:FILE]", "must": ":FILE"}[kind_of_display(kind).file]


def _display_kind(text: str) -> str:
    """Return KIND or KIND:FILE of a display; "" for the scene's."""
    if not text:
        return ""
    try:
        return str(parse_display(text))
    except UsageError as error:
        raise ArgumentTypeError(str(error)) from None
