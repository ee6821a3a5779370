"""The builders that lie beside the assets they make: every `assets/**/build_NAME.py` with a function `build`."""

from __future__ import annotations

import ast
import importlib.util
import sys
from collections.abc import Callable
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from mimics_app.contracts.errors import MimicsError, UsageError, nearest
from mimics_app.contracts.resources import root

if TYPE_CHECKING:
    from collections.abc import Iterator
    from types import ModuleType

__all__ = ["AssetBuilder", "find_builder", "find_builders"]

_PREFIX = "build_"


@dataclass(frozen=True)
class AssetBuilder:
    """One builder.

    Attributes:
        name: As in `build_NAME.py`.
        file: Where it is.
        what: First line of its docstring.
    """

    name: str
    file: Path
    what: str

    def build(self, folder: Path, seed: int) -> list[Path]:
        """Import the builder and have it write its files.

        Args:
            folder: Made when missing.
            seed: Handed on; the same seed makes the same bytes.

        Returns:
            The files written.

        Raises:
            MimicsError: the builder cannot be imported.
        """
        with _beside(self.file.parent):
            make: Callable[[Path, int], list[Path]] = self._import().build
            return make(folder, seed)

    def _import(self) -> ModuleType:
        spec = importlib.util.spec_from_file_location(f"mimics_asset_{self.name}", self.file)
        if spec is None or spec.loader is None:
            raise MimicsError(f"{self.file} cannot be imported")
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        return module


def find_builders() -> list[AssetBuilder]:
    """All builders of this installation, by name; nothing is imported."""
    found = []
    for file in sorted((root() / "assets").rglob(f"{_PREFIX}*.py")):
        tree = ast.parse(file.read_text(encoding="utf-8"))
        if _offers_build(tree):
            what = (ast.get_docstring(tree) or "").splitlines()[0:1]
            found.append(AssetBuilder(file.stem.removeprefix(_PREFIX), file, what[0] if what else ""))
    return sorted(found, key=lambda builder: builder.name)


def find_builder(name: str) -> AssetBuilder:
    """The builder of that name.

    Raises:
        UsageError: there is none.
    """
    builders = {builder.name: builder for builder in find_builders()}
    if name not in builders:
        raise UsageError(f'nothing builds "{name}"', nearest(name, builders))
    return builders[name]


def _offers_build(tree: ast.Module) -> bool:
    """Whether a module defines or imports a function called `build`."""
    for node in tree.body:
        if isinstance(node, ast.FunctionDef) and node.name == "build":
            return True
        if isinstance(node, ast.ImportFrom) and any((alias.asname or alias.name) == "build" for alias in node.names):
            return True
    return False


@contextmanager
def _beside(folder: Path) -> Iterator[None]:
    """Let a builder import the modules that lie beside it, as it can when it is run as a script."""
    sys.path.insert(0, str(folder))
    try:
        yield
    finally:
        sys.path.remove(str(folder))
