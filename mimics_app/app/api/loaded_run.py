"""A recording as numpy arrays with units: `mimics_app.load(RUN)`."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from mimics_app.app.api.unit_array import Quantity, Table
from mimics_app.dsp.channel_kinds import feature_units
from mimics_app.recording.columns import RecordedField, recorded_fields
from mimics_app.recording.haptic_columns import HapticColumns
from mimics_app.recording.run import Run
from mimics_app.recording.series import SIGNAL_UNITS

__all__ = ["Recording", "Signal", "load"]

_SUFFIXES = (("_ns", "ns"), ("_s", "s"), ("_m", "m"), ("_n", "N"), ("_j", "J"), ("_mm", "mm"), ("_deg", "deg"))
_LINE_UNITS = {"t_s": "s", "force": "N", "speed": "m/s", "position_world": "m"}


@dataclass(frozen=True, slots=True)
class Signal:
    """One body signal.

    Attributes:
        t_s: Time of each sample since the first tick [s], shape [n].
        values: Samples with their unit, shape [n]; NaN where one is missing.
        rate: Sampling rate [Hz].
    """

    t_s: Quantity
    values: Quantity
    rate: float


class _HapticFields(Mapping[str, Quantity]):
    """Fields of the haptic stream by name, each read at its first use.

    Attributes:
        units: Unit of each.

    Args:
        run: The run.
    """

    def __init__(self, run: Run) -> None:
        self._columns, self._found = HapticColumns(run), dict[str, Quantity]()
        self._places: dict[str, tuple[int, RecordedField]] = {}
        first = 0
        for field in recorded_fields(run.layout.extent):
            self._places[field.name] = (first, field)
            first += len(field.units)
        self.units = {name: ", ".join(dict.fromkeys(field.units)) for name, (_, field) in self._places.items()}

    def __getitem__(self, name: str) -> Quantity:
        if name not in self._found:
            first, field = self._places[name]
            values = self._columns.read(range(first, first + len(field.units)))
            self._found[name] = Quantity(values if field.vector else values[:, 0], self.units[name])
        return self._found[name]

    def __contains__(self, name: object) -> bool:
        return name in self._places  # without reading it

    def __iter__(self) -> Iterator[str]:
        return iter(self._places)

    def __len__(self) -> int:
        return len(self._places)


class Recording:
    """One run folder, whole or cut off; nothing is read before it is asked for.

    Attributes:
        run: The reader of the folder's files, for whatever is not an array.
    """

    def __init__(self, run: Run) -> None:
        self.run = run

    @property
    def folder(self) -> Path:
        """The run folder."""
        return self.run.folder

    @property
    def session(self) -> Mapping[str, Any]:
        """Seed, scene, settings, methods, versions and clocks of the session."""
        return self.run.session

    @property
    def problems(self) -> list[str]:
        """What is missing or damaged, one sentence each; [] for a whole run."""
        return self.run.problems()

    @cached_property
    def haptic(self) -> Table:
        """Every tick of the loop, one row a millisecond: columns as in docs/recording.md, SI units; read one by one.

        Points of contact after the first are in columns as "point_1_hip_world".
        """
        columns = _HapticFields(self.run)
        return Table(columns, columns.units)

    @cached_property
    def events(self) -> Table:
        """Lines of the journal in order: `t_s` since the first tick, `source`, `kind`, and every value they have.

        A value that a kind does not have is NaN, or "" for text. Vectors are columns of shape [rows, k].
        """
        lines = [{"t_s": self._seconds(line.get("t_ns")), **line} for line in self.run.lines]
        return _table_of(lines, _LINE_UNITS)

    @cached_property
    def trials(self) -> Table:
        """Attempts at trials, the columns of trials.csv."""
        return _table_of(self.run.trials, {})

    @cached_property
    def features(self) -> Table:
        """Features of body signals, a row for each second: `t_s`, and each feature; NaN while it is unknown."""
        rows = [{"t_s": self._seconds(line["t_ns"]), **line["values"]} for line in self.run.lines_of("app", "features")]
        return _table_of(rows, {"t_s": "s", **feature_units()})

    @cached_property
    def signals(self) -> dict[str, Signal]:
        """Raw body signals by name."""
        blocks: dict[str, list[Any]] = {}
        for row in self.run.signals:
            blocks.setdefault(row.block.name, []).append(row.block)
        return {name: self._signal(name, found) for name, found in blocks.items()}

    def _signal(self, name: str, blocks: list[Any]) -> Signal:
        rate = float(blocks[0].rate)
        times = [(b.t_ns - self.run.start_ns) * 1e-9 + np.arange(len(b.values)) / b.rate for b in blocks]
        values = np.concatenate([np.asarray(b.values, float) for b in blocks])
        return Signal(Quantity(np.concatenate(times), "s"), Quantity(values, SIGNAL_UNITS.get(name, "")), rate)

    def _seconds(self, t_ns: object) -> float:
        return (t_ns - self.run.start_ns) * 1e-9 if isinstance(t_ns, int) else np.nan

    def __repr__(self) -> str:
        return f"<recording {self.folder}, {self.run.status}>"


def load(run: Path | str) -> Recording:
    """Read a recording, also one that a crash cut off or of another version.

    Args:
        run: The run folder.

    Returns:
        The recording; `problems` lists what it lacks.

    Raises:
        SceneError: It is no run folder.
    """
    return Recording(Run.open(run))


def _table_of(rows: list[dict[str, Any]], units: Mapping[str, str]) -> Table:
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
