"""Opening what people name as a file: regular files only, so that a FIFO or a device cannot hang a command."""

from __future__ import annotations

import errno
import os
import stat
from io import BufferedReader
from pathlib import Path

__all__ = ["open_regular", "read_or_nothing", "read_regular"]

_NEVER_WAIT = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_CLOEXEC", 0) | getattr(os, "O_BINARY", 0)


def open_regular(path: str | os.PathLike[str]) -> BufferedReader:
    """A regular file (or a link to one), opened for reading without ever waiting for somebody to write.

    Raises:
        FileNotFoundError: There is nothing of this name.
        IsADirectoryError: It is a folder.
        OSError: It is a pipe, a socket or a device (EINVAL), or may not be read.
    """
    descriptor = os.open(path, _NEVER_WAIT)
    try:
        mode = os.fstat(descriptor).st_mode
        if stat.S_ISDIR(mode):
            raise IsADirectoryError(errno.EISDIR, "a folder, not a file", os.fspath(path))
        if not stat.S_ISREG(mode):
            raise OSError(errno.EINVAL, "not a regular file (a pipe, a socket or a device)", os.fspath(path))
        return os.fdopen(descriptor, "rb")
    except OSError:
        os.close(descriptor)
        raise


def read_regular(path: str | os.PathLike[str], at_most: int | None = None) -> bytes:
    """All bytes of a regular file, or its first `at_most`.

    Raises:
        OSError: As `open_regular`.
    """
    with open_regular(Path(path)) as stream:
        return stream.read() if at_most is None else stream.read(at_most)


def read_or_nothing(path: Path) -> bytes:
    """All bytes of a regular file; none where it cannot be read."""
    try:
        return read_regular(path)
    except OSError:
        return b""
