"""Decorators of all compiled functions.

Their machine code is kept by compiled/kernel_cache.py, and linked by compiled/kernel_callee.py, with the series of
numba whose private names these use; with any other, functions are compiled in each process by numba's public interface.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from typing import Any, ParamSpec, TypeVar

from numba import njit
from numba.core.errors import NumbaExperimentalFeatureWarning

from mimics_app.compiled.cache_folder import is_known_series

if is_known_series():
    from mimics_app.compiled.kernel_callee import keep_and_link

__all__ = ["kernel", "typed_kernel"]

P = ParamSpec("P")
R = TypeVar("R")

# Plug-ins of the loop are first-class functions: numba is pinned, and the user cannot act on this warning.
warnings.filterwarnings("ignore", "First-class function type", NumbaExperimentalFeatureWarning)

_OPTIONS: dict[str, Any] = {"nogil": True, "error_model": "numpy"}


def kernel(function: Callable[P, R]) -> Callable[P, R]:
    """Compile a function of scalars, arrays, records: no GIL, inf instead of ZeroDivisionError, cached, no fastmath."""
    compiled: Any = njit(**_OPTIONS)(function)
    if is_known_series():
        keep_and_link(compiled, function, _OPTIONS)
    checked: Callable[P, R] = compiled
    return checked


def typed_kernel(signature: object) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """Compile for one fixed signature, so that it can travel as a first-class function (plug-ins of the loop)."""

    def decorate(function: Callable[P, R]) -> Callable[P, R]:
        compiled: Any = kernel(function)
        compiled.compile(signature)
        compiled.disable_compile()
        typed: Callable[P, R] = compiled
        return typed

    return decorate
