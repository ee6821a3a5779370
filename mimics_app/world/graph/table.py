"""One component type as a structure of arrays: dense columns to compute on, and a sparse index by entity."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

from mimics_app.contracts.errors import require_key
from mimics_app.world.graph.entity_ids import grown

__all__ = ["ComponentTable"]

_FIRST_CAPACITY = 16
_NONE = -1


class ComponentTable:
    """Columns whose first axis is the row; rows 0..len-1 are in use, in no promised order (removal fills the hole).

    Args:
        columns: (dtype, shape of one row's value) by column name.
    """

    def __init__(self, **columns: tuple[DTypeLike, tuple[int, ...]]) -> None:
        self._columns: dict[str, NDArray[Any]] = {
            name: np.zeros((_FIRST_CAPACITY, *shape), dtype) for name, (dtype, shape) in columns.items()
        }
        self._entities = np.full(_FIRST_CAPACITY, _NONE, np.int32)
        self._rows = np.full(_FIRST_CAPACITY, _NONE, np.int32)
        self._count = 0

    def __len__(self) -> int:
        """Rows in use."""
        return self._count

    def __contains__(self, index: int) -> bool:
        """True when the entity of this index has a row."""
        return index < self._rows.shape[0] and self._rows[index] != _NONE

    @property
    def entities(self) -> NDArray[np.int32]:
        """Entity index of each row, int32 [rows]; a view."""
        return self._entities[: self._count]

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the columns."""
        return tuple(self._columns)

    def column(self, name: str) -> NDArray[Any]:
        """One column, [rows, ...]; a view, valid until the next `add`."""
        return self._columns[name][: self._count]

    def row(self, index: int) -> int:
        """Row of an entity.

        Raises:
            KeyError: it has none.
        """
        if index not in self:
            raise KeyError(f"entity {index} has no such component")
        return int(self._rows[index])

    def set(self, index: int, name: str, value: object) -> None:
        """Change the value of an entity in one column.

        Raises:
            KeyError: the entity has no row, or the table no such column.
            ValueError: the value is not a number.
        """
        _require_numbers(name, value)
        self._columns[name][self.row(index)] = value

    def add(self, index: int, **values: object) -> int:
        """Append a row for an entity, zero in columns not named, and return its number.

        Raises:
            ValueError: it has one already, or a value is not a number.
            KeyError: a name is not a column of the table.
        """
        if index in self:
            raise ValueError(f"entity {index} has that component already")
        for name, value in values.items():
            require_key(name, self._columns, "column")
            _require_numbers(name, value)
        row = self._count
        self._entities = grown(self._entities, row + 1, _NONE)
        self._rows = grown(self._rows, index + 1, _NONE)
        for name, column in self._columns.items():
            self._columns[name] = column = grown(column, row + 1)
            column[row] = values.get(name, 0)
        self._entities[row] = index
        self._rows[index] = row
        self._count += 1
        return row

    def remove(self, index: int) -> None:
        """Remove the row of an entity, if it has one; the last row fills the hole."""
        if index not in self:
            return
        row, last = int(self._rows[index]), self._count - 1
        moved = int(self._entities[last])
        for column in self._columns.values():
            column[row] = column[last]
        self._entities[row] = moved
        self._rows[moved] = row
        self._rows[index] = _NONE
        self._count = last

    def move(self, source: int, target: int) -> None:
        """Give the row of entity `source` to entity `target`.

        Raises:
            KeyError: the source has none.
            ValueError: the target has one.
        """
        row = self.row(source)
        if target in self:
            raise ValueError(f"entity {target} has that component already")
        self._rows = grown(self._rows, target + 1, _NONE)
        self._entities[row] = target
        self._rows[source] = _NONE
        self._rows[target] = row


def _require_numbers(name: str, value: object) -> None:
    """Refuse NaN: it would only be noticed in what is drawn or computed with it."""
    if np.isnan(np.asarray(value, np.float64)).any():
        raise ValueError(f"{name} is not a number: {value}")
