"""The folder of one run: created once, never overwritten, and only where there is enough disk space."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from mimics_app.contracts.clock import wall_time
from mimics_app.contracts.errors import OutputError
from mimics_app.contracts.system.whole_file import why_not_writable

__all__ = [
    "BYTES_PER_SECOND",
    "FILES",
    "PRIVATE_FILE",
    "PRIVATE_FOLDER",
    "check_parent",
    "create_run_folder",
    "private_files",
    "write_atomically",
]

BYTES_PER_SECOND = 450_000
"""Disk space of one second of a session, compressed: measured 410 kB with the wavy tunnel, half of it the columns."""

PRIVATE_FOLDER, PRIVATE_FILE = 0o700, 0o600
"""Modes of folders and files of a run: a recording can hold health data, so only its user has access."""

_LEAST_FREE = 16 * 1024 * 1024
_TRIES = 8

FILES = {
    "haptic": "haptic.arrows",
    "index": "haptic.arrows.idx",
    "columns": "haptic_columns.arrows",
    "parameters": "parameters.arrows",
    "statics": "haptic_statics.npz",
    "signals": "signals.arrows",
    "events": "events.jsonl",
    "trials": "trials.csv",
    "session": "session.json",
    "manifest": "manifest.json",
    "report": "report.html",
}
"""Name of each file of a run folder."""


def check_parent(parent: Path) -> None:
    """Check that a folder of runs can be created or written to; nothing is left in it.

    Raises:
        OutputError: It cannot.
    """
    why = why_not_writable(parent)
    if why:
        raise _not_here(parent, why)


def create_run_folder(parent: Path, expected_s: float = 0.0) -> Path:
    """Create `parent/<UTC time>_<8 hexadecimal digits>`, which did not exist before.

    Args:
        parent: Folder of runs; created when missing.
        expected_s: Expected length of the session [s]; twice its size must be free.

    Raises:
        OutputError: The folder cannot be created, or there is too little disk space.
    """
    try:
        parent.mkdir(parents=True, exist_ok=True)
        free = shutil.disk_usage(parent).free
        needed = max(_LEAST_FREE, round(2 * expected_s * BYTES_PER_SECOND))
        if free < needed:
            raise OutputError(
                parent,
                f"{free / 1e6:.0f} MB free, a recording of this length needs {needed / 1e6:.0f} MB",
                "free some space or give another folder with --runs DIR",
            )
        return _new_folder(parent)
    except OSError as error:
        raise _not_here(parent, str(error.strerror)) from error


def _not_here(parent: Path, why: str) -> OutputError:
    return OutputError(parent, f"a run folder cannot be created here: {why}", "give another folder with --runs DIR")


def _new_folder(parent: Path) -> Path:
    for _ in range(_TRIES):
        folder = parent / f"{wall_time():%Y%m%dT%H%M%SZ}_{os.urandom(4).hex()}"
        try:
            folder.mkdir(mode=PRIVATE_FOLDER)  # fails when it exists: the O_EXCL of folders
        except FileExistsError:
            continue
        return folder
    raise OutputError(parent, "every name tried for a run folder is in use", "give another folder with --runs DIR")


@contextmanager
def private_files() -> Iterator[None]:
    """Make all files that this process and its children write inside private: pictures, sound and films, too."""
    before = os.umask(0o777 & ~PRIVATE_FOLDER)
    try:
        yield
    finally:
        os.umask(before)


def write_atomically(path: Path, content: bytes) -> None:
    """Replace a file atomically: readers see the old or the new content, also after a crash.

    Only its user has access. A link is replaced, not followed.
    """
    scratch = path.with_name(path.name + ".part")
    try:
        scratch.unlink(missing_ok=True)
        descriptor = os.open(scratch, os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0), PRIVATE_FILE)
        with os.fdopen(descriptor, "wb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        os.replace(scratch, path)
    except OSError as error:
        scratch.unlink(missing_ok=True)
        if error.filename is None and error.errno is not None:  # writing names no file, opening does
            raise OSError(error.errno, error.strerror, str(path)) from error
        raise
