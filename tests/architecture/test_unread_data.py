"""What is written is read: fields of the loop's records, and attributes of objects that only the product sets."""

from __future__ import annotations

import ast
from collections import Counter
from collections.abc import Iterator

import pytest

from mimics_app.contracts.loop.loop_fields import LOOP_FIELDS
from tests.architecture.record_stub import STUBS
from tests.architecture.sources import modules, nodes

READ_ELSEWHERE = {}
"""Fields of records that no module of the product reads, and why they are there."""

SET_FOR_OTHERS = {
    "action_space": "gymnasium reads it",
    "composed": "the picture of a simulated headset, which stands in for its panels",
    "uploaded": "bytes sent to the driver in the last update, for whoever measures",
    "_finalized": "numba reads it",
}
"""Attributes that the product sets on its own objects and does not read, and who does."""


def _records() -> dict[str, dict[str, str]]:
    """Fields of every record and their types, as the stubs have them."""
    return {
        node.name: {
            row.target.id: ast.unparse(row.annotation)
            for row in node.body
            if isinstance(row, ast.AnnAssign) and isinstance(row.target, ast.Name)
        }
        for stub in STUBS
        for node in ast.parse(stub.read_text(encoding="utf-8")).body
        if isinstance(node, ast.ClassDef)
    }


class _Reads(ast.NodeVisitor):
    """Fields that are read: of a record where its type can be seen from the signature, else by the name alone."""

    def __init__(self, records: dict[str, dict[str, str]]) -> None:
        self.records, self.types = records, dict[str, str]()
        self.of_records: set[tuple[str, str]] = set()
        self.by_name: set[str] = set()

    def visit_FunctionDef(self, node: ast.FunctionDef) -> None:
        outer = self.types
        given = [*node.args.args, *node.args.kwonlyargs]
        self.types = {arg.arg: ast.unparse(arg.annotation) for arg in given if arg.annotation is not None}
        for one in ast.walk(node):
            if isinstance(one, ast.Assign) and len(one.targets) == 1 and isinstance(one.targets[0], ast.Name):
                name, type_ = one.targets[0].id, self._type_of(one.value)
                self.types[name] = type_ if self.types.get(name, type_) == type_ else ""
        self.generic_visit(node)
        self.types = outer

    def visit_Attribute(self, node: ast.Attribute) -> None:
        if isinstance(node.ctx, ast.Load):
            owner = self._type_of(node.value)
            if owner in self.records:
                self.of_records.add((owner, node.attr))
            else:
                self.by_name.add(node.attr)
        self.generic_visit(node)

    def visit_Subscript(self, node: ast.Subscript) -> None:
        if isinstance(node.ctx, ast.Load) and isinstance(node.slice, ast.Constant):
            self.by_name.add(str(node.slice.value))
        self.generic_visit(node)

    def _type_of(self, node: ast.expr) -> str:
        if isinstance(node, ast.Name):
            return self.types.get(node.id, "")
        if isinstance(node, ast.Attribute):
            return self.records.get(self._type_of(node.value), {}).get(node.attr, "")
        if isinstance(node, ast.Subscript):
            table = self._type_of(node.value)
            return table[len("Table[") : -1] if table.startswith("Table[") else ""
        return ""


def unread_fields(trees: list[ast.Module], records: dict[str, dict[str, str]]) -> list[str]:
    """Fields of records that nothing reads, as "Record.field"."""
    reads = _Reads(records)
    for tree in trees:
        reads.visit(tree)
    return [
        f"{record}.{field}"
        for record, fields in records.items()
        for field in fields
        if (record, field) not in reads.of_records and field not in reads.by_name
    ]


def _own_attributes(tree: ast.Module) -> Iterator[tuple[str, bool]]:
    """(name, whether it is read) of every attribute in a module; of those set, only on `self`."""
    for node in nodes(tree):
        if isinstance(node, ast.Attribute):
            own = isinstance(node.value, ast.Name) and node.value.id == "self"
            if isinstance(node.ctx, ast.Load) or own:
                yield node.attr, isinstance(node.ctx, ast.Load)
        elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in ("getattr", "hasattr"):
            yield from ((str(arg.value), True) for arg in node.args if isinstance(arg, ast.Constant))


def unread_attributes(trees: list[ast.Module]) -> list[str]:
    """Attributes set on `self` somewhere and read nowhere."""
    counts = Counter(pair for tree in trees for pair in _own_attributes(tree))
    return sorted(name for name, read in counts if not read and (name, True) not in counts)


@pytest.fixture(scope="module")
def fields() -> list[str]:
    """Fields of records that no module of the product reads."""
    return unread_fields(list(modules().values()), _records())


@pytest.fixture(scope="module")
def attributes() -> list[str]:
    """Attributes that the product sets on its own objects and does not read."""
    return unread_attributes(list(modules().values()))


def test_fields_of_records_are_read(fields: list[str]) -> None:
    published = {row.name for row in LOOP_FIELDS}
    rows = ("SampleRecord", "PointSampleRecord", "OwnTunnelRecord")  # whose fields leave the loop
    unread = [name for name in fields if name not in READ_ELSEWHERE]
    left = [name for name in unread if not (name.startswith(rows) and _leaves(name.partition(".")[2], published))]
    assert not left, f"written and never read: {left}; remove them, or say who reads them"


def _leaves(field: str, published: set[str]) -> bool:
    return field in published


def test_attributes_of_objects_are_read(attributes: list[str]) -> None:
    unread = [name for name in attributes if name not in SET_FOR_OTHERS]
    assert not unread, f"set and never read: {unread}; remove them, or say who reads them"


@pytest.mark.parametrize("allowed", [READ_ELSEWHERE, SET_FOR_OTHERS], ids=["fields", "attributes"])
def test_every_exception_is_one(allowed: dict[str, str], fields: list[str], attributes: list[str]) -> None:
    found = {*fields, *attributes}
    assert set(allowed) <= found, f"no exception: {sorted(set(allowed) - found)}"


def test_planted_fields_and_attributes_are_found() -> None:
    source = """
def loop(a: OneRecord, b: TwoRecord, c):
    a.seen += 1
    b.seen = a.kept
    self.alone = c.kept
    self.read = self.read + 1
"""
    records = {"OneRecord": {"seen": "int", "kept": "int"}, "TwoRecord": {"seen": "int", "kept": "int"}}
    tree = ast.parse(source)
    assert unread_fields([tree], records) == ["OneRecord.seen", "TwoRecord.seen"]
    assert unread_attributes([tree]) == ["alone"]
