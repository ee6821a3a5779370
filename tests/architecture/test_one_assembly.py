"""A session is put together in one place: no second one grows beside it."""

from __future__ import annotations

import ast
from collections.abc import Iterator

import pytest

from tests.architecture.sources import modules, nodes

ASSEMBLY = "app/session/"
PARTS = {"TaskManager", "EffectCues", "NullDsp", "NullEstimation"}
"""What only a whole session has: whoever makes one of these makes a frame of his own."""


def made_elsewhere(path: str, tree: ast.Module) -> Iterator[str]:
    """Places outside the assembly where a part of a session is made."""
    if path.startswith(ASSEMBLY):
        return
    for node in nodes(tree):
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in PARTS:
            yield f"{path}:{node.lineno} makes a {node.func.id}"


def test_a_session_is_assembled_in_one_place() -> None:
    assert not [found for path, tree in modules().items() for found in made_elsewhere(path, tree)]


def test_every_part_is_made_there() -> None:
    """A stale name would let a second assembly grow."""
    names = {
        node.func.id
        for path, tree in modules().items()
        if path.startswith(ASSEMBLY)
        for node in nodes(tree)
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name)
    }
    assert names >= PARTS


@pytest.mark.parametrize("part", sorted(PARTS))
def test_a_planted_assembly_is_found(part: str) -> None:
    assert list(made_elsewhere("app/planted.py", ast.parse(f"play = {part}(scene)")))
