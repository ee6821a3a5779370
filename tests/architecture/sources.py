"""The package's own sources, parsed once for all architecture tests."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = ROOT / "mimics_app"

_LEFT_OUT = {".git", ".venv", "runs", "build", "dist", "node_modules", "differences"}
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
    "",
}


@cache
def texts() -> dict[str, str]:
    """Every module of the package by its path relative to the package: what tests are made for, unparsed.

    Every worker collects every test, and a million nodes that stay would be the garbage collector's, too.
    """
    files = sorted(PACKAGE.rglob("*.py"))
    return {file.relative_to(PACKAGE).as_posix(): file.read_text(encoding="utf-8") for file in files}


@cache
def modules() -> dict[str, ast.Module]:
    """The same, parsed."""
    return {path: ast.parse(text) for path, text in texts().items()}


def imports(tree: ast.Module) -> Iterator[tuple[int, str]]:
    """(line, full dotted name) of everything a module imports, at any depth."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from ((node.lineno, alias.name) for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield from ((node.lineno, f"{node.module}.{alias.name}") for alias in node.names)


def attributes(tree: ast.Module) -> Iterator[tuple[int, str]]:
    """(line, dotted name) of every attribute that is read from a plain name, e.g. "time.sleep" or "os.nice"."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute):
            parts = [node.attr]
            inner: ast.expr = node.value
            while isinstance(inner, ast.Attribute):
                parts.append(inner.attr)
                inner = inner.value
            if isinstance(inner, ast.Name):
                yield node.lineno, ".".join([inner.id, *reversed(parts)])


def repository_files() -> Iterator[Path]:
    """Every text file of the repository that people write; what is built, recorded or cached is left out."""
    for file in sorted(ROOT.rglob("*")):
        parts = file.relative_to(ROOT).parts
        hidden = any(part.startswith(".") and part not in {".ci", ".gitignore"} for part in parts)
        if hidden or _LEFT_OUT.intersection(parts) or "__pycache__" in parts or not file.is_file():
            continue
        if file.suffix in _TEXT:
            yield file
