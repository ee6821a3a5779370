"""Catalogue of the builders: every package here that has a module `build` with a function `compose`."""

from __future__ import annotations

import ast
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from types import FunctionType
from typing import cast

from assets import builders
from mimics_app.contracts.errors import UsageError, nearest
from mimics_app.contracts.ports.members import load_member
from mimics_app.contracts.system.whole_file import whole_file

__all__ = ["AssetBuilder", "find_builder", "find_builders"]

_ROOM = Path(__file__).parent


@dataclass(frozen=True)
class AssetBuilder:
    """One builder.

    Attributes:
        name: Name of its package.
        file: Its module `build`.
        what: First line of that module's docstring.
    """

    name: str
    file: Path
    what: str

    def compose(self, seed: int) -> Mapping[str, bytes]:
        """Import the builder and return its files: their bytes by name, the same for the same seed."""
        compose = load_member(builders, f"{self.name}.build", "compose", FunctionType)
        return cast(Mapping[str, bytes], compose(seed))

    def write(self, folder: Path, seed: int) -> list[Path]:
        """Write the files into a folder, which is made when missing; return their paths in the order of the names."""
        files = []
        for name, content in sorted(self.compose(seed).items()):
            file = folder / name
            file.parent.mkdir(parents=True, exist_ok=True)
            with whole_file(file):
                file.write_bytes(content)
            files.append(file)
        return files


def find_builders() -> list[AssetBuilder]:
    """Return all builders, by name; nothing is imported."""
    return [
        AssetBuilder(
            file.parent.name, file, (ast.get_docstring(ast.parse(file.read_text("utf-8"))) or "").split("\n")[0]
        )
        for file in sorted(_ROOM.glob("*/build.py"))
    ]


def find_builder(name: str) -> AssetBuilder:
    """Return the builder of that name.

    Raises:
        UsageError: there is none.
    """
    builders = {builder.name: builder for builder in find_builders()}
    if name not in builders:
        raise UsageError(f'nothing builds "{name}"', nearest(name, builders))
    return builders[name]
