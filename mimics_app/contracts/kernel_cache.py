"""The cache of compiled kernels: a private folder, one subfolder per module and state of the sources it can reach.

numba's own cache looks at the file of the root function only: a changed helper in another file is not seen, a cache
made with bounds checks is taken for one without, and its index is a pickle, so whoever may write the folder may run
code as its reader. Here a module's key is the hash of its own source and of every source its imports reach, so an edit
compiles its importers again and nothing else, and the folder belongs to this user alone.
"""

from __future__ import annotations

import atexit
import hashlib
import os
import pickle
import re
import shutil
import stat
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import suppress
from functools import cache, cached_property
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numba
from numba.core.caching import CompileResultCacheImpl, FunctionCache, NullCache, _CacheLocator

from mimics_app.contracts.clock import wall_time

__all__ = [
    "KernelCache",
    "KernelFiles",
    "cache_folder",
    "enable_cache",
    "private_folder",
    "source_key",
    "sources_reached",
]

_OPEN_TO_OTHERS = 0o077
_STARTED = wall_time().timestamp()
"""Sources changed after this [s since the epoch] may not be those this process has."""

_HERE = Path(__file__).resolve()
_ROOT = _HERE.parents[2]
_IMPORT = re.compile(
    rb"^[ \t]*(?:from[ \t]+(\.*[\w.]*)[ \t]+import[ \t]+(\([^)]*\)|[^\n]*)|import[ \t]+([^\n]*))", re.MULTILINE
)
_NAME = re.compile(rb"([\w.]+)(?:[ \t]+as[ \t]+\w+)?")


# --- numba's start ------------------------------------------------------------------------------------------------


def _load_arrays() -> None:
    """Import numba's functions of arrays without all of scipy.linalg, which it would import to see that it is there.

    Machine code that calls a BLAS imports it then on its own; that scipy fits numba's width of integers is still looked
    at. A numba of another build imports them its own way.
    """
    from numba.np import linalg

    ensure_blas: Any = linalg.ensure_blas
    linalg.ensure_blas = getattr(linalg, "_check_lapack_int_width", ensure_blas)
    try:
        from numba.np import arraymath  # noqa: F401
    finally:
        linalg.ensure_blas = ensure_blas


_load_arrays()


# --- which folder ---------------------------------------------------------------------------------------------------


def _candidates() -> Iterator[Path]:
    """Where the folder may lie, best first."""
    for variable in ("NUMBA_CACHE_DIR", "XDG_CACHE_HOME"):
        if named := os.environ.get(variable):
            yield Path(named) / "mimics"
    with suppress(RuntimeError):  # a container's user may have no home at all
        yield Path.home() / ".cache" / "mimics"
    user = os.getuid() if hasattr(os, "getuid") else os.environ.get("USERNAME", "user")
    yield Path(tempfile.gettempdir()) / f"mimics-{user}"


def _make_private(folder: Path) -> bool:
    """Whether `folder` is a directory (no link) of this user that nobody else may open; made or closed if need be."""
    try:
        folder.parent.mkdir(parents=True, exist_ok=True)
        with suppress(FileExistsError):
            folder.mkdir(mode=0o700)
        found = folder.lstat()
        if not stat.S_ISDIR(found.st_mode):
            return False
        if hasattr(os, "geteuid"):
            if found.st_uid != os.geteuid():
                return False
            if found.st_mode & _OPEN_TO_OTHERS:
                folder.chmod(0o700)
        return os.access(folder, os.W_OK)
    except OSError:
        return False


def private_folder() -> Path | None:
    """The first candidate that is this user's own, else a fresh folder for this process and its children, else None."""
    for folder in _candidates():
        if _make_private(folder):
            return folder
    try:
        fresh = Path(tempfile.mkdtemp(prefix="mimics-"))  # 0700 by its definition
    except OSError:
        return None
    os.environ["NUMBA_CACHE_DIR"] = str(fresh)  # children share it; it goes with this process
    atexit.register(shutil.rmtree, fresh, ignore_errors=True)
    return fresh


def _compiler_key() -> str:
    """What besides sources decides machine code; numba's own index knows the processor."""
    bounds = os.environ.get("NUMBA_BOUNDSCHECK", "0")
    return hashlib.sha256(f"{numba.__version__} {sys.version_info[:2]} {bounds}".encode()).hexdigest()[:8]


def _choose_cache_folder() -> Path | None:
    base = private_folder()
    return None if base is None else base / f"kernels-{_compiler_key()}"


cache_folder: Path | None = _choose_cache_folder()
"""Where machine code is kept, or None where nothing is writable (then each start compiles again)."""


# --- which sources --------------------------------------------------------------------------------------------------


@cache
def _package_root(top: str) -> Path | None:
    """The folder in which the top-level name of an import lies, if its sources can differ from run to run."""
    if top == __name__.partition(".")[0]:
        return _ROOT
    if top in sys.stdlib_module_names:
        return None
    try:
        spec = find_spec(top)
    except (ImportError, ValueError):
        return None
    if spec is None:
        return None
    places = list(spec.submodule_search_locations or [])
    place = Path(places[0]) if places else Path(spec.origin or "")
    return None if place.suffix == ".so" else place.parent


@cache
def _source_of(name: str) -> Path | None:
    """File of a dotted module name below its package's root, or None where that is no source file."""
    root = _package_root(name.partition(".")[0])
    if root is None:
        return None
    place = root.joinpath(*name.split("."))
    for file in (place.with_suffix(".py"), place / "__init__.py"):
        if file.is_file():
            return file
    return None


def _names(imported: bytes) -> list[str]:
    text = b"\n".join(line.partition(b"#")[0] for line in imported.split(b"\n"))
    return [found.decode() for part in text.strip(b"() \t").split(b",") if (found := _first_name(part))]


def _first_name(part: bytes) -> bytes:
    found = _NAME.match(part.strip())
    return found[1] if found else b""


def _absolute(source: Path, name: str) -> str | None:
    """`name` of an import inside `source` without leading dots; None where a relative one leaves every package."""
    dots = len(name) - len(name.lstrip("."))
    if not dots:
        return name
    package = source.parent
    for _ in range(dots - 1):
        package = package.parent
    parts: list[str] = []
    while (package / "__init__.py").is_file():
        parts.insert(0, package.name)
        package = package.parent
    return ".".join([*parts, name.lstrip(".")]).rstrip(".") if parts else None


@cache
def _read(source: Path) -> bytes:
    return source.read_bytes()


@cache
def _imports(source: Path) -> tuple[Path, ...]:
    """Sources that `source` imports directly, wherever in its text the import stands."""
    found: set[Path] = set()
    for origin, names, modules in _IMPORT.findall(_read(source)):
        if modules:
            found.update(file for name in _names(modules) if (file := _source_of(name)))
        elif base := _absolute(source, origin.decode()):
            own = _source_of(base)
            found.update(file for name in _names(names) if (file := _source_of(f"{base}.{name}") or own))
    return tuple(sorted(found))


def _is_fixed(source: Path, own: Path) -> bool:
    """Whether `source` is an installed library: its version changes with the environment, not with an edit."""
    if "site-packages" not in source.parts or source.is_relative_to(_ROOT / "mimics_app"):
        return False
    return not source.is_relative_to(own)


@cache
def sources_reached(source: Path) -> tuple[Path, ...]:
    """`source` and every source file its imports reach, sorted.

    Installed libraries of others are left out, and this module: where machine code is kept changes nothing in it.
    """
    own = source.parent
    while (own.parent / "__init__.py").is_file():
        own = own.parent
    reached, waiting = {source, _HERE}, [source]
    while waiting:
        for file in _imports(waiting.pop()):
            if file not in reached and not _is_fixed(file, own):
                reached.add(file)
                waiting.append(file)
    return tuple(sorted(reached - {_HERE} | {source}))


@cache
def _digest(source: Path) -> bytes:
    return hashlib.sha256(_read(source)).digest()


@cache
def source_key(source: Path) -> str:
    """16 hex digits that change with any byte of any source that `source` can reach."""
    total = hashlib.sha256()
    for file in sources_reached(source):
        total.update(f"{file.parent.name}/{file.name}".encode())
        total.update(_digest(file))
    return total.hexdigest()[:16]


@cache
def changed_since_start(source: Path) -> bool:
    """Whether a source that `source` can reach was edited since this process began; a date to come is no edit."""
    now = wall_time().timestamp()
    return any(_STARTED < _changed_at(file) <= now for file in sources_reached(source))


@cache
def _changed_at(source: Path) -> float:
    """When a source was changed last, as of the first time that is asked [s since the epoch].

    It was read before, so that an edit after that is neither in this process nor in any key.
    """
    return source.stat().st_mtime


# --- numba's side ---------------------------------------------------------------------------------------------------


_NOT_LOADABLE = (ImportError, AttributeError, EOFError, pickle.UnpicklingError)
"""What reading a file that is cut off, or that names things of another checkout, ends in."""


class _Locator(_CacheLocator):
    """Puts a function's files into the folder of its module and of the sources that module reaches."""

    def __init__(self, py_func: Callable[..., object], py_file: str) -> None:
        source = Path(py_file).resolve()
        self._py_file = py_file
        self._line = py_func.__code__.co_firstlineno
        self._key = source_key(source)
        self._module = py_func.__module__ if source.is_relative_to(_ROOT) else source.stem

    def get_cache_path(self) -> str:
        return str((cache_folder or Path(tempfile.gettempdir())) / f"{self._module}-{self._key}")

    def get_source_stamp(self) -> str:
        return self._key

    def get_disambiguator(self) -> str:
        return str(self._line)

    @classmethod
    def from_function(cls, py_func: Callable[..., object], py_file: str) -> _Locator | None:
        return cls(py_func, py_file) if os.path.exists(py_file) else None


class KernelFiles(CompileResultCacheImpl):
    """numba's files of one function, in our folder."""

    _locator_classes = [_Locator]  # noqa: RUF012  numba's own form


class KernelCache(FunctionCache):
    """numba's cache of one function that takes what is damaged or foreign for missing."""

    _impl_class = KernelFiles

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Machine code kept earlier, or None: then it is compiled again.

        So it is where the file is damaged, or was made in a module that this process does not have under that name.
        """
        try:
            return super().load_overload(sig, target_context)  # type: ignore[no-untyped-call]
        except _NOT_LOADABLE:
            return None

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keep machine code; an index that names types of modules this process does not have is begun anew."""
        try:
            super().save_overload(sig, data)  # type: ignore[no-untyped-call]
        except _NOT_LOADABLE:
            self.flush()  # type: ignore[no-untyped-call]
            super().save_overload(sig, data)  # type: ignore[no-untyped-call]


class _Deferred:
    """The cache of one function, opened when its machine code is first requested: most of what is imported never runs.

    By then a source may have been edited while this process still has the old one: such a function is compiled for this
    process alone, or the old code would be kept under the new text's key.
    """

    def __init__(self, py_func: Callable[..., object], kind: type[KernelCache]) -> None:
        self._py_func = py_func
        self._kind = kind

    @cached_property
    def _opened(self) -> Any:
        source = Path(self._py_func.__code__.co_filename).resolve()
        if changed_since_start(source):
            return NullCache()
        return self._kind(self._py_func)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._opened, name)


def enable_cache(dispatcher: Any, kind: type[KernelCache] = KernelCache) -> None:
    """Let a compiled function keep its machine code in `cache_folder`; without a folder or a source file, not at all.

    Functions typed at a prompt have no source file whose change could be seen, so they are compiled in each process.
    """
    if cache_folder is not None and os.path.exists(dispatcher.py_func.__code__.co_filename):
        dispatcher._cache = _Deferred(dispatcher.py_func, kind)
