"""How much of the product a type checker cannot see."""

from __future__ import annotations

import ast
from collections.abc import Mapping

from tests.architecture.sources import modules, nodes

MOST_ANY = 75
"""Parameters and values that say `Any` alone: insides of the compiler, and libraries without types."""


def any_in_annotations(trees: Mapping[str, ast.Module]) -> list[str]:
    """Places of parameters and values annotated with `Any`."""
    found = []
    for path, tree in trees.items():
        for node in nodes(tree):
            note = node.annotation if isinstance(node, ast.arg | ast.AnnAssign) else None
            if isinstance(note, ast.Name) and note.id == "Any":
                found.append(f"{path}:{node.lineno}")
    return found


def test_few_parameters_are_of_any_type() -> None:
    """A type checker is blind behind each; their number may only fall."""
    found = any_in_annotations(modules())
    assert len(found) <= MOST_ANY, found


def test_the_count_sees_parameters_and_values_and_nothing_else() -> None:
    planted = "def f(a: Any, *b: Any, c: dict[str, Any]) -> Any:\n    d: Any = a\n"
    assert sorted(any_in_annotations({"x.py": ast.parse(planted)})) == ["x.py:1", "x.py:1", "x.py:2"]
