"""A recording as numpy arrays with units: `mimics_app.load(RUN)`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from mimics_app.app.api.tables import haptic_table, journal_table, seconds_since, table_of_rows
from mimics_app.app.api.unit_array import Quantity, Table
from mimics_app.dsp.channel_kinds import feature_units
from mimics_app.recording.haptic_columns import HapticColumns
from mimics_app.recording.run import Run
from mimics_app.recording.series import SIGNAL_UNITS

__all__ = ["Recording", "Signal", "load"]


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
        return haptic_table(self.run.layout.extent, HapticColumns(self.run).read)

    @cached_property
    def events(self) -> Table:
        """Lines of the journal in order: `t_s` since the first tick, `source`, `kind`, and every value they have.

        A value that a kind does not have is NaN, or "" for text. Vectors are columns of shape [rows, k].
        """
        return journal_table(self.run.lines, self.run.start_ns)

    @cached_property
    def trials(self) -> Table:
        """Attempts at trials, the columns of trials.csv."""
        return table_of_rows(self.run.trials, {})

    @cached_property
    def features(self) -> Table:
        """Features of body signals, a row for each second: `t_s`, and each feature; NaN while it is unknown."""
        start_ns, lines = self.run.start_ns, self.run.lines_of("app", "features")
        rows = [{"t_s": seconds_since(start_ns, line["t_ns"]), **line["values"]} for line in lines]
        return table_of_rows(rows, {"t_s": "s", **feature_units()})

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

    def __repr__(self) -> str:
        return f"<recording {self.folder}, {self.run.status}>"


def load(run: Path | str) -> Recording:
    """Read a recording, also one that a crash cut off or of another version.

    Args:
        run: The run folder.

    Returns:
        The recording; `problems` lists what it lacks.

    Raises:
        SceneError: It is not a run folder.
    """
    return Recording(Run.open(run))
