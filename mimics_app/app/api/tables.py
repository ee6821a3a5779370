"""Tables of a session, the same of a recording and of one that is kept in memory: its ticks, and rows of any kind."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from mimics_app.app.api.unit_array import Quantity, Table
from mimics_app.contracts.arrays import F8
from mimics_app.contracts.loop.loop_fields import Extent
from mimics_app.recording.columns import RecordedField, recorded_fields

__all__ = ["haptic_table", "journal_table", "seconds_since", "table_of_rows"]

_SUFFIXES = (("_ns", "ns"), ("_s", "s"), ("_m", "m"), ("_n", "N"), ("_j", "J"), ("_mm", "mm"), ("_deg", "deg"))
_LINE_UNITS = {"t_s": "s", "force": "N", "speed": "m/s", "position_world": "m"}


class _HapticFields(Mapping[str, Quantity]):
    """Fields of the haptic stream by name, each read at its first use.

    Attributes:
        units: Unit of each.

    Args:
        extent: What the device fills.
        read: Returns recorded columns by their indices, shape [ticks, columns].
    """

    def __init__(self, extent: Extent, read: Callable[[Sequence[int]], F8]) -> None:
        self._read, self._found = read, dict[str, Quantity]()
        self._places: dict[str, tuple[int, RecordedField]] = {}
        first = 0
        for field in recorded_fields(extent):
            self._places[field.name] = (first, field)
            first += len(field.units)
        self.units = {name: ", ".join(dict.fromkeys(field.units)) for name, (_, field) in self._places.items()}

    def __getitem__(self, name: str) -> Quantity:
        if name not in self._found:
            first, field = self._places[name]
            values = self._read(range(first, first + len(field.units)))
            self._found[name] = Quantity(values if field.vector else values[:, 0], self.units[name])
        return self._found[name]

    def __contains__(self, name: object) -> bool:
        return name in self._places  # without reading it

    def __iter__(self) -> Iterator[str]:
        return iter(self._places)

    def __len__(self) -> int:
        return len(self._places)


def haptic_table(extent: Extent, read: Callable[[Sequence[int]], F8]) -> Table:
    """Return the table of every tick, a row each millisecond; `read` returns columns by their indices."""
    columns = _HapticFields(extent, read)
    return Table(columns, columns.units)


def journal_table(lines: list[dict[str, Any]], start_ns: int) -> Table:
    """Return the table of the journal's lines, `t_s` since `start_ns` first."""
    return table_of_rows([{"t_s": seconds_since(start_ns, line.get("t_ns")), **line} for line in lines], _LINE_UNITS)


def seconds_since(start_ns: int, t_ns: object) -> float:
    """Return a time of a line [s]; NaN where it has none."""
    return (t_ns - start_ns) * 1e-9 if isinstance(t_ns, int) else np.nan


def table_of_rows(rows: list[dict[str, Any]], units: Mapping[str, str]) -> Table:
    """Return the values of rows as columns: numbers and vectors as float64, else text; structures are left out."""
    names = dict.fromkeys(name for row in rows for name in row)
    made = {name: _column([row.get(name) for row in rows], units.get(name, _unit_by(name))) for name in names}
    return Table({name: column for name, column in made.items() if column is not None})


def _column(cells: list[Any], unit: str) -> Quantity | None:
    found = [cell for cell in cells if cell is not None]
    if any(isinstance(cell, str) for cell in found):
        return Quantity(["" if cell is None else str(cell) for cell in cells])
    if all(isinstance(cell, (int, float)) for cell in found):
        return Quantity(np.array([np.nan if cell is None else float(cell) for cell in cells]), unit)
    sizes = {len(cell) if _is_vector(cell) else 0 for cell in found}
    if len(sizes) != 1 or 0 in sizes:
        return None
    empty = [np.nan] * sizes.pop()
    return Quantity(np.array([empty if cell is None else cell for cell in cells], float), unit)


def _is_vector(cell: object) -> bool:
    return isinstance(cell, list) and all(isinstance(each, (int, float)) for each in cell)


def _unit_by(name: str) -> str:
    """Return the unit that the last letters of a column name state."""
    return next((unit for suffix, unit in _SUFFIXES if name.endswith(suffix)), "1")
