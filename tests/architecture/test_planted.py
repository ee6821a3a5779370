"""The list of planted faults fits the tree: `make planted` (long) plants them, this test keeps the list true."""

from __future__ import annotations

import ast
from functools import cache

from tests.planted.faults import ROOT, PlantedFault, read_faults

FAULTS = list(read_faults())
ENOUGH = 120


@cache
def source_of(file: str) -> str:
    return (ROOT / file).read_text(encoding="utf-8")


@cache
def names_of_tests(file: str) -> frozenset[str]:
    return frozenset(node.name for node in ast.walk(ast.parse(source_of(file))) if isinstance(node, ast.FunctionDef))


def problem_of(fault: PlantedFault) -> str:
    """What is wrong with an entry, or nothing."""
    file, _, rest = fault.test.partition("::")
    if not rest or rest.partition("[")[0] not in names_of_tests(file):
        return f"no test {fault.test}"
    try:
        planted = fault.plant(source_of(fault.file))
        if fault.file.endswith(".py"):
            ast.parse(planted)
    except (ValueError, SyntaxError) as error:
        return str(error)
    return "" if fault.planted != fault.line else "changes nothing"


def test_every_fault_can_be_planted_and_its_test_exists() -> None:
    assert {fault.name: problem for fault in FAULTS if (problem := problem_of(fault))} == {}


def test_the_list_is_long_and_no_fault_stands_in_it_twice() -> None:
    assert len(FAULTS) >= ENOUGH
    assert len({fault.name for fault in FAULTS}) == len(FAULTS)
    assert len({(fault.file, fault.line, fault.planted) for fault in FAULTS}) == len(FAULTS)
