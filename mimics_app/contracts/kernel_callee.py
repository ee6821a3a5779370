"""Kernels as other kernels call them: intermediate code alone, to be linked into whoever is called from Python.

numba makes every function it compiles callable from Python and from C, and turns each into machine code with all it
calls inside. Of some six hundred kernels a few dozen are called from outside; the others would be wrapped and made into
machine code, once for each that calls them, for nobody: more than half of a cold start.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from llvmlite.binding import parse_bitcode
from numba.core import compiler
from numba.core.codegen import JITCodeLibrary
from numba.core.registry import CPUDispatcher

from mimics_app.contracts.kernel_cache import KernelCache, KernelFiles, enable_cache, rebuilt

__all__ = ["callee_of"]


class _Entry:
    """Stands for a callee where numba requests the function that Python would call."""


class _LinkedLibrary(JITCodeLibrary):
    """Intermediate code that is linked into others and never becomes machine code of its own."""

    def _optimize_final_module(self) -> None:
        """Inline what must be and prune references, no more: whoever this is linked into is optimised with all in it.

        Else each function would be optimised again at every level of calls above it.
        """
        generator = self._codegen
        passes, builder = generator._module_pass_manager(
            loop_vectorize=False, slp_vectorize=False, opt=generator._opt_level, cost="cheap"
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
    def get_filename_base(self, fullname: str, abiflags: str) -> str:
        """A name beside that of the same function's machine code."""
        return f"linked-{super().get_filename_base(fullname, abiflags)}"

    def reduce(self, cres: Any) -> Any:
        """As numba's own, with intermediate code for machine code."""
        fndesc = cres.fndesc
        fndesc.typemap = fndesc.calltypes = None
        environments = tuple(cres._find_referenced_environments())
        content = cres.library.serialize_using_bitcode()
        return content, fndesc, cres.environment, cres.signature, tuple(cres.reload_init), environments

    def rebuild(self, target_context: Any, payload: Any) -> Any:
        """What `reduce` gave, as a compile result."""
        name, _, bitcode = payload[0]
        library = _new_library(target_context, name)
        library._final_module = parse_bitcode(bitcode)
        library._finalize_final_module()
        return rebuilt(target_context, library, payload, _Entry())


class _LinkedCache(KernelCache):
    _impl_class = _LinkedFiles


class _Callee(CPUDispatcher):
    """A function that is only called by compiled ones."""

    def add_overload(self, cres: Any) -> None:
        """Keep it for callers; Python never sees it."""
        self.overloads[tuple(cres.signature.args)] = cres


def _compile_linked(dispatcher: Any, args: Any, return_type: Any) -> Any:
    """As `_FunctionCompiler._compile_core` of numba, but for what is left out."""
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
    known = made._replace(entry_point=_Entry(), reload_init=tuple(library._reload_init))
    target.insert_user_function(known.entry_point, known.fndesc, [library])
    return known


def callee_of(function: Callable[..., object], options: dict[str, Any]) -> Any:
    """The dispatcher that compiled callers of `function` see.

    Args:
        function: Of Python, as written.
        options: Of the decorator.
    """
    options = {**options, "nopython": True, "no_cpython_wrapper": True, "no_cfunc_wrapper": True}
    callee: Any = _Callee(function, targetoptions=options)
    callee._compiler._compile_core = lambda args, return_type: _compile_linked(callee, args, return_type)
    enable_cache(callee, _LinkedCache)
    return callee
