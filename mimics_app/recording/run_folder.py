"""The folder of one run: made once, never written over, and only where there is room for it."""

from __future__ import annotations

import os
import secrets
import shutil
from pathlib import Path

from mimics_app.contracts.clock import wall_time
from mimics_app.contracts.errors import UsageError

__all__ = ["BYTES_PER_SECOND", "FILES", "create_run_folder", "write_atomically"]

BYTES_PER_SECOND = 630_000
"""What one second of a session takes on disk: 1000 rows of 76 float64, block headers, and the lines of the frames."""

_LEAST_FREE = 16 * 1024 * 1024
_TRIES = 8

FILES = {
    "haptic": "haptic.arrows",
    "index": "haptic.arrows.idx",
    "parameters": "parameters.arrows",
    "statics": "haptic_statics.npz",
    "events": "events.jsonl",
    "trials": "trials.csv",
    "session": "session.json",
    "manifest": "manifest.json",
    "report": "report.html",
}
"""Name of each file of a run folder."""


def create_run_folder(parent: Path, expected_s: float = 0.0) -> Path:
    """Make `parent/<UTC time>_<8 hexadecimal digits>`, which did not exist before.

    Args:
        parent: Where runs are kept; made when missing.
        expected_s: Length the session is expected to have [s]; twice its size must be free.

    Raises:
        UsageError: The folder cannot be made, or there is too little room on its disk.
    """
    try:
        parent.mkdir(parents=True, exist_ok=True)
        free = shutil.disk_usage(parent).free
        needed = max(_LEAST_FREE, round(2 * expected_s * BYTES_PER_SECOND))
        if free < needed:
            raise UsageError(
                f"{parent}: {free / 1e6:.0f} MB free, a recording of this length needs {needed / 1e6:.0f} MB",
                "free some space or give another folder with --runs DIR",
            )
        return _new_folder(parent)
    except OSError as error:
        raise UsageError(f"{parent}: no run folder can be made here: {error.strerror}", "use --runs DIR") from error


def _new_folder(parent: Path) -> Path:
    for _ in range(_TRIES):
        folder = parent / f"{wall_time():%Y%m%dT%H%M%SZ}_{secrets.token_hex(4)}"
        try:
            folder.mkdir()  # fails when it exists: the O_EXCL of folders
        except FileExistsError:
            continue
        return folder
    raise UsageError(f"{parent}: no free name for a run folder", "use --runs DIR")


def write_atomically(path: Path, content: bytes) -> None:
    """Replace a file in one step: readers see the old or the new content, never half of it, also after a crash."""
    scratch = path.with_name(path.name + ".part")
    try:
        with scratch.open("wb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        os.replace(scratch, path)
    except OSError as error:
        scratch.unlink(missing_ok=True)
        if error.filename is None and error.errno is not None:  # writing names no file, opening does
            raise OSError(error.errno, error.strerror, str(path)) from error
        raise
