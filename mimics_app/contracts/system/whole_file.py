"""Writing of files that are complete or absent, and whether a folder can be written to."""

from __future__ import annotations

import os
import stat
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TextIO

__all__ = ["private_text", "whole_file", "why_not_writable"]

_PRIVATE = 0o600


def why_not_writable(folder: Path) -> str:
    """Return why a folder cannot be written to, or created; "" where it can. Nothing is left in it."""
    there = next((each for each in (folder, *folder.absolute().parents) if each.exists()), folder)
    if not there.is_dir():
        return f"{there} is not a folder"
    try:
        os.rmdir(tempfile.mkdtemp(dir=there))  # what is asked of the system instead (access) is wrong for /proc
    except OSError as error:
        return error.strerror or "it cannot be written to"
    return ""


@contextmanager
def whole_file(file: Path) -> Iterator[None]:
    """Remove a file that cannot be written to its end, as on a full disk, and name it in the error.

    Raises:
        OSError: As raised inside; where the system gives its number, `filename` is set.
    """
    try:
        yield
    except OSError as error:
        if error.filename is None:  # the system names a file that it cannot open, not one that it cannot fill
            if error.errno:
                error.filename = str(file)
            if file.is_file():  # a device such as /dev/full stays
                file.unlink()
        raise


@contextmanager
def private_text(file: Path) -> Iterator[TextIO]:
    """Open a file to be written anew, as UTF-8 and with line ends as given, that only its user may read.

    Raises:
        OSError: See `whole_file`.
    """
    with whole_file(file):
        descriptor = os.open(file, os.O_WRONLY | os.O_CREAT | os.O_TRUNC | getattr(os, "O_CLOEXEC", 0), _PRIVATE)
        with os.fdopen(descriptor, "w", encoding="utf-8", newline="") as stream:
            if hasattr(os, "fchmod") and stat.S_ISREG(os.fstat(descriptor).st_mode):
                os.fchmod(descriptor, _PRIVATE)  # one that was there before, with other rights
            yield stream
