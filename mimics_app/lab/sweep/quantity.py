"""Experiments of a sweep: their parameters, and a function over many points at once."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from mimics_app.contracts.errors import Issue

__all__ = ["Columns", "Kind", "Quantity", "SweepExperiment"]

Kind = Literal["float", "int", "text", "bool"]
Value = float | int | str

Columns = Mapping[str, Sequence[Any]]
"""Values by name, one for each point."""


@dataclass(frozen=True, slots=True)
class Quantity:
    """One parameter of an experiment.

    Attributes:
        kind: Type of its values.
        unit: Unit of its values; "" for none.
        default: Value where the sweep gives none; None: the sweep must give one.
        low: Smallest valid value.
        high: Largest valid value.
        choices: Valid texts; () for any.
    """

    kind: Kind
    unit: str
    default: Value | None
    low: float = float("-inf")
    high: float = float("inf")
    choices: tuple[str, ...] = ()

    def __str__(self) -> str:
        """Return a text such as "float [N/m], 0 to 1e+09, default 1000"."""
        bounds = [("from ", self.low), ("to ", self.high)]
        limits = " ".join(f"{word}{bound:g}" for word, bound in bounds if math.isfinite(bound))
        words = " | ".join(choice or '""' for choice in self.choices)
        default = "" if self.default is None else f"default {self.default}" if self.default != "" else 'default ""'
        unit = f" [{self.unit}]" if self.unit else ""
        return ", ".join(part for part in (f"{self.kind}{unit}", limits, words, default) if part)

    def as_dict(self) -> dict[str, Any]:
        """Return plain values for JSON, without those that do not apply."""
        bounds = {name: bound for name, bound in (("low", self.low), ("high", self.high)) if math.isfinite(bound)}
        said = {"unit": self.unit or None, "default": self.default, "choices": list(self.choices) or None}
        return {"kind": self.kind, **bounds, **{name: item for name, item in said.items() if item is not None}}


@dataclass(frozen=True, slots=True)
class SweepExperiment:
    """An experiment of a sweep.

    Attributes:
        name: Name in the sweep file.
        what: Description in one line.
        parameters: Parameters by name.
        results: Type of each column of results, by name with its unit.
        chunk: Number of points that together take well above 100 ms.
        run: Pure function of the parameters of points and the folder of files that they name; returns the results.
        open_prefix: Prefix of parameters of type "float" that only `check` knows; "" for none.
        check: Function of the values of each parameter (of a range its ends) and the sweep file; returns faults beyond
            single values, and a digest of the files that the values name.
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
        """Return the parameter of a name, None where the experiment has none."""
        if self.open_prefix and name.startswith(self.open_prefix) and name != self.open_prefix:
            return Quantity("float", "", None)
        return self.parameters.get(name)

    def kind(self, name: str) -> Kind:
        """Return the type of a parameter's values.

        Raises:
            KeyError: The experiment has no such parameter.
        """
        quantity = self.quantity(name)
        if quantity is None:
            raise KeyError(f'"{self.name}" has no parameter "{name}"')
        return quantity.kind

    def as_dict(self) -> dict[str, Any]:
        """Return parameters and results for `mimics sweep --list --json`."""
        return {
            "name": self.name,
            "what": self.what,
            "parameters": {name: quantity.as_dict() for name, quantity in self.parameters.items()},
            "open_prefix": self.open_prefix,
            "results": dict(self.results),
        }
