"""Mutual exclusion of processes that change the files of one folder."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

try:
    import fcntl
except ImportError:  # pragma: no cover - Windows: no locks
    fcntl = None  # type: ignore[assignment]

__all__ = ["alone_in"]

_LOCKS: bool = fcntl is not None


@contextmanager
def alone_in(folder: Path) -> Iterator[None]:
    """Wait until no other process is inside with the same folder; a disk or system without locks lets all in.

    The folder itself is locked, so that nothing is left in it. A thread that is inside must not enter again.

    Raises:
        OSError: The folder is not there.
    """
    if not _LOCKS:
        yield
        return
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        with suppress(OSError):
            fcntl.flock(descriptor, fcntl.LOCK_EX)
        yield
    finally:
        os.close(descriptor)
