"""Members of a package that are found by their files: one module each, with one constant of a known name.

No table names them, so that adding one changes no existing file.
"""

from __future__ import annotations

from importlib import import_module
from pkgutil import iter_modules
from types import ModuleType
from typing import TypeVar

__all__ = ["import_members", "load_member", "member_names"]

_Kind = TypeVar("_Kind")


def member_names(package: ModuleType, *, packages: bool = False) -> tuple[str, ...]:
    """Return the names of the modules in a package, or of the packages in it, in order; nothing is imported."""
    return tuple(module.name for module in iter_modules(package.__path__) if module.ispkg == packages)


def import_members(package: ModuleType) -> None:
    """Import all modules of a package, which register themselves."""
    for name in member_names(package):
        import_module(f"{package.__name__}.{name}")


def load_member(package: ModuleType, name: str, constant: str, kind: type[_Kind]) -> _Kind:
    """Import a module of a package and return its constant.

    Args:
        package: The package.
        name: Name of the module in it; a dot leads into a package.
        constant: Name of the constant.
        kind: Its type.

    Raises:
        ImportError: The module has no such constant, or one of another type.
    """
    module = import_module(f"{package.__name__}.{name}")
    found = getattr(module, constant, None)
    if not isinstance(found, kind):
        raise ImportError(f"{module.__name__} has no {constant} of type {kind.__name__}", path=module.__file__)
    return found
