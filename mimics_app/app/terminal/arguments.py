"""Readers of the command line's values: each refuses in words what its command cannot do."""

from __future__ import annotations

import os
import unicodedata
from argparse import ArgumentParser, ArgumentTypeError
from collections.abc import Callable
from pathlib import Path

from mimics_app.contracts.display_choice import DISPLAY_KINDS, parse_display
from mimics_app.contracts.errors import UsageError

__all__ = [
    "add_display_argument",
    "file_to_write",
    "frame_count",
    "participant_code",
    "picture_size",
    "positive_time",
    "random_seed",
    "real_number",
    "whole_number",
]

_MOST_DIGITS = 20
"""More are no number that anything here could use, and take long to read."""

_LONGEST_CODE = 60


def whole_number(what: str, allowed: range) -> Callable[[str], int]:
    """A reader of whole numbers.

    Args:
        what: What it is, in the words of the refusal: "number of frames".
        allowed: Those it takes.
    """

    def read(text: str) -> int:
        digits = text.removeprefix("-")
        if not (digits.isascii() and digits.isdigit() and len(digits) <= _MOST_DIGITS and int(text) in allowed):
            raise ArgumentTypeError(f"{text} is no {what} from {allowed.start} to {allowed.stop - 1}")
        return int(text)

    return read


def file_to_write(text: str) -> Path:
    """A file that a command writes: no folder, nor an empty name, which is the working folder's."""
    if not text or os.path.isdir(text):
        raise ArgumentTypeError(f'"{text}" is a folder; name a file to write')
    return Path(text)


def participant_code(text: str) -> str:
    """A person's code in one form, however it was typed: without blanks about it, letters with accents composed."""
    code = unicodedata.normalize("NFC", text).strip()
    if not code.isprintable() or len(code) > _LONGEST_CODE:
        raise ArgumentTypeError(f"a participant code has at most {_LONGEST_CODE} letters, on one line")
    return code


def real_number(what: str, fits: Callable[[float], bool]) -> Callable[[str], float]:
    """A reader of numbers.

    Args:
        what: What it is, with its bounds: "share between 0 and 1".
        fits: Whether one is taken; never asked about a text that is no number.
    """

    def read(text: str) -> float:
        try:
            value = float(text)
        except ValueError:
            value = float("nan")
        if not fits(value):
            raise ArgumentTypeError(f"{text} is no {what}")
        return value

    return read


positive_time = real_number("time between 0 and 1e6 s", lambda seconds: 0.0 < seconds < 1e6)
"""Reads a length of time [s]."""

random_seed = whole_number("seed", range(10**18))
"""Reads a seed of everything random."""


frame_count = whole_number("number of frames", range(1, 100_001))
"""Reads how many frames to draw."""


def picture_size(text: str) -> tuple[int, int]:
    """A size like 1280x720 [px]."""
    width, _, height = text.partition("x")
    if not (width.isdigit() and height.isdigit() and 1 <= int(width) <= 8192 and 1 <= int(height) <= 8192):
        raise ArgumentTypeError(f"{text} is no picture size; write it like 1280x720")
    return int(width), int(height)


def add_display_argument(parser: ArgumentParser) -> None:
    """The option --display."""
    files = {"never": "", "may": "[:FILE]", "must": ":FILE"}
    kinds = ", ".join(kind + files[wants] for kind, wants in DISPLAY_KINDS.items())
    parser.add_argument(
        "--display", type=_display_kind, default="", metavar="KIND[:FILE]", help=f"instead of the scene's: {kinds}"
    )


def _display_kind(text: str) -> str:
    """KIND or KIND:FILE of a display; "" keeps the scene's."""
    if not text:
        return ""
    try:
        return str(parse_display(text))
    except UsageError as error:
        raise ArgumentTypeError(str(error)) from None
