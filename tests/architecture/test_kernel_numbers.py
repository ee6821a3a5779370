"""Numbers in compiled functions have names, with meaning and unit beside them: bare ones are counted, and only fall."""

from __future__ import annotations

import ast
from collections import Counter
from collections.abc import Iterator

from tests.architecture.sources import modules

PLAIN = {0, 1, 2, 0.5}
"""Numbers that say what they are, with either sign: nothing, one, twice, half."""

AXES = {3}
"""Axes of space: of a vector's length and of a loop over it, as a whole number only."""

MOST_BARE = {
    "rendering/haptic": 17,
    "rendering/visual": 2,
    "rendering/audio": 10,
    "world": 9,
    "maths": 1,
    "lab": 7,
}
"""Room -> bare numbers in its compiled functions: only ever lowered, as they get names."""


def _bare(tree: ast.Module) -> Iterator[tuple[str, float]]:
    """(function, number) of each bare number in a compiled function; places in arrays are no numbers."""
    for function in ast.walk(tree):
        if not isinstance(function, ast.FunctionDef) or not _is_compiled(function):
            continue
        places = {id(inner) for node in ast.walk(function) for inner in _of_a_place(node)}
        for node in ast.walk(function):
            if isinstance(node, ast.Constant) and id(node) not in places and _is_bare(node.value):
                yield function.name, node.value


def _is_compiled(function: ast.FunctionDef) -> bool:
    return any(ast.unparse(mark).split("(")[0] in ("kernel", "typed_kernel") for mark in function.decorator_list)


def _of_a_place(node: ast.AST) -> Iterator[ast.AST]:
    """What stands between the brackets of an index."""
    if isinstance(node, ast.Subscript):
        yield from ast.walk(node.slice)


def _is_bare(value: object) -> bool:
    if isinstance(value, bool) or not isinstance(value, int | float):
        return False
    return value not in PLAIN and not (isinstance(value, int) and value in AXES)


def _room(path: str) -> str:
    """The room of a module, "" for one of those in which nothing may be bare."""
    return next((room for room in MOST_BARE if path.startswith(f"{room}/")), "")


def test_no_further_bare_number_comes_into_a_kernel() -> None:
    """What is left are coefficients of printed formulas: polynomials, series, weights of quadratures, means."""
    found = Counter({_room(path): 0 for path in modules()})
    for path, tree in modules().items():
        found[_room(path)] += sum(1 for _ in _bare(tree))
    assert not {room: count for room, count in found.items() if count > MOST_BARE.get(room, 0)}, "give it a name"


def test_a_planted_number_is_found_and_what_speaks_for_itself_is_not() -> None:
    planted = '''
@kernel
def law(x, v):
    """Takes 7 N."""
    for i in range(3):
        x[i, 5] = -1.0 * v[6] + 0.5 * 2.0
    return x[0] * 9.81 + 3.0


def plain(x):
    return 9.81 * x
'''
    assert sorted(_bare(ast.parse(planted))) == [("law", 3.0), ("law", 9.81)]
