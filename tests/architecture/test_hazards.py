"""Requirements of the hazard table are carried by the tests that it names, and by no others."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).parents[2]
TESTS = ROOT / "tests"
PAGE = ROOT / "docs" / "hazards.md"


def carried() -> Iterator[tuple[str, str]]:
    """Yield (requirement, test) of every marker."""
    for path in TESTS.rglob("test_*.py"):
        text = path.read_text(encoding="utf-8")
        if "mark.requirement" not in text:
            continue
        for node in ast.parse(text).body:
            if isinstance(node, ast.FunctionDef):
                for mark in node.decorator_list:
                    if ast.unparse(mark).startswith("pytest.mark.requirement("):
                        assert isinstance(mark, ast.Call) and isinstance(mark.args[0], ast.Constant)
                        yield str(mark.args[0].value), f"{path.relative_to(TESTS).as_posix()}::{node.name}"


def stated() -> Iterator[tuple[str, str]]:
    """Yield (requirement, test) of every row of the page."""
    for line in PAGE.read_text(encoding="utf-8").splitlines():
        if re.match(r"\| R\d+ \|", line):
            cells = [cell.strip() for cell in line.strip("|").split("|")]
            names = re.findall(r"`([^`]+)`", cells[-1])
            assert names and all(cells), f"an empty cell: {line}"
            yield from ((cells[0], name) for name in names)


def test_the_table_and_the_tests_name_the_same() -> None:
    assert sorted(carried()) == sorted(stated())


def test_ids_are_numbered_without_a_gap() -> None:
    ids = sorted({requirement for requirement, _ in stated()})
    assert ids == [f"R{i:02d}" for i in range(1, len(ids) + 1)]
