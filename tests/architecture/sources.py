"""The package's own sources, parsed once for all architecture tests."""

from __future__ import annotations

import ast
import gc
import os
from collections.abc import Iterator
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = ROOT / "mimics_app"
BUILDERS = ROOT / "assets" / "builders"
"""What makes the shipped files: beside the product, and under the same rules."""

_LEFT_OUT = {"__pycache__", "runs", "build", "dist", "node_modules", "differences"}
_TEXT = {
    ".py",
    ".md",
    ".toml",
    ".txt",
    ".sh",
    ".json",
    ".cff",
    ".cfg",
    ".vert",
    ".frag",
    ".glsl",
    ".comp",
    ".svg",
    ".j2",
    ".css",
    ".conf",
    ".material",
    ".bash",
    ".zsh",
    ".fish",
    "",
}


@cache
def texts() -> dict[str, str]:
    """Every module by its path, relative to the package, or "assets/builders/...": what tests are made for, unparsed.

    Every worker collects every test, and a million nodes that stay would be the garbage collector's, too.
    """
    return {
        file.relative_to(place).as_posix(): file.read_text(encoding="utf-8")
        for folder, place in ((PACKAGE, PACKAGE), (BUILDERS, ROOT))
        for file in sorted(folder.rglob("*.py"))
    }


@cache
def modules() -> dict[str, ast.Module]:
    """The same, parsed; the garbage collector is kept from looking through a million nodes again and again."""
    trees = {path: ast.parse(text) for path, text in texts().items()}
    gc.freeze()
    return trees


@cache
def nodes(tree: ast.Module) -> tuple[ast.AST, ...]:
    """Every node of a module. A dozen tests look through all modules, and walking a tree costs more than a test."""
    return tuple(ast.walk(tree))


@cache
def imports(tree: ast.Module) -> tuple[tuple[int, str], ...]:
    """(line, full dotted name) of everything a module imports, at any depth."""
    found: list[tuple[int, str]] = []
    for node in nodes(tree):
        if isinstance(node, ast.Import):
            found += [(node.lineno, alias.name) for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            found += [(node.lineno, f"{node.module}.{alias.name}") for alias in node.names]
    return tuple(found)


@cache
def attributes(tree: ast.Module) -> tuple[tuple[int, str], ...]:
    """(line, dotted name) of every attribute that is read from a plain name, e.g. "time.sleep" or "os.nice"."""
    return tuple(_attributes(tree))


def _attributes(tree: ast.Module) -> Iterator[tuple[int, str]]:
    for node in nodes(tree):
        if isinstance(node, ast.Attribute):
            parts = [node.attr]
            inner: ast.expr = node.value
            while isinstance(inner, ast.Attribute):
                parts.append(inner.attr)
                inner = inner.value
            if isinstance(inner, ast.Name):
                yield node.lineno, ".".join([inner.id, *reversed(parts)])


@cache
def repository_files() -> tuple[Path, ...]:
    """Every text file of the repository that people write; what is built, recorded or cached is left out."""
    found = []
    for folder, folders, names in os.walk(ROOT):
        folders[:] = [name for name in folders if name == ".ci" or not (name in _LEFT_OUT or name.startswith("."))]
        files = [Path(folder, name) for name in names if name == ".gitignore" or not name.startswith(".")]
        found += [file for file in files if file.suffix in _TEXT and file.is_file()]
    return tuple(sorted(found))
