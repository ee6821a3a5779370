"""Opening of regular files only, so that a FIFO or a device as a file name cannot block a command."""

from __future__ import annotations

import errno
import os
import stat
from contextlib import suppress
from io import BufferedReader
from pathlib import Path

__all__ = ["Stamp", "open_regular", "read_or_nothing", "read_regular", "stamp_of"]

Stamp = tuple[int, int, int]
"""What differs after a file was saved again: its inode, the time of its last change [ns], its size [bytes]."""

_NEVER_WAIT = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_CLOEXEC", 0) | getattr(os, "O_BINARY", 0)


def open_regular(path: str | os.PathLike[str]) -> BufferedReader:
    """Open a regular file (or a link to one) for reading, without blocking.

    Raises:
        FileNotFoundError: The file does not exist.
        IsADirectoryError: It is a folder.
        OSError: It is a pipe, a socket or a device (EINVAL), or not readable.
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
    """Return all bytes of a regular file, or its first `at_most`.

    Raises:
        OSError: See `open_regular`.
    """
    with open_regular(path) as stream:
        return stream.read() if at_most is None else stream.read(at_most)


def stamp_of(path: Path) -> Stamp | None:
    """Return the stamp of a file, None where there is none."""
    with suppress(OSError):
        found = path.stat()
        return found.st_ino, found.st_mtime_ns, found.st_size
    return None


def read_or_nothing(path: Path) -> bytes:
    """Return all bytes of a regular file; b"" if it cannot be read."""
    try:
        return read_regular(path)
    except OSError:
        return b""
