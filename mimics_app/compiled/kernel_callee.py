"""Callees: kernels as intermediate code only, to be linked into the kernels that Python calls.

numba wraps every function it compiles for Python and C, and generates machine code for each with all its callees
inlined. Of some six hundred kernels a few dozen are called from outside; wrappers and machine code of the others would
be unused, and are more than half of the time of a cold start.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import cache
from typing import Any

from llvmlite.binding import parse_bitcode
from numba.core import compiler
from numba.core.codegen import JITCodeLibrary
from numba.core.errors import TypingError
from numba.core.registry import CPUDispatcher
from numba.core.types import IntEnumMember, unliteral

from mimics_app.compiled.kernel_cache import (
    KernelCache,
    KernelFiles,
    Payload,
    enable_cache,
    environments_of,
    rebuilt,
    seal,
    unseal,
)

__all__ = ["keep_and_link"]


class _Entry:
    """Placeholder for the entry point from Python, which a callee does not have."""


class _LinkedLibrary(JITCodeLibrary):
    """Library of intermediate code for linking into others, without machine code of its own."""

    def _optimize_final_module(self) -> None:
        """Run only mandatory inlining and reference pruning: the code is optimised in the caller it is linked into.

        Otherwise each function would be optimised again at every level of calls above it.
        """
        passes, builder = self.codegen._module_pass_manager(
            loop_vectorize=False, slp_vectorize=False, opt=0, cost="cheap"
        )
        passes.run(self._final_module, builder)

    def _finalize_final_module(self) -> None:
        self._finalize_dynamic_globals()
        self._verify_declare_only_symbols()
        self._finalized = True


def _new_library(target_context: Any, name: str) -> Any:
    library = target_context.codegen().create_library(name)
    library.__class__ = _LinkedLibrary
    library.enable_object_caching()
    return library


class _LinkedFiles(KernelFiles):
    prefix = "linked-"

    def reduce(self, cres: Any) -> Payload:
        """Serialise like numba, with intermediate code in place of machine code."""
        fndesc = cres.fndesc
        fndesc.typemap = fndesc.calltypes = None
        environments = environments_of(cres.library._final_module)
        name, kind, bitcode = cres.library.serialize_using_bitcode()
        content = name, kind, seal(bitcode)
        return content, fndesc, cres.environment, cres.signature, tuple(cres.reload_init), environments

    def rebuild(self, target_context: Any, payload: Payload) -> Any:
        """Rebuild the compile result from the payload of `reduce`."""
        name, _, bitcode = payload[0]
        library = _new_library(target_context, name)
        library._final_module = parse_bitcode(unseal(bitcode))
        library._finalize_final_module()
        return rebuilt(target_context, library, payload, _Entry())


class _LinkedCache(KernelCache):
    files = _LinkedFiles()


class _Callee(CPUDispatcher):
    """Dispatcher of a function that is called by compiled code only."""

    def add_overload(self, cres: Any) -> None:
        """Store the result for compiled callers, without an entry point from Python."""
        self.overloads[tuple(cres.signature.args)] = cres


def _compile_linked(dispatcher: Any, args: object, return_type: object) -> Any:
    """Compile like numba's `_FunctionCompiler._compile_core`, without wrappers and machine code."""
    descriptor = dispatcher.targetdescr
    flags: Any = compiler.Flags()
    descriptor.options.parse_as_flags(flags, dispatcher.targetoptions)
    flags.no_compile = True
    target = descriptor.target_context
    library = _new_library(target, dispatcher.py_func.__qualname__)
    made = compiler.compile_extra(
        descriptor.typing_context,
        target,
        dispatcher.py_func,
        args=args,
        return_type=return_type,
        flags=flags,
        locals=dispatcher.locals,
        library=library,
    )
    library._ensure_finalized()
    parts = dict(zip(compiler.CR_FIELDS, made, strict=True))
    parts |= {"entry_point": _Entry(), "reload_init": tuple(library._reload_init)}
    known: Any = compiler.CompileResult(**parts)
    target.insert_user_function(known.entry_point, known.fndesc, [library])
    return known


def _callee_of(function: Callable[..., object], options: dict[str, Any]) -> Any:
    """Return the dispatcher of `function` for compiled callers.

    Args:
        function: The Python function.
        options: Options of the decorator.
    """
    options = {**options, "nopython": True, "no_cpython_wrapper": True, "no_cfunc_wrapper": True}
    callee: Any = _Callee(function, targetoptions=options)
    callee._compiler._compile_core = lambda args, return_type: _compile_linked(callee, args, return_type)
    enable_cache(callee, _LinkedCache)
    return callee


_unliteral: Callable[[Any], Any] = unliteral


def _plain(kind: Any) -> Any:
    """Return int64 for the type of the constant 7 and of a member of an IntEnum; other types unchanged."""
    return kind.dtype if isinstance(kind, IntEnumMember) else _unliteral(kind)


def _of_its_callee(
    function: Callable[..., object], options: dict[str, Any]
) -> tuple[Callable[..., Any], Callable[..., Any]]:
    """Return the call template and overload functions of the callee, which is made at the first call.

    A constant argument is treated like any other argument: numba would compile the function for each constant.
    """

    @cache
    def callee() -> Any:
        return _callee_of(function, options)

    def get_call_template(args: Sequence[object], kws: Mapping[str, object]) -> Any:
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

    def compile_all(args: object, return_type: object) -> Any:
        made = compile_core(args, return_type)
        code = made.library._final_module
        for environment in environments_of(code):
            if not code.get_global_variable(environment.env_name).is_declaration:
                made.library.codegen.set_env(environment.env_name, environment)
        return made

    return compile_all


def keep_and_link(compiled: Any, function: Callable[..., object], options: dict[str, Any]) -> None:
    """Have a compiled function keep its machine code, and its compiled callers link its callee.

    Args:
        compiled: What numba made of the function.
        function: The Python function.
        options: Options of the decorator.
    """
    enable_cache(compiled)
    compiled.get_call_template, compiled.get_overload = _of_its_callee(function, options)
    compiled._compiler._compile_core = _with_environments(compiled._compiler._compile_core)
