"""Sweep of the kernel cache: folders of outdated sources are removed after 30 days without use.

The modification time of a folder is that of its last use. A folder is renamed before its removal: a process that
compiles into it meanwhile creates it again and is not disturbed.
"""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

from mimics_app.compiled.kernel_sources import file_time_s

__all__ = ["cache_bytes", "mark_used", "sweep"]

_KEPT_S = 30 * 86_400.0
"""Time for which unused machine code is kept [s]."""

_MARKED_S = 86_400.0
"""Age from which the mark of use is renewed [s]."""

_GOING = ".going-"


def mark_used(folder: Path) -> None:
    """Mark the machine code in `folder` as used, if the folder exists."""
    with suppress(OSError):
        if _age_s(folder) > _MARKED_S:
            os.utime(folder)


def sweep(base: Path, is_present: Callable[[str], bool]) -> list[Path]:
    """Remove folders that were not used for 30 days; safe for several processes at the same time.

    Args:
        base: Folder of the folders `kernels-*`, which hold one folder for each module and state of its sources.
        is_present: Whether the folder of a module, by its name, belongs to the present sources.

    Returns:
        The removed folders.
    """
    gone = []
    for compiler in (each for each in _folders(base) if each.name.startswith(("kernels-", _GOING))):
        gone += [each for each in _folders(compiler) if not is_present(each.name) and _removed(each)]
        if not _folders(compiler) and _removed(compiler):  # also of older versions, without subfolders
            gone.append(compiler)
    return gone


def cache_bytes(folder: Path) -> int:
    """Return the total size of the files in `folder` [bytes]."""
    total = 0
    for file in folder.rglob("*"):
        with suppress(OSError):  # another process sweeps
            total += file.stat().st_size if file.is_file() else 0
    return total


def _folders(folder: Path) -> list[Path]:
    with suppress(OSError):
        return [each for each in folder.iterdir() if each.is_dir() and not each.is_symlink()]
    return []


def _removed(folder: Path) -> bool:
    """Remove `folder` if it is old, or left over from an interrupted sweep; return whether it was removed."""
    try:
        if _age_s(folder) <= _KEPT_S:
            return False
        going = folder.with_name(f"{_GOING}{os.getpid()}-{folder.name.removeprefix('.')}")
        folder.rename(going)
    except OSError:  # another process was faster
        return False
    shutil.rmtree(going, ignore_errors=True)
    return True


def _age_s(folder: Path) -> float:
    return file_time_s() - folder.stat().st_mtime
