"""What becomes of machine code that nobody uses any more: folders of other sources go after 30 days without use.

The date of a folder says when it was used last. A folder to go is renamed first: whoever compiles into it meanwhile
makes it anew and is left alone.
"""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

from mimics_app.contracts.clock import wall_time

__all__ = ["cache_bytes", "mark_used", "sweep"]

_KEPT_S = 30 * 86_400.0
"""How long machine code is kept that nobody uses [s]."""

_MARKED_S = 86_400.0
"""A mark is renewed when it is older [s]: not at every start."""

_GOING = ".going-"


def mark_used(folder: Path) -> None:
    """Note that machine code in `folder` is used, if there is any."""
    with suppress(OSError):
        if _age_s(folder) > _MARKED_S:
            os.utime(folder)


def sweep(base: Path, is_present: Callable[[str], bool]) -> list[Path]:
    """Remove what was not used for 30 days; several processes may do so at one time.

    Args:
        base: Folder of the folders `kernels-*`, which hold one folder for each module and state of its sources.
        is_present: Whether the folder of a module, by its name, belongs to the sources as they are now.

    Returns:
        The folders that are gone.
    """
    gone = []
    for compiler in (each for each in _folders(base) if each.name.startswith(("kernels-", _GOING))):
        gone += [each for each in _folders(compiler) if not is_present(each.name) and _removed(each)]
        if not _folders(compiler) and _removed(compiler):  # also those of versions that kept files without folders
            gone.append(compiler)
    return gone


def cache_bytes(folder: Path) -> int:
    """Size of everything in `folder` [bytes]."""
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
    """Whether `folder` was old, or left over from a sweep that was broken off, and is gone now."""
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
    return wall_time().timestamp() - folder.stat().st_mtime
