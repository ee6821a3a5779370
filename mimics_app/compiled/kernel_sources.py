"""Sources that a compiled function can reach, and the cache key from their content."""

from __future__ import annotations

import hashlib
import os
import re
import sys
import time
from functools import cache
from importlib.util import find_spec
from pathlib import Path

__all__ = ["ROOT", "changed_since_start", "file_time_s", "source_key", "sources_reached"]

ROOT = Path(__file__).resolve().parents[2]
"""Folder that contains the package."""


def file_time_s() -> float:
    """Return the present time on the scale of modification times of files [s since the epoch]."""
    return time.time()


_STARTED = file_time_s()
"""Start of this process [s since the epoch]: sources changed later may differ from those it loaded."""

_PACKAGE = "__init__.py"
"""Source file of a package itself."""

_CACHE_MODULES = frozenset(
    Path(__file__).resolve().with_name(f"{name}.py")
    for name in ("cache_folder", "kernel_cache", "kernel_sources", "kernel_sweep")
)
"""Modules that store machine code but do not affect it; not part of any key."""

_IMPORT = re.compile(rb"\n[ \t]*(?:from[ \t]+(\.*[\w.]*)[ \t]+import[ \t]+(\([^)]*\)|[^\n]*)|import[ \t]+([^\n]*))")
"""An import and the end of the line before it: searching for a fixed first byte is several times as fast as for `^`."""

_NAME = re.compile(rb"([\w.]+)(?:[ \t]+as[ \t]+\w+)?")


@cache
def _package_root(top: str) -> Path | None:
    """Return the folder that contains a top-level module, None if its sources cannot change between runs."""
    if top == __name__.partition(".")[0]:
        return ROOT
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
def _files_of(folder: str) -> frozenset[str]:
    """Return the names in a folder; none where it does not exist."""
    return frozenset(os.listdir(folder)) if os.path.isdir(folder) else frozenset()


@cache
def _source_of(name: str) -> Path | None:
    """Return the source file of a dotted module name, or None."""
    top, *parts = name.split(".")
    root = _package_root(top)
    if root is None:
        return None
    *packages, last = top, *parts
    folder = os.path.join(root, *packages)
    if f"{last}.py" in _files_of(folder):
        return Path(folder, f"{last}.py")
    package = os.path.join(folder, last)
    return Path(package, _PACKAGE) if _PACKAGE in _files_of(package) else None


def _names(imported: bytes) -> list[str]:
    text = b"\n".join(line.partition(b"#")[0] for line in imported.split(b"\n"))
    return [found.decode() for part in text.strip(b"() \t").split(b",") if (found := _first_name(part))]


def _first_name(part: bytes) -> bytes:
    found = _NAME.match(part.strip())
    return found[1] if found else b""


def _absolute(source: Path, name: str) -> str | None:
    """Return the absolute form of an imported `name` in `source`; None if a relative one leaves the package."""
    dots = len(name) - len(name.lstrip("."))
    if not dots:
        return name
    package = source.parent
    for _ in range(dots - 1):
        package = package.parent
    parts: list[str] = []
    while (package / _PACKAGE).is_file():
        parts.insert(0, package.name)
        package = package.parent
    return ".".join([*parts, name.lstrip(".")]).rstrip(".") if parts else None


@cache
def _read(source: Path) -> bytes:
    return source.read_bytes()


@cache
def _imports(source: Path) -> tuple[Path, ...]:
    """Return the sources that `source` imports directly, anywhere in its text."""
    found: set[Path] = set()
    for origin, names, modules in _IMPORT.findall(b"\n" + _read(source)):
        if modules:
            found.update(file for name in _names(modules) if (file := _source_of(name)))
        elif base := _absolute(source, origin.decode()):
            own = _source_of(base)
            if own is not None and own.name != _PACKAGE:  # no package: it has no modules
                found.add(own)
            else:
                found.update(file for name in _names(names) if (file := _source_of(f"{base}.{name}") or own))
    return tuple(found)


@cache
def _is_fixed(source: Path, own: Path) -> bool:
    """Whether `source` belongs to an installed library, which changes with the environment, not with an edit."""
    if "site-packages" not in source.parts or source.is_relative_to(ROOT / "mimics_app"):
        return False
    return not source.is_relative_to(own)


@cache
def sources_reached(source: Path) -> tuple[Path, ...]:
    """Return `source` and every source file that its imports reach, sorted.

    Installed third-party libraries and the cache's own modules are left out.
    """
    own = source.parent
    while (own.parent / _PACKAGE).is_file():
        own = own.parent
    reached, waiting = {source, *_CACHE_MODULES}, [source]
    while waiting:
        for file in _imports(waiting.pop()):
            if file not in reached and not _is_fixed(file, own):
                reached.add(file)
                waiting.append(file)
    return tuple(sorted(reached - _CACHE_MODULES | {source}))


@cache
def _digest(source: Path) -> bytes:
    return hashlib.sha256(_read(source)).digest()


@cache
def source_key(source: Path) -> str:
    """Return 16 hex digits that change with any byte of any source that `source` can reach."""
    total = hashlib.sha256()
    for file in sources_reached(source):
        total.update(f"{file.parent.name}/{file.name}".encode())
        total.update(_digest(file))
    return total.hexdigest()[:16]


@cache
def changed_since_start(source: Path) -> bool:
    """Whether a source that `source` can reach was edited since this process started; future dates are ignored."""
    now = file_time_s()
    return any(_STARTED < _changed_at(file) <= now for file in sources_reached(source))


@cache
def _changed_at(source: Path) -> float:
    """Return the modification time of a source at the first call [s since the epoch].

    The source was read before, so that a later edit is neither in this process nor in any key.
    """
    return source.stat().st_mtime
