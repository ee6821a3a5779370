"""Cache of compiled kernels: a private folder with one subfolder per module and state of the sources it reaches.

numba's own cache checks the file of the root function only: it misses a changed helper in another file and does not
distinguish code with bounds checks; and its index is a pickle, so that write access to the folder is code execution as
its reader. Here the key of a module is the hash of its own source and of every source its imports reach, so that an
edit recompiles the importers alone, and the folder is accessible to this user only.
"""

from __future__ import annotations

import hashlib
import os
import tempfile
import warnings
import zlib
from collections.abc import Callable, Sequence
from contextlib import suppress
from functools import cache, cached_property
from pathlib import Path
from typing import Any

import llvmlite.binding as ll
from numba.core.caching import IndexDataCacheFile, NullCache
from numba.core.compiler import CR_FIELDS, CompileResult
from numba.core.environment import Environment, lookup_environment
from numba.core.errors import NumbaWarning
from numba.core.runtime.nrt import _nrt, rtsys  # type: ignore[attr-defined]
from numba.core.serialize import dumps

from mimics_app.compiled.cache_folder import cache_folder, compile_listeners
from mimics_app.compiled.kernel_sources import ROOT, changed_since_start, source_key
from mimics_app.compiled.kernel_sweep import mark_used, sweep

__all__ = [
    "KernelCache",
    "KernelFiles",
    "Payload",
    "enable_cache",
    "environments_of",
    "rebuilt",
    "seal",
    "unseal",
]


@cache
def _sweep_once() -> None:
    if cache_folder is not None:
        sweep(cache_folder.parent, _is_present)


def _is_present(name: str) -> bool:
    """Whether the folder of a module belongs to the present sources."""
    module, _, key = name.rpartition("-")
    source = ROOT.joinpath(*module.split(".")).with_suffix(".py")
    return source.is_file() and source_key(source) == key


Payload = tuple[Any, ...]
"""Stored parts of a compile result: library, descriptor, environment, signature, functions to call, environments."""

_SIGNATURE = 3
"""Place of the signature in a payload."""

_MACHINE_CODE = "machine code"
"""Kind of a library stored without its intermediate code; numba's own kind is "object"."""

_UNRESOLVED = ".numba.unresolved$"
"""Prefix of symbols that numba resolves in intermediate code: calls of recursive functions."""

_ENVIRONMENT = "_ZN08NumbaEnv"
"""Prefix of the symbols of environments."""


class KernelFiles:
    """Form in which compile results of one function are stored: machine code without intermediate code.

    numba stores the intermediate code beside the machine code, for linking with callers, and parses it at every start.
    Here callers of a kernel are linked with its callee (`compiled/kernel_callee.py`).

    Attributes:
        prefix: Beginning of the files' names.
    """

    prefix = ""

    def reduce(self, cres: Any) -> Payload:
        """Serialise like numba, with the names of defined and needed symbols in place of the intermediate code."""
        code, fndesc = cres.library._final_module, cres.fndesc
        fndesc.typemap = fndesc.calltypes = None
        environments = environments_of(code)
        asked = {fndesc.llvm_func_name, fndesc.llvm_cpython_wrapper_name, fndesc.llvm_cfunc_wrapper_name}
        asked |= {fndesc.env_name, *(each.env_name for each in environments)}
        named = {each.name: each.is_declaration for each in (*code.functions, *code.global_variables)}
        needed = [name for name, elsewhere in named.items() if elsewhere and not name.startswith("llvm.")]
        library = name, _, (machine_code, _) = cres.library.serialize_using_object_code()
        if not any(name.startswith(_UNRESOLVED) for name in named):
            defined = [name for name in sorted(asked) if not named.get(name, True)]
            library = name, _MACHINE_CODE, (seal(machine_code), _definitions(defined), needed)
        return library, fndesc, cres.environment, cres.signature, tuple(cres.reload_init), environments

    def rebuild(self, target_context: Any, payload: Payload) -> Any:
        """Rebuild the compile result from the payload of `reduce`."""
        name, kind, content = payload[0]
        codegen = target_context.codegen()
        if kind != _MACHINE_CODE:
            target_context.refresh()
            return rebuilt(target_context, codegen.unserialize_library(payload[0]), payload)
        machine_code, defined, needed = content
        _make_known(needed, target_context)
        library = codegen.unserialize_library((name, "object", (unseal(machine_code), defined)))
        return rebuilt(target_context, library, payload)


def environments_of(code: ll.ModuleRef) -> tuple[Environment, ...]:
    """Return the environments, which hold the constants of functions, that intermediate code refers to."""
    named = (each.name for each in code.global_variables)
    found = (lookup_environment(name) for name in named if name.startswith(_ENVIRONMENT))  # type: ignore[no-untyped-call]
    return tuple(each for each in found if each is not None and each.can_cache())


def _definitions(symbols: Sequence[str]) -> bytes:
    """Return intermediate code that defines symbols and nothing else: numba asks it which ones machine code has."""
    return bytes(ll.parse_assembly("\n".join(f'@"{name}" = global i8 0' for name in symbols)).as_bitcode())


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


def _register_runtime(_: object) -> None:
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


def rebuilt(target_context: Any, library: Any, payload: Payload, entry_point: object = None) -> Any:
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


class KernelCache:
    """Stored machine code of one function, in a folder of its module and of the sources that this reaches.

    Damaged or foreign files count as missing.

    Attributes:
        files: Form in which it is stored.
        cache_path: The folder.
    """

    files: KernelFiles = KernelFiles()

    def __init__(self, py_func: Callable[..., object]) -> None:
        code = py_func.__code__
        source = Path(code.co_filename).resolve()
        module = py_func.__module__ if source.is_relative_to(ROOT) else source.stem
        key = source_key(source)
        self.cache_path = str((cache_folder or Path(tempfile.gettempdir())) / f"{module}-{key}")
        name = f"{source.stem}.{py_func.__qualname__}".replace("<", "").replace(">", "")
        name = f"{self.files.prefix}{name}-{code.co_firstlineno}"
        self._py_func = py_func
        self._stored = IndexDataCacheFile(self.cache_path, name, key)  # type: ignore[no-untyped-call]

    def load_overload(self, sig: object, target_context: Any) -> Any:
        """Return stored machine code, or None to compile again.

        None also for a damaged file, one that refers to a module that this process does not have, or one that another
        process wrote for other types: two that store the first code of a function at once give both the same number.
        numba's refresh of its registries before each load is left out: compilation does it.
        """
        with suppress(Exception):  # a damaged pickle raises anything
            data = self._stored.load(self._entry(sig, target_context.codegen()))  # type: ignore[no-untyped-call]
            if data is not None and data[_SIGNATURE].args == getattr(sig, "args", sig):
                return self.files.rebuild(target_context, data)
        return None

    def save_overload(self, sig: object, data: Any) -> None:
        """Store machine code where the disk takes it; an index that cannot be read is replaced."""
        if data.library.has_dynamic_globals:
            warnings.warn(NumbaWarning(f"{self._py_func.__qualname__} has an address in it: not stored"), stacklevel=2)
            return
        entry = self._entry(sig, data.codegen)
        with suppress(OSError):  # a full disk: each process compiles again
            self._make_folder()
            try:
                self._save(entry, data)
            except FileNotFoundError:  # another process swept the folder while this one opened it
                self._make_folder()
                self._save(entry, data)
            except OSError:
                raise
            except Exception:  # noqa: BLE001  as in load_overload
                self._stored.flush()  # type: ignore[no-untyped-call]
                self._save(entry, data)
        for listener in compile_listeners:
            listener()

    def _save(self, entry: object, data: Any) -> None:
        self._stored.save(entry, self.files.reduce(data))  # type: ignore[no-untyped-call]

    def _make_folder(self) -> None:
        """Create the folder; a process that creates one also sweeps the cache, once."""
        if not os.path.exists(self.cache_path):
            _sweep_once()
            os.makedirs(self.cache_path, exist_ok=True)

    def _entry(self, sig: object, codegen: Any) -> tuple[object, ...]:
        """Return the key of one signature: with the processor, the function's code, and what it encloses."""
        enclosed = tuple(cell.cell_contents for cell in self._py_func.__closure__ or ())
        content = self._py_func.__code__.co_code + dumps(enclosed)  # type: ignore[no-untyped-call]
        return sig, codegen.magic_tuple(), hashlib.sha256(content).hexdigest()


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
