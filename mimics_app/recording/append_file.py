"""Append-only file that never keeps part of a block."""

from __future__ import annotations

import errno
import os
from pathlib import Path

from mimics_app.contracts.clock import MonotonicClock
from mimics_app.contracts.system.regular_file import open_regular
from mimics_app.recording.run_folder import PRIVATE_FILE

try:
    import fcntl
except ImportError:  # pragma: no cover - Windows: no locks
    fcntl = None  # type: ignore[assignment]

__all__ = ["AppendFile", "is_claimed"]

_sync = getattr(os, "fdatasync", os.fsync)  # macOS has no fdatasync

_CLAIM_TRIES, _CLAIM_EVERY_NS = 100, 1_000_000
"""Attempts at a lock that another process holds, and their period [ns]: `is_claimed` holds it for microseconds."""


class AppendFile:
    """An unbuffered file to which whole blocks are appended.

    Attributes:
        length: Length of the file [bytes].
    """

    def __init__(self, path: Path, *, resume_at: int | None = None) -> None:
        """Create the file, which must not exist; or open it and truncate it to `resume_at` bytes."""
        flags = os.O_WRONLY | os.O_CREAT | getattr(os, "O_BINARY", 0) | (os.O_EXCL if resume_at is None else 0)
        self._descriptor = os.open(path, flags, PRIVATE_FILE)
        self.length = resume_at or 0
        if resume_at is not None:
            os.ftruncate(self._descriptor, resume_at)
        os.lseek(self._descriptor, self.length, os.SEEK_SET)
        self._unsynced = False

    def claim(self) -> None:
        """Lock the file until this process closes it or dies; see `is_claimed`."""
        clock = MonotonicClock()
        for _ in range(0 if fcntl is None else _CLAIM_TRIES):
            try:
                fcntl.flock(self._descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:  # somebody is asking whether it is claimed
                clock.sleep_until_ns(clock.now_ns() + _CLAIM_EVERY_NS)
            except OSError:  # a disk without locks
                return
            else:
                return

    def append(self, data: bytes | bytearray | memoryview) -> None:
        """Append a block.

        Raises:
            OSError: The disk is full or failed; the part of the block that was written is truncated.
        """
        view = memoryview(data)
        try:
            while view:
                written = os.write(self._descriptor, view)
                if written == 0:
                    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
                view = view[written:]
        except OSError:
            self.cut(self.length)
            raise
        self.length += len(data)
        self._unsynced = True

    def cut(self, length: int) -> None:
        """Truncate the file to a length [bytes], at which the next block begins."""
        os.ftruncate(self._descriptor, length)
        os.lseek(self._descriptor, length, os.SEEK_SET)
        self.length = length

    def sync(self) -> None:
        """Flush the file to the medium."""
        if self._unsynced:
            _sync(self._descriptor)
            self._unsynced = False

    def close(self) -> None:
        """Flush the file to the medium and close it."""
        try:
            self.sync()
        finally:
            os.close(self._descriptor)


def is_claimed(path: Path) -> bool:
    """Whether a running process is writing the file, see `AppendFile.claim`; False where that cannot be determined."""
    if fcntl is not None:
        try:
            with open_regular(path) as file:
                fcntl.flock(file, fcntl.LOCK_SH | fcntl.LOCK_NB)
        except OSError as error:
            return isinstance(error, BlockingIOError)
    return False
