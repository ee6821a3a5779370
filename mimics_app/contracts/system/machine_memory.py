"""Figures that a run of this machine keeps for the next one, in a file beside the compiled kernels.

The file is replaced after every run. One that cannot be read or written is ignored.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Generic, TypeVar

import msgspec

from mimics_app.contracts.system.regular_file import read_regular

__all__ = ["MachineMemory", "machine_file"]

_MAX_KEPT = 500
"""Largest number of entries in a file; the oldest are removed."""

T = TypeVar("T")


class MachineMemory(Generic[T]):
    """Entries of one kind by name.

    Args:
        kind: Type of the entries, one that msgspec reads and writes.
        file: Path of the file; None: nothing is kept. See `machine_file`.
    """

    def __init__(self, kind: type[T], file: Path | None) -> None:
        self._kind, self._file = kind, file

    def find(self, name: str) -> T | None:
        """Return an entry; None where it is unknown."""
        return self._read().get(name)

    def keep(self, name: str, entry: T) -> None:
        """Write an entry in place of the earlier one."""
        if self._file is None:
            return
        known = {other: was for other, was in self._read().items() if other != name}
        newest = dict(list(known.items())[-_MAX_KEPT + 1 :])
        written = self._file.with_suffix(f".{os.getpid()}.part")  # another process may write at the same time
        with suppress(OSError):
            try:
                written.write_bytes(msgspec.json.encode({**newest, name: entry}))
                written.replace(self._file)
            finally:
                written.unlink(missing_ok=True)

    def _read(self) -> Mapping[str, T]:
        if self._file is None:
            return {}
        with suppress(OSError, ValueError, RecursionError):
            return msgspec.json.decode(read_regular(self._file), type=dict[str, self._kind])  # type: ignore[name-defined]
        return {}


def machine_file(subject: str) -> Path | None:
    """Return the file of a subject on this machine; None where no folder can be written."""
    from mimics_app.compiled.cache_folder import cache_folder
    from mimics_app.contracts.system.machine import machine_key

    return None if cache_folder is None else cache_folder.parent / f"{subject}-{machine_key()}.json"
