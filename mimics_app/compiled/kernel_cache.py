"""Cache of compiled kernels: a private folder with one subfolder per module and state of the sources it reaches.

numba's own cache checks the file of the root function only: it misses a changed helper in another file and does not
distinguish code with bounds checks; and its index is a pickle, so that write access to the folder is code execution as
its reader. Here the key of a module is the hash of its own source and of every source its imports reach, so that an
edit recompiles the importers alone, and the folder is accessible to this user only.
"""

from __future__ import annotations

import os
import tempfile
import zlib
from collections.abc import Callable, Sequence
from contextlib import suppress
from functools import cache, cached_property
from pathlib import Path
from typing import Any

import llvmlite.binding as ll
from numba.core.caching import CompileResultCacheImpl, FunctionCache, NullCache, _CacheLocator
from numba.core.compiler import CR_FIELDS, CompileResult
from numba.core.runtime.nrt import _nrt, rtsys  # type: ignore[attr-defined]

from mimics_app.compiled.cache_folder import cache_folder, compile_listeners
from mimics_app.compiled.kernel_sources import ROOT, changed_since_start, source_key
from mimics_app.compiled.kernel_sweep import mark_used, sweep

__all__ = [
    "KernelCache",
    "KernelFiles",
    "enable_cache",
    "rebuilt",
    "seal",
    "unseal",
]


class _Locator(_CacheLocator):
    """Locates a function's files in the folder of its module and of the sources that module reaches."""

    def __init__(self, py_func: Callable[..., object], py_file: str) -> None:
        source = Path(py_file).resolve()
        self._py_file = py_file
        self._line = py_func.__code__.co_firstlineno
        self._key = source_key(source)
        self._module = py_func.__module__ if source.is_relative_to(ROOT) else source.stem

    def get_cache_path(self) -> str:
        return str((cache_folder or Path(tempfile.gettempdir())) / f"{self._module}-{self._key}")

    def ensure_cache_path(self) -> None:
        """Create the folder; a process that creates one also sweeps the cache, once."""
        if not os.path.exists(self.get_cache_path()):
            _sweep_once()
        super().ensure_cache_path()  # type: ignore[no-untyped-call]

    def get_source_stamp(self) -> str:
        return self._key

    def get_disambiguator(self) -> str:
        return str(self._line)

    @classmethod
    def from_function(cls, py_func: Callable[..., object], py_file: str) -> _Locator | None:
        return cls(py_func, py_file) if os.path.exists(py_file) else None


@cache
def _sweep_once() -> None:
    if cache_folder is not None:
        sweep(cache_folder.parent, _is_present)


def _is_present(name: str) -> bool:
    """Whether the folder of a module belongs to the present sources."""
    module, _, key = name.rpartition("-")
    source = ROOT.joinpath(*module.split(".")).with_suffix(".py")
    return source.is_file() and source_key(source) == key


_MACHINE_CODE = "machine code"
"""Kind of a library stored without its intermediate code; numba's own kinds are "object" and "bitcode"."""

_UNRESOLVED = ".numba.unresolved$"
"""Prefix of symbols that numba resolves in intermediate code: calls of recursive functions."""


class KernelFiles(CompileResultCacheImpl):
    """numba's cache files of one function, in our folder and without intermediate code.

    numba stores the intermediate code beside the machine code, for linking with callers, and parses it at every start.
    Here callers of a kernel are linked with its callee (`compiled/kernel_callee.py`).
    """

    _locator_classes = [_Locator]  # noqa: RUF012  numba's own form

    def reduce(self, cres: Any) -> Any:
        """Serialise like numba, with the names of defined and needed symbols in place of the intermediate code."""
        code, fndesc = cres.library._final_module, cres.fndesc
        fndesc.typemap = fndesc.calltypes = None
        environments = tuple(cres._find_referenced_environments())
        asked = {fndesc.llvm_func_name, fndesc.llvm_cpython_wrapper_name, fndesc.llvm_cfunc_wrapper_name}
        asked |= {fndesc.env_name, *(each.env_name for each in environments)}
        named = {each.name: each.is_declaration for each in (*code.functions, *code.global_variables)}
        needed = [name for name, elsewhere in named.items() if elsewhere and not name.startswith("llvm.")]
        if any(name.startswith(_UNRESOLVED) for name in named):
            return super().reduce(cres)  # type: ignore[no-untyped-call]
        defined = [name for name in sorted(asked) if not named.get(name, True)]
        machine_code = seal(cres.library._get_compiled_object())
        library = (cres.library.name, _MACHINE_CODE, (machine_code, defined, needed))
        return library, fndesc, cres.environment, cres.signature, tuple(cres.reload_init), environments

    def rebuild(self, target_context: Any, payload: Any) -> Any:
        """Rebuild the compile result from the payload of `reduce`."""
        name, kind, content = payload[0]
        if kind != _MACHINE_CODE:
            target_context.refresh()
            return super().rebuild(target_context, payload)  # type: ignore[no-untyped-call]
        machine_code, defined, needed = content
        _make_known(needed, target_context)
        codegen = target_context.codegen()
        library = codegen.create_library(name)
        library.enable_object_caching()
        library._set_compiled_object(unseal(machine_code))
        library._finalize_final_module()
        codegen._engine._defined_symbols.update(defined)
        return rebuilt(target_context, library, payload)


def seal(code: bytes) -> tuple[bytes, int]:
    """Return code with its checksum, in the form in which it is stored."""
    return code, zlib.crc32(code)


def unseal(sealed: tuple[bytes, int]) -> bytes:
    """Return the code that was sealed.

    Raises:
        ValueError: The disk or a lost supply of power changed it.
    """
    code, checksum = sealed
    if zlib.crc32(code) != checksum:
        raise ValueError("stored code is damaged")
    return code


def _register_runtime(_: Any) -> None:
    """Register the functions of numba's runtime that are written in C, without compiling the others.

    Those that numba compiles in each process are linked into every stored library already.
    """
    for name, address in _nrt.c_helpers.items():
        ll.add_symbol(name if name.startswith("_") else f"NRT_{name}", address)


def _make_known(symbols: Sequence[str], target_context: Any) -> None:
    """Have numba register the addresses of its own functions that machine code calls: of its runtime, else all."""
    for make_known in (_register_runtime, rtsys.initialize, type(target_context).refresh):
        if all(ll.address_of_symbol(symbol) is not None for symbol in symbols):
            return
        make_known(target_context)


def rebuilt(target_context: Any, library: Any, payload: Any, entry_point: Any = None) -> Any:
    """Return the compile result of a stored function.

    Args:
        target_context: Target context of the compiler.
        library: Library read from `payload`.
        payload: Payload of `KernelFiles.reduce` or of a subclass.
        entry_point: Entry point from Python; None: the wrapper in the library.
    """
    _, fndesc, environment, signature, reload_init, environments = payload
    for function in reload_init:
        function()
    known = dict.fromkeys(CR_FIELDS) | {
        "typing_context": target_context.typing_context,
        "target_context": target_context,
        "entry_point": entry_point or target_context.get_executable(library, fndesc, environment),
        "type_annotation": "",
        "signature": signature,
        "objectmode": False,
        "lifted": (),
        "fndesc": fndesc,
        "library": library,
        "environment": environment,
        "reload_init": reload_init,
        "referenced_envs": environments,
    }
    if entry_point is None:
        for each in environments:
            library.codegen.set_env(each.env_name, each)
    return CompileResult(**known)


class KernelCache(FunctionCache):
    """numba's cache of one function, where damaged or foreign files count as missing."""

    _impl_class = KernelFiles

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Return stored machine code, or None to compile again.

        None also for a damaged file, or one that refers to a module that this process does not have. numba's refresh
        of its registries before each load is left out: compilation does it.
        """
        with suppress(Exception):  # a damaged pickle raises anything
            return self._load_overload(sig, target_context)  # type: ignore[no-untyped-call]
        return None

    def save_overload(self, sig: Any, data: Any) -> None:
        """Store machine code where the disk takes it; an index that cannot be read is replaced."""
        with suppress(OSError):  # a full disk: each process compiles again
            try:
                super().save_overload(sig, data)  # type: ignore[no-untyped-call]
            except FileNotFoundError:  # another process swept the folder while this one opened it
                super().save_overload(sig, data)  # type: ignore[no-untyped-call]
            except OSError:
                raise
            except Exception:  # noqa: BLE001  as in load_overload
                self.flush()  # type: ignore[no-untyped-call]
                super().save_overload(sig, data)  # type: ignore[no-untyped-call]
        for listener in compile_listeners:
            listener()


class _Deferred:
    """Cache of one function, opened at the first request: most imported functions never run.

    If a source was edited after this process loaded it, the function is compiled for this process only; otherwise the
    old code would be stored under the key of the new text.
    """

    def __init__(self, py_func: Callable[..., object], kind: type[KernelCache]) -> None:
        self._py_func = py_func
        self._kind = kind

    @cached_property
    def _opened(self) -> Any:
        source = Path(self._py_func.__code__.co_filename).resolve()
        if changed_since_start(source):
            return NullCache()
        opened = self._kind(self._py_func)
        mark_used(Path(opened.cache_path))
        return opened

    def __getattr__(self, name: str) -> Any:
        return getattr(self._opened, name)


def enable_cache(dispatcher: Any, kind: type[KernelCache] = KernelCache) -> None:
    """Store the machine code of a compiled function in `cache_folder`; no effect without a folder or a source file.

    Functions typed at a prompt have no source file to detect changes of, and are compiled in each process.
    """
    if cache_folder is not None and os.path.exists(dispatcher.py_func.__code__.co_filename):
        dispatcher._cache = _Deferred(dispatcher.py_func, kind)
