"""One decorator for every compiled function, and one folder for its machine code.

numba's own cache looks at the file of the root function only: a changed helper in another file is not seen, a cache
made with bounds checks is taken for one without, and a read-only installation without a writable home cannot be
imported at all. So the folder is ours: its name carries a hash of every source file that may hold a kernel, numba's
version and the bounds-check flag.
"""

from __future__ import annotations

import hashlib
import os
import tempfile
import warnings
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any, ParamSpec, TypeVar

import numba
from numba import njit
from numba.core.errors import NumbaExperimentalFeatureWarning

__all__ = ["cache_folder", "kernel", "typed_kernel"]

P = ParamSpec("P")
R = TypeVar("R")

_KERNEL_LAYERS = ("maths", "contracts", "world", "rendering", "dsp", "learning", "lab")


def _source_digest() -> str:
    package = Path(__file__).resolve().parents[1]
    digest = hashlib.sha256(numba.__version__.encode())
    digest.update(os.environ.get("NUMBA_BOUNDSCHECK", "0").encode())
    for layer in _KERNEL_LAYERS:
        for source in sorted((package / layer).rglob("*.py")):
            text = source.read_bytes()
            if b"kernel" in text:
                digest.update(source.relative_to(package).as_posix().encode())
                digest.update(text)
    return digest.hexdigest()[:16]


def _candidates() -> Iterator[Path]:
    """Where the folder may go, best first."""
    for variable in ("NUMBA_CACHE_DIR", "XDG_CACHE_HOME"):
        if named := os.environ.get(variable):
            yield Path(named)
    with suppress(RuntimeError):  # a container's user may have no home at all
        yield Path.home() / ".cache"
    user = os.getuid() if hasattr(os, "getuid") else os.environ.get("USERNAME", "user")
    yield Path(tempfile.gettempdir()) / f"mimics-{user}"


def _writable_base() -> Path | None:
    for base in _candidates():
        try:
            base.mkdir(parents=True, exist_ok=True)
        except OSError:
            continue
        if os.access(base, os.W_OK):
            return base
    return None


def _choose_cache_folder() -> Path | None:
    base = _writable_base()
    if base is None:
        return None
    folder = base / "mimics" / f"kernels-{_source_digest()}"
    folder.mkdir(parents=True, exist_ok=True)
    return folder


cache_folder: Path | None = _choose_cache_folder()
"""Where machine code is kept, or None where nothing is writable (then each start compiles again)."""

if cache_folder is not None:
    numba.config.CACHE_DIR = str(cache_folder)  # type: ignore[attr-defined]

# Plug-ins of the loop travel as first-class functions: pinned, tested, and nothing a person at the console can act on.
warnings.filterwarnings("ignore", "First-class function type", NumbaExperimentalFeatureWarning)

_OPTIONS: dict[str, Any] = {"nogil": True, "error_model": "numpy", "cache": cache_folder is not None}


def kernel(function: Callable[P, R]) -> Callable[P, R]:
    """Compile a function of scalars, arrays, records: no GIL, inf instead of ZeroDivisionError, cached, no fastmath."""
    compiled: Callable[P, R] = njit(**_OPTIONS)(function)
    return compiled


def typed_kernel(signature: Any) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """Compile for one fixed signature, so that it can travel as a first-class function (plug-ins of the loop)."""

    def decorate(function: Callable[P, R]) -> Callable[P, R]:
        compiled: Callable[P, R] = njit(signature, **_OPTIONS)(function)
        return compiled

    return decorate
