"""Anonymous shared memory, one segment per session.

On Linux it is a memfd: it has no name to leak, needs no resource tracker, and the kernel frees it with its last holder,
also after SIGKILL. Elsewhere it is a temporary file that is unlinked at once.
"""

from __future__ import annotations

import mmap
import os
import tempfile
import weakref
from collections.abc import Callable, Sequence
from multiprocessing import reduction
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

__all__ = ["ArraySpec", "Segment"]

ArraySpec = tuple[str, tuple[int, ...], DTypeLike]
"""(name, shape, dtype) of one array in a segment."""

_CACHE_LINE = 64


class Segment:
    """Shared memory that lives exactly as long as its last holder. Pass it as an argument to a spawned process.

    It has no close method: its arrays may still be in use.
    """

    def __init__(self, size: int, fd: int | None = None) -> None:
        self.size = size
        self._fd = _anonymous_file(size) if fd is None else fd
        weakref.finalize(self, os.close, self._fd)  # the map has its own duplicate
        self._map = mmap.mmap(self._fd, size)

    @property
    def descriptor(self) -> int:
        """File descriptor of the memory in this process."""
        return self._fd

    def __reduce__(self) -> tuple[Callable[..., Segment], tuple[int, Any]]:
        return _attach, (self.size, reduction.DupFd(self._fd))

    @classmethod
    def for_arrays(cls, specs: Sequence[ArraySpec]) -> Segment:
        """Return a zeroed segment large enough for these arrays."""
        return cls(sum(_padded_size(shape, dtype) for _, shape, dtype in specs))

    def arrays(self, specs: Sequence[ArraySpec]) -> dict[str, NDArray[Any]]:
        """Return the arrays by name, each on its own cache line; the same specs give the same layout everywhere."""
        offset = 0
        arrays: dict[str, NDArray[Any]] = {}
        for name, shape, dtype in specs:
            arrays[name] = np.ndarray(shape, dtype, buffer=self._map, offset=offset)
            offset += _padded_size(shape, dtype)
        return arrays


def _attach(size: int, duplicate: Any) -> Segment:
    return Segment(size, duplicate.detach())


def _padded_size(shape: tuple[int, ...], dtype: DTypeLike) -> int:
    size = int(np.prod(shape)) * np.dtype(dtype).itemsize
    return -(-size // _CACHE_LINE) * _CACHE_LINE


def _anonymous_file(size: int) -> int:
    if hasattr(os, "memfd_create"):
        fd = os.memfd_create("mimics")
    else:
        fd, path = tempfile.mkstemp(prefix="mimics-")
        os.unlink(path)
    os.ftruncate(fd, size)
    return fd
