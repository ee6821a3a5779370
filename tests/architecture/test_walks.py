"""The walks of docs/architecture.md are those of the code: every file and function is there, and called from before."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator, Mapping

import pytest

from tests.architecture.sources import ROOT, modules, texts

Step = tuple[str, str, bool]
"""Path of a module, name in it, and whether it is reached over something that hides the name."""

_STEP = re.compile(r"`([\w/]+\.py): ([\w.]+)`(?P<over>\s+\(over [^)]*\))?")


def walks(page: str) -> dict[str, list[Step]]:
    """Walk -> its steps: path of the module, name in it, whether it is reached over something that hides the name."""
    section = page.split("## Walks\n")[1].split("\n## ")[0]
    parts = re.split(r"^\*\*(.+?)\*\*", section, flags=re.MULTILINE)
    return {name: list(_steps(text)) for name, text in zip(parts[1::2], parts[2::2], strict=True)}


def _steps(text: str) -> Iterator[Step]:
    below = re.search(r"\(below `([\w/]+)`\)", text)
    for found in _STEP.finditer(text):
        folder = "" if below is None else f"{below[1]}/"
        yield f"{folder}{found[1]}", found[2], found["over"] is not None


def faults(steps: list[Step], trees: Mapping[str, ast.Module], sources: Mapping[str, str]) -> list[str]:
    """Steps that do not exist, and those that no earlier file names."""
    found = []
    for number, (path, name, over) in enumerate(steps):
        if path not in trees or not _defines(trees[path], name):
            found.append(f"{path} has no {name}")
        elif number and not over and not _is_named(name, {sources[p] for p, _, _ in steps[:number] if p in sources}):
            found.append(f"no earlier step names {name} of {path}")
    return found


def _defines(tree: ast.Module, name: str) -> bool:
    body: list[ast.stmt] = tree.body
    for part in name.split("."):
        nodes = [node for node in body if isinstance(node, ast.FunctionDef | ast.ClassDef) and node.name == part]
        if not nodes:
            return False
        body = nodes[0].body
    return True


def _is_named(name: str, texts: set[str]) -> bool:
    return any(re.search(rf"\b{name.rpartition('.')[2]}\b", text) for text in texts)


WALKS = walks((ROOT / "docs" / "architecture.md").read_text(encoding="utf-8"))


def test_there_are_the_walks_of_six_kinds_of_data_and_of_both_numbers_of_a_scene() -> None:
    assert len(WALKS) == 7 and all(len(steps) >= 5 for steps in WALKS.values())


@pytest.mark.parametrize("name", WALKS)
def test_a_walk_is_that_of_the_code(name: str) -> None:
    assert not faults(WALKS[name], modules(), texts())


def test_a_step_that_is_gone_or_skipped_is_found() -> None:
    sources = {
        "a.py": "def f(): return g()\n",
        "b.py": "def g(): return h()\n",
        "c.py": "class H:\n    def h(self): ...\n",
    }
    trees = {path: ast.parse(text) for path, text in sources.items()}
    whole = [("a.py", "f", False), ("b.py", "g", False), ("c.py", "H.h", False)]
    assert not faults(whole, trees, sources)
    assert faults([whole[0], whole[2]], trees, sources) == ["no earlier step names H.h of c.py"]
    assert faults([whole[0], ("b.py", "gone", True)], trees, sources) == ["b.py has no gone"]
