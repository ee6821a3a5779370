"""Arrays with a unit, and tables of them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mimics_app.contracts.errors import UsageError, nearest

__all__ = ["Quantity", "Table"]


class Quantity(np.ndarray[Any, np.dtype[Any]]):
    """An array that knows its unit; a slice of it has the same, a result of arithmetic has none stated.

    Attributes:
        units: Unit, as "N"; "1" for a number without one, "" for text or where none is stated.
    """

    units: str

    def __new__(cls, values: ArrayLike, units: str = "") -> Self:
        """Return a view of `values` with a unit."""
        made = np.asarray(values).view(cls)
        made.units = units
        return made

    def __array_finalize__(self, source: NDArray[Any] | None) -> None:
        self.units = getattr(source, "units", "")

    def __array_wrap__(self, array: NDArray[Any], context: object = None, return_scalar: bool = False) -> Any:
        """Return plain numbers from arithmetic: the unit of a product is not that of a factor."""
        return array[()] if return_scalar else np.asarray(array)


class Table(Mapping[str, Quantity]):
    """Columns by name, all with the same number of rows.

    Args:
        columns: Arrays of shape [rows] or [rows, k].
        units: Unit of each column, where reading the columns takes time; None: as they say.
    """

    def __init__(self, columns: Mapping[str, Quantity], units: Mapping[str, str] | None = None) -> None:
        self._columns = columns
        self._units = units

    @property
    def rows(self) -> int:
        """Number of rows."""
        return next((len(column) for column in self._columns.values()), 0)

    @property
    def units(self) -> dict[str, str]:
        """Unit of each column."""
        return {name: self[name].units for name in self} if self._units is None else dict(self._units)

    def where(self, **wanted: object) -> Table:
        """Return the rows whose columns have these values, as `events.where(kind="contact_begin")`.

        Raises:
            UsageError: There is no column of such a name.
        """
        chosen = np.ones(self.rows, bool)
        for name, value in wanted.items():
            chosen &= np.asarray(self[name] == value)
        return Table({name: Quantity(column[chosen], column.units) for name, column in self._columns.items()})

    def to_pandas(self) -> Any:
        """Return a pandas DataFrame; a column of k numbers becomes NAME[0] .. NAME[k-1]; units are in `attrs`.

        Raises:
            UsageError: pandas is not installed.
        """
        try:
            import pandas
        except ImportError as error:
            raise UsageError("pandas is not installed", "pip install pandas") from error
        flat = {part: values for name in self for part, values in _parts(name, self[name])}
        frame = pandas.DataFrame(flat)
        frame.attrs["units"] = self.units
        return frame

    def to_xarray(self) -> Any:
        """Return an xarray Dataset over the dimension "row", with the attribute `units` of each variable.

        Raises:
            UsageError: xarray is not installed.
        """
        try:
            import xarray
        except ImportError as error:
            raise UsageError("xarray is not installed", "pip install xarray") from error
        variables = {
            name: (("row", f"{name}_axis")[: column.ndim], np.asarray(column), {"units": column.units})
            for name, column in self._columns.items()
        }
        return xarray.Dataset(variables)

    def __getitem__(self, name: str) -> Quantity:
        if name not in self._columns:
            raise UsageError(f'there is no column "{name}"', nearest(name, self._columns))
        return self._columns[name]

    def __contains__(self, name: object) -> bool:
        return name in self._columns

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)

    def __repr__(self) -> str:
        return f"<{self.rows} rows of {', '.join(self._columns)}>"


def _parts(name: str, column: Quantity) -> list[tuple[str, NDArray[Any]]]:
    if column.ndim == 1:
        return [(name, np.asarray(column))]
    return [(f"{name}[{i}]", np.asarray(column[:, i])) for i in range(column.shape[1])]
