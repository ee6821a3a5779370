"""Folder of what this user's processes keep between starts and load as code: no other user can write there."""

from __future__ import annotations

import atexit
import os
import shutil
import stat
import tempfile
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

__all__ = ["private_folder"]

_OPEN_TO_OTHERS = 0o077


def _candidates() -> Iterator[Path]:
    """Yield candidates for the folder, best first."""
    for variable in ("NUMBA_CACHE_DIR", "XDG_CACHE_HOME"):
        if named := os.environ.get(variable):
            yield Path(named) / "mimics"
    with suppress(RuntimeError):  # a container's user may have no home at all
        yield Path.home() / ".cache" / "mimics"
    user = os.getuid() if hasattr(os, "getuid") else os.environ.get("USERNAME", "user")
    yield Path(tempfile.gettempdir()) / f"mimics-{user}"


def _make_private(folder: Path) -> bool:
    """Whether `folder` is a private directory (no link) of this user; it is created or its mode set if need be."""
    try:
        folder.parent.mkdir(parents=True, exist_ok=True)
        with suppress(FileExistsError):
            folder.mkdir(mode=0o700)
        found = folder.lstat()
        if not stat.S_ISDIR(found.st_mode):
            return False
        if hasattr(os, "geteuid"):
            if found.st_uid != os.geteuid():
                return False
            if found.st_mode & _OPEN_TO_OTHERS:
                folder.chmod(0o700)
        return os.access(folder, os.W_OK)
    except OSError:
        return False


def private_folder() -> Path | None:
    """Return the first private candidate, else a new folder for this process and its children, else None."""
    for folder in _candidates():
        if _make_private(folder):
            return folder
    try:
        fresh = Path(tempfile.mkdtemp(prefix="mimics-"))  # mode 0700
    except OSError:
        return None
    os.environ["NUMBA_CACHE_DIR"] = str(fresh)  # shared by children; removed with this process
    atexit.register(shutil.rmtree, fresh, ignore_errors=True)
    return fresh
