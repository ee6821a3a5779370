"""Members of a package that are found by their files: one module each, with one constant of a known name.

No table names them, so that adding one changes no existing file. A name that begins with an underscore is no member.
"""

from __future__ import annotations

from importlib import import_module
from pkgutil import iter_modules
from types import ModuleType
from typing import TypeVar

from mimics_app.contracts.errors import MimicsError

__all__ = ["MemberError", "import_member", "import_members", "load_member", "member_names"]

_Kind = TypeVar("_Kind")


class MemberError(MimicsError, ImportError):
    """A file lies among the members of a package and is none of them."""


def member_names(package: ModuleType, *, packages: bool = False) -> tuple[str, ...]:
    """Return the names of the modules in a package, or of the packages in it, in order; nothing is imported."""
    found = (module.name for module in iter_modules(package.__path__) if module.ispkg == packages)
    return tuple(name for name in found if not name.startswith("_"))


def import_members(package: ModuleType) -> None:
    """Import all modules of a package, which register themselves."""
    for name in member_names(package):
        import_member(package, name)


def import_member(package: ModuleType, name: str) -> ModuleType:
    """Import a module of a package; a dot leads into a package of it.

    Raises:
        MemberError: The module does not exist.
        ImportError: The module itself cannot be imported.
    """
    full = f"{package.__name__}.{name}"
    try:
        return import_module(full)
    except ModuleNotFoundError as error:
        if error.name != full:
            raise
        place = f"{package.__path__[0]}/{name.replace('.', '/')}.py"
        raise MemberError(f"{place} is missing", _fix(f"{name.partition('.')[0]}/")) from error


def load_member(package: ModuleType, name: str, constant: str, kind: type[_Kind]) -> _Kind:
    """Import a module of a package and return its constant.

    Args:
        package: The package.
        name: Name of the module in it; a dot leads into a package.
        constant: Name of the constant.
        kind: Its type.

    Raises:
        MemberError: The module does not exist, or it has no such constant, or one of another type.
        ImportError: The module itself cannot be imported.
    """
    module = import_member(package, name)
    found = getattr(module, constant, None)
    if not isinstance(found, kind):
        what = f"{module.__file__}: {module.__name__} has no {constant} of type {kind.__name__}"
        raise MemberError(what, _fix(f"{name.rpartition('.')[2]}.py"))
    return found


def _fix(name: str) -> str:
    return f"add it, or move {name} elsewhere, or begin its name with an underscore"
