"""Cells of tables that people open in a spreadsheet: text that a spreadsheet would run as a formula stays text."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping

__all__ = ["as_cell", "as_row"]

_FORMULA = re.compile("^[ \u00a0]*[=+\\-@\t\r\n\uff1d\uff0b\uff0d\uff20]")
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?")


def as_cell(value: object) -> object:
    """Return a value for a cell; text that begins like a formula gets an apostrophe before it, numbers never."""
    if isinstance(value, str) and _FORMULA.match(value) and not _NUMBER.fullmatch(value):
        return f"'{value}"
    return value


def as_row(row: Mapping[str, object], columns: Iterable[str]) -> list[object]:
    """Return the cells of a row by the names of its columns; "" where it has none."""
    return [as_cell(row.get(name, "")) for name in columns]
