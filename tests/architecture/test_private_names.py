"""Private names of other packages: each has a reason in docs/compiled.md, and the installed package has it."""

from __future__ import annotations

import ast
import inspect
import re
import sys
from collections.abc import Iterable
from importlib import import_module

import pytest

from tests.architecture.sources import ROOT, modules, nodes, texts

PAGE = ROOT / "docs" / "compiled.md"

BORROWER = "compiled/"
"""Where such names are used: the machinery of compiled functions."""

OURS = {"mimics_app", *sys.stdlib_module_names}
"""Packages that are no other package's."""

NO_PACKAGES = {"self", "cls", "super", "structs"}
"""Owners whose private names are our own."""


def private_names(trees: Iterable[ast.Module]) -> set[str]:
    """Names with a leading underscore that modules import, or ask of what is not their own."""
    trees = list(trees)
    own = {node.name for tree in trees for node in nodes(tree) if isinstance(node, ast.FunctionDef | ast.ClassDef)}
    own |= {node.attr for tree in trees for node in nodes(tree) if isinstance(node, ast.Attribute) and _is_set(node)}
    found = set()
    for tree in trees:
        for node in nodes(tree):
            if isinstance(node, ast.ImportFrom):
                found |= {each.name for each in node.names if _is_private(each.name)}
            elif isinstance(node, ast.Attribute) and _is_private(node.attr) and _owner(node) not in NO_PACKAGES:
                found.add(node.attr)
    return found - own


def _is_set(node: ast.Attribute) -> bool:
    """Whether an attribute of `self` is given a value: then it is our own."""
    return isinstance(node.ctx, ast.Store) and _owner(node) == "self"


def _owner(node: ast.Attribute) -> str:
    return ast.unparse(node.value)


def _is_private(name: str) -> bool:
    return name.startswith("_") and not name.startswith("__")


def _rows() -> dict[str, str]:
    """Private name -> the module or class of the other package that has it, as the page says."""
    page = PAGE.read_text(encoding="utf-8")
    return dict(re.findall(r"^\| `(_\w+)` \| `([\w.]+)` \| \S.*\|$", page, flags=re.MULTILINE))


def test_every_private_name_of_another_package_has_a_reason() -> None:
    used = private_names(tree for path, tree in modules().items() if path.startswith(BORROWER))
    assert used <= set(_rows()), "list it in docs/compiled.md with its reason, or do without"
    text = "\n".join(text for path, text in texts().items() if path.startswith(BORROWER))
    assert all(name in text for name in _rows()), "no longer used: remove the line"


def test_no_other_module_imports_one() -> None:
    others = [tree for path, tree in modules().items() if not path.startswith(BORROWER)]
    imported = {
        f"{node.module}.{each.name}"
        for tree in others
        for node in nodes(tree)
        if isinstance(node, ast.ImportFrom) and (node.module or "").partition(".")[0] not in OURS
        for each in node.names
        if _is_private(each.name)
    }
    assert not imported


@pytest.mark.parametrize(("name", "place"), _rows().items())
def test_the_installed_package_has_it(name: str, place: str) -> None:
    """Fails with the first version that lacks the name: then read its reason and do without."""
    module, _, attribute = place.rpartition(".")
    try:
        owner = import_module(place)
    except ModuleNotFoundError:
        owner = getattr(import_module(module), attribute)
    assert hasattr(owner, name) or re.search(rf"\b{name}\b", inspect.getsource(owner)), f"{place} has no {name}"


def test_planted_names_are_found_and_our_own_are_not() -> None:
    planted = "from numba.core import _inner\nclass A:\n    def _f(self): self._g = x._hidden + self._g + y._f\n"
    assert private_names([ast.parse(planted)]) == {"_inner", "_hidden"}
