"""Table of the cost and error of every method, shipped with the product or measured and saved on a machine.

{"machine": {...}, "reference_us": {GROUP: us},
 "groups": {GROUP: [{"method", "cost_us", "ratio", "error", "unit", "settings"}]}}
"""

from __future__ import annotations

import json
import math
from collections.abc import Collection, Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from statistics import median
from typing import Any

from mimics_app.contracts.ports.methods import Settings
from mimics_app.contracts.system import resources
from mimics_app.contracts.system.regular_file import read_regular

__all__ = ["Row", "Table", "saved_file", "shipped_file"]

_MOST_BYTES = 16 << 20
"""Largest table; a longer file is no JSON to its end."""


@dataclass(frozen=True, slots=True)
class Row:
    """Figures of one method.

    Attributes:
        method: Name of the method.
        cost_us: Cost [us per call] on the table's machine.
        ratio: Cost as a multiple of the group's reference loop in the same run.
        error: Error in `unit`; infinite if the method fails on the measured input.
        unit: Unit of the error.
        settings: Settings to run it, as in `Method.settings`.
    """

    method: str
    cost_us: float
    ratio: float
    error: float
    unit: str
    settings: Settings = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Table:
    """Figures of all groups on one machine.

    Attributes:
        groups: Rows by group, in the order of the registry.
        machine: `Machine.as_dict()` of the measurement.
        reference_us: Cost of each group's reference loop [us per call].
    """

    groups: dict[str, list[Row]]
    machine: dict[str, Any]
    reference_us: dict[str, float]

    @classmethod
    def load_saved(cls) -> Table | None:
        """Load the table of this machine; None if there is none, or it cannot be read."""
        file = saved_file()
        if file is None or not file.is_file():
            return None
        try:
            return cls.load(file)
        except (OSError, ValueError, LookupError, TypeError, AttributeError, RecursionError):  # a new one is measured
            return None

    @classmethod
    def load_shipped(cls) -> Table:
        """Load the table of the product.

        Raises:
            OSError: The installation is incomplete.
        """
        return cls.load(shipped_file())

    @classmethod
    def load(cls, file: Path) -> Table:
        """Read a table.

        Raises:
            OSError: The file cannot be read.
            ValueError, LookupError, TypeError, AttributeError, RecursionError: The file is not a table.
        """
        data = json.loads(read_regular(file, _MOST_BYTES))
        groups = {group: [_row(row) for row in rows] for group, rows in data["groups"].items()}
        return cls(groups, data["machine"], data["reference_us"])

    def save(self, file: Path | None = None) -> Path | None:
        """Write the table atomically to a file, or to the file of this machine; None if there is no place for it.

        Raises:
            OSError: The folder cannot be written.
        """
        file = file or saved_file()
        if file is None:
            return None
        file.parent.mkdir(parents=True, exist_ok=True)
        partial = file.with_suffix(".partial")
        partial.write_text(json.dumps(self.as_dict(), indent=1, allow_nan=False) + "\n", encoding="utf-8")
        partial.replace(file)
        return file

    def with_groups(self, newer: Table) -> Table:
        """Return this table with the groups of a newer one in place of its own.

        The machine is the newer one's; the other groups were measured before.
        """
        return Table({**self.groups, **newer.groups}, newer.machine, {**self.reference_us, **newer.reference_us})

    def with_rows(self, group: str, rows: Sequence[Row]) -> Table:
        """Return this table with rows of further methods, their costs scaled by its own reference loop."""
        known = {row.method for row in self.groups.get(group, ())}
        loop_us = self.reference_us.get(group) or _middle(self.reference_us.values())
        added = [replace(row, cost_us=row.ratio * loop_us) for row in rows if row.method not in known]
        if not added:
            return self
        groups = {**self.groups, group: [*self.groups.get(group, ()), *added]}
        return Table(groups, self.machine, {group: loop_us, **self.reference_us})

    def as_dict(self) -> dict[str, Any]:
        """Return plain values; an infinite error is null, as JSON has no infinity."""
        groups = {
            group: [{**asdict(row), "error": row.error if math.isfinite(row.error) else None} for row in rows]
            for group, rows in self.groups.items()
        }
        return {"machine": self.machine, "reference_us": self.reference_us, "groups": groups}


def _middle(costs: Collection[float]) -> float:
    """Return the median of the groups' reference loops, the same loop timed beside each [us]; 1 for none."""
    return median(costs) if costs else 1.0


def saved_file() -> Path | None:
    """Return the file of this machine's table; None where nothing is writable."""
    from mimics_app.compiled.cache_folder import cache_folder
    from mimics_app.contracts.system.machine import machine_key

    return None if cache_folder is None else cache_folder.parent / f"methods-{machine_key()}.json"


def shipped_file() -> Path:
    """Return the file of the product's table."""
    return resources.root() / "assets" / "methods.json"


def _row(data: dict[str, Any]) -> Row:
    error = math.inf if data["error"] is None else float(data["error"])
    cost_us, ratio = float(data["cost_us"]), float(data["ratio"])
    return Row(str(data["method"]), cost_us, ratio, error, str(data["unit"]), dict(data["settings"]))
