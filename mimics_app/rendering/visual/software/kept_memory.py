"""Memory of the process, kept for the next draw."""

from __future__ import annotations

import ctypes
import sys

__all__ = ["keep_freed_memory"]

_TRIM_THRESHOLD, _MMAP_THRESHOLD = -1, -3
"""Parameters of glibc's mallopt."""
_KEPT, _MMAP_FROM = 256 << 20, 32 << 20
"""Freed memory that is kept, and size from which memory is mapped instead, glibc's maximum [bytes]."""


def keep_freed_memory() -> None:
    """Let glibc keep freed memory: a software renderer allocates and frees megabytes with every draw.

    Memory that the system maps again each time costs a page fault every 4 KiB. Other C libraries have no such call.
    """
    mallopt = getattr(ctypes.CDLL(None), "mallopt", None) if sys.platform == "linux" else None
    if mallopt is not None:
        mallopt(_TRIM_THRESHOLD, _KEPT)
        mallopt(_MMAP_THRESHOLD, _MMAP_FROM)
