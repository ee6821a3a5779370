"""What a sweep may vary: the parameters of an experiment, and the experiment as a function over many points at once."""

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

    def __str__(self) -> str:
        """For people: "float [N/m], 0 to 1e+09, default 1000"."""
        bounds = [("from ", self.low), ("to ", self.high)]
        limits = " ".join(f"{word}{bound:g}" for word, bound in bounds if math.isfinite(bound))
        words = " | ".join(choice or '""' for choice in self.choices)
        default = "" if self.default is None else f"default {self.default}" if self.default != "" else 'default ""'
        unit = f" [{self.unit}]" if self.unit else ""
        return ", ".join(part for part in (f"{self.kind}{unit}", limits, words, default) if part)

    def as_dict(self) -> dict[str, Any]:
        """For programs; bounds, unit, default and choices only where there are any."""
        bounds = {name: bound for name, bound in (("low", self.low), ("high", self.high)) if math.isfinite(bound)}
        said = {"unit": self.unit or None, "default": self.default, "choices": list(self.choices) or None}
        return {"kind": self.kind, **bounds, **{name: item for name, item in said.items() if item is not None}}


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

    def as_dict(self) -> dict[str, Any]:
        """What a sweep file may say of it, and what it answers, for `mimics sweep --list --json`."""
        return {
            "name": self.name,
            "what": self.what,
            "parameters": {name: quantity.as_dict() for name, quantity in self.parameters.items()},
            "open_prefix": self.open_prefix,
            "results": dict(self.results),
        }
