"""No module needs itself: imports at any depth and for types count, and the modules that import each other are none."""

from __future__ import annotations

import ast
from collections.abc import Mapping

import grimp

from tests.architecture.sources import imports, modules

__all__ = ["circles", "imported_modules"]


def imported_modules(trees: Mapping[str, ast.Module]) -> dict[str, set[str]]:
    """Modules of the package -> those that each imports, inside functions and for types too, as paths."""
    known = {path.removesuffix(".py").removesuffix("/__init__") for path in trees}
    found = {}
    for path, tree in trees.items():
        names = {name.removeprefix("mimics_app.").replace(".", "/") for _, name in imports(tree)}
        found[path.removesuffix(".py").removesuffix("/__init__")] = {
            place for name in names for place in (name, name.rpartition("/")[0]) if place in known
        }
    return found


def circles(graph: Mapping[str, set[str]]) -> list[set[str]]:
    """Sets of modules of which each reaches each other, by Tarjan (SIAM J. Comput. 1, 1972)."""
    number: dict[str, int] = {}
    low: dict[str, int] = {}
    waiting: list[str] = []
    found = []

    def visit(place: str) -> None:
        number[place] = low[place] = len(number)
        waiting.append(place)
        for target in graph.get(place, ()):
            if target not in number:
                visit(target)
                low[place] = min(low[place], low[target])
            elif target in waiting:
                low[place] = min(low[place], number[target])
        if low[place] == number[place]:
            one = set()
            while place not in one:
                one.add(waiting.pop())
            found.append(one)

    for place in graph:
        if place not in number:
            visit(place)
    return [one for one in found if len(one) > 1]


def test_no_modules_import_each_other() -> None:
    assert not circles(imported_modules(modules()))


def test_a_planted_circle_is_found_also_one_for_a_type_and_one_inside_a_function() -> None:
    planted = {
        "a/one.py": ast.parse("from mimics_app.a.two import Two\n"),
        "a/two.py": ast.parse("if TYPE_CHECKING:\n    from mimics_app.a import three\n"),
        "a/three.py": ast.parse("def f():\n    import mimics_app.a.one\n"),
        "a/four.py": ast.parse("from mimics_app.a.one import One\n"),
    }
    assert circles(imported_modules(planted)) == [{"a/one", "a/two", "a/three"}]


def test_the_graph_is_that_of_import_linter() -> None:
    """The same as grimp finds, but for stubs, which are no modules."""
    graph = grimp.build_graph("mimics_app", exclude_type_checking_imports=False, cache_dir=None)
    own = imported_modules(modules())
    for place, targets in own.items():
        name = ".".join(["mimics_app", *place.split("/")])
        theirs = graph.find_modules_directly_imported_by(name) if name in graph.modules else set()
        wanted = {".".join(["mimics_app", *target.split("/")]) for target in targets}
        assert theirs - {"mimics_app"} <= wanted, name
