"""Decorators of all compiled functions; their machine code is cached by compiled/kernel_cache.py."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from functools import cache
from typing import Any, ParamSpec, TypeVar

from numba import njit
from numba.core.errors import NumbaExperimentalFeatureWarning, TypingError
from numba.core.types import IntEnumMember, unliteral

from mimics_app.compiled.kernel_cache import enable_cache
from mimics_app.compiled.kernel_callee import callee_of

__all__ = ["kernel", "typed_kernel"]

P = ParamSpec("P")
R = TypeVar("R")

# Plug-ins of the loop are first-class functions: numba is pinned, and the user cannot act on this warning.
warnings.filterwarnings("ignore", "First-class function type", NumbaExperimentalFeatureWarning)

_OPTIONS: dict[str, Any] = {"nogil": True, "error_model": "numpy"}
_unliteral: Callable[[Any], Any] = unliteral


def _plain(kind: Any) -> Any:
    """Return int64 for the type of the constant 7 and of a member of an IntEnum; other types unchanged."""
    return kind.dtype if isinstance(kind, IntEnumMember) else _unliteral(kind)


def kernel(function: Callable[P, R]) -> Callable[P, R]:
    """Compile a function of scalars, arrays, records: no GIL, inf instead of ZeroDivisionError, cached, no fastmath."""
    compiled: Any = njit(**_OPTIONS)(function)
    enable_cache(compiled)
    compiled.get_call_template, compiled.get_overload = _of_its_callee(function)
    compiled._compiler._compile_core = _with_environments(compiled._compiler._compile_core)
    checked: Callable[P, R] = compiled
    return checked


def _of_its_callee(function: Callable[..., object]) -> tuple[Callable[..., Any], Callable[..., Any]]:
    """Return the call template and overload functions of the callee, which is made at the first call.

    A constant argument is treated like any other argument: numba would compile the function for each constant.
    """

    @cache
    def callee() -> Any:
        return callee_of(function, _OPTIONS)

    def get_call_template(args: Any, kws: Any) -> Any:
        plain = tuple(map(_plain, args)), {name: _plain(kind) for name, kind in kws.items()}
        try:
            return callee().get_call_template(*plain)
        except TypingError:
            if plain == (tuple(args), kws):
                raise
            return callee().get_call_template(args, kws)  # the constant is needed, such as an index of a tuple

    return get_call_template, lambda signature: callee().get_overload(signature)


def _with_environments(compile_core: Callable[..., Any]) -> Callable[..., Any]:
    """Wrap the compiler so that callees linked into a function get their environments, as loaded functions do."""

    def compile_all(args: Any, return_type: Any) -> Any:
        made = compile_core(args, return_type)
        codegen = made.library.codegen
        for environment in made._find_referenced_environments():
            if codegen._engine.is_symbol_defined(environment.env_name):
                codegen.set_env(environment.env_name, environment)
        return made

    return compile_all


def typed_kernel(signature: Any) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """Compile for one fixed signature, so that it can travel as a first-class function (plug-ins of the loop)."""

    def decorate(function: Callable[P, R]) -> Callable[P, R]:
        compiled: Any = kernel(function)
        compiled.compile(signature)
        compiled.disable_compile()
        typed: Callable[P, R] = compiled
        return typed

    return decorate
