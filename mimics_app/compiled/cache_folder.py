"""Folder in which the machine code of compiled functions is kept, and whether the installed numba allows it."""

from __future__ import annotations

import hashlib
import os
import sys
from collections.abc import Callable
from pathlib import Path

import numba

from mimics_app.compiled.private_folder import private_folder

__all__ = ["KNOWN_SERIES", "cache_folder", "compile_listeners", "is_known_series"]

KNOWN_SERIES = "0.68"
"""Series of numba whose private names keep machine code and link callees (docs/compiled.md)."""

_FORM = 4
"""Version of the file format."""


def is_known_series() -> bool:
    """Whether the installed numba is of that series; with another, each process compiles all that it calls."""
    return str(numba.__version__).startswith(f"{KNOWN_SERIES}.")


def _compiler_key() -> str:
    """Return the hash of what affects machine code besides sources; numba's own index has the processor."""
    bounds = os.environ.get("NUMBA_BOUNDSCHECK", "0")
    return hashlib.sha256(f"{numba.__version__} {sys.version_info[:2]} {bounds} {_FORM}".encode()).hexdigest()[:8]


def _choose_cache_folder() -> Path | None:
    base = private_folder()
    return None if base is None else base / f"kernels-{_compiler_key()}"


cache_folder: Path | None = _choose_cache_folder()
"""Folder of the machine code, or None where nothing is writable (then each start compiles again)."""

compile_listeners: list[Callable[[], None]] = []
"""Callbacks after each function that this process compiled and stored."""
