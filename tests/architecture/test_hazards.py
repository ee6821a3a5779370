"""The tables of hazards and of faults name the tests that carry their ids, and no others."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
TESTS = ROOT / "tests"
PAGES = {"requirement": ROOT / "docs" / "hazards.md", "fault": ROOT / "docs" / "faults.md"}


def carried(marker: str) -> Iterator[tuple[str, str]]:
    """Yield (id, test) of every marker."""
    for path in TESTS.rglob("test_*.py"):
        text = path.read_text(encoding="utf-8")
        if f"mark.{marker}" not in text:
            continue
        for node in ast.parse(text).body:
            if isinstance(node, ast.FunctionDef):
                for mark in node.decorator_list:
                    if ast.unparse(mark).startswith(f"pytest.mark.{marker}("):
                        assert isinstance(mark, ast.Call)
                        (named,) = [*mark.args, *(keyword.value for keyword in mark.keywords)]
                        assert isinstance(named, ast.Constant)
                        yield str(named.value), f"{path.relative_to(TESTS).as_posix()}::{node.name}"


def stated(marker: str) -> Iterator[tuple[str, str]]:
    """Yield (id, test) of every row of the page."""
    for line in PAGES[marker].read_text(encoding="utf-8").splitlines():
        if re.match(r"\| [RF]\d+ \|", line):
            cells = [cell.strip() for cell in line.strip("|").split("|")]
            names = re.findall(r"`([^`]+)`", cells[-1])
            assert names and all(cells), f"an empty cell: {line}"
            yield from ((cells[0], name) for name in names)


@pytest.mark.parametrize("marker", PAGES)
def test_the_table_and_the_tests_name_the_same(marker: str) -> None:
    assert sorted(carried(marker)) == sorted(stated(marker))


@pytest.mark.parametrize("marker", PAGES)
def test_ids_are_in_order(marker: str) -> None:
    ids = [each for each, _ in stated(marker)]
    assert ids == sorted(ids) and len(set(ids)) > 15
