"""What a sweep may vary: the parameters of an experiment, and the experiment as a function over many points at once."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from mimics_app.contracts.errors import Issue

__all__ = ["Columns", "Kind", "Quantity", "SweepExperiment"]

Kind = Literal["float", "int", "text", "bool"]
Value = float | int | str

Columns = Mapping[str, Sequence[Any]]
"""Values by name, one for each point; all of one length."""


@dataclass(frozen=True, slots=True)
class Quantity:
    """One parameter of an experiment.

    Attributes:
        kind: Of its values.
        unit: Of them; "" for none.
        default: Where the sweep does not say; None: it has to.
        low: Smallest value allowed.
        high: Largest value allowed.
        choices: The words allowed; () for any.
    """

    kind: Kind
    unit: str
    default: Value | None
    low: float = float("-inf")
    high: float = float("inf")
    choices: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class SweepExperiment:
    """An experiment as a sweep runs it.

    Attributes:
        name: As the sweep file calls it.
        what: One line.
        parameters: By name.
        results: Kind of each column it adds, by name with its unit.
        chunk: Points that together take well above 100 ms.
        run: From the parameters of some points, and the folder that files they name are relative to, to their results;
            a pure function of both.
        open_prefix: Parameters that begin so are let through, as "float", for `check` to judge; "" for none.
        check: From the values each parameter takes (of a range its ends) and the sweep file: faults beyond single
            values, and a digest of every file they name.
    """

    name: str
    what: str
    parameters: Mapping[str, Quantity]
    results: Mapping[str, Kind]
    chunk: int
    run: Callable[[Columns, Path], Columns]
    open_prefix: str = ""
    check: Callable[[Columns, Path], tuple[list[Issue], str]] = lambda values, file: ([], "")

    def quantity(self, name: str) -> Quantity | None:
        """The parameter of a name, None where the experiment has none."""
        if self.open_prefix and name.startswith(self.open_prefix) and name != self.open_prefix:
            return Quantity("float", "", None)
        return self.parameters.get(name)
