"""Inputs of a replay from a run, and the comparison of its outputs with the recorded ones.

The replay itself, which feeds these inputs through the tick function of the live loop, is part of haptic rendering.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.errors import PartialDataError
from mimics_app.contracts.loop.haptic import EVENT
from mimics_app.contracts.loop.object_rows import Rows
from mimics_app.recording.columns import OUTPUT_FIELDS, field_columns, name_of, rows_of
from mimics_app.recording.older_blocks import current_block
from mimics_app.recording.run import Run
from mimics_app.recording.statics import Statics, read_statics

__all__ = ["Difference", "ReplayData", "compare", "compare_events", "gather"]


_WIDTHS = {name: int(np.prod(EVENT[name].shape)) for name in EVENT.names or () if name != "t_ns"}
_EVENT_COLUMNS = [name for name, width in _WIDTHS.items() for _ in range(width)]


@dataclass(frozen=True, slots=True)
class ReplayData:
    """Inputs of every tick.

    Attributes:
        samples: SAMPLE records, shape [n]; a replay reads their input fields only (`Replay.INPUT`).
        blocks: SCENE record [shape 1] by sequence; the sample of a tick says which one it used.
        rows: The tables of haptic objects beside each of them.
        statics: Data of the objects that the loop receives once.
    """

    samples: NDArray[Any]
    blocks: dict[int, NDArray[Any]]
    rows: dict[int, Rows] = field(default_factory=dict)
    statics: Statics | None = None


@dataclass(frozen=True, slots=True)
class Difference:
    """The first output that differs in a replay.

    Attributes:
        tick: Tick of the output.
        column: Name of the output, e.g. "f_user_world[1]" or "event 3, force".
        recorded, replayed: The two values.
        count: Number of values that differ in the whole run.
    """

    tick: int
    column: str
    recorded: float
    replayed: float
    count: int

    def __str__(self) -> str:
        return (
            f"tick {self.tick}, {self.column}: recorded {self.recorded!r}, replayed {self.replayed!r} "
            f"({self.count} values differ)"
        )


def gather(run: Run) -> ReplayData:
    """Return the inputs of a replay.

    A run that was cut off can be replayed up to its end. One with a gap cannot: the loop's state after it is unknown.

    Raises:
        PartialDataError: Ticks or parameter blocks are missing, or the run is of a version with other parameters.
    """
    samples = run.haptic
    if len(samples) == 0:
        raise PartialDataError(f"{run.folder} holds no tick", "; ".join(run.losses()))
    if not run.layout.replayable:
        raise PartialDataError(f"{run.folder} was recorded with other columns", "replay it with the version it names")
    if run.gaps:
        gap = run.gaps[0]
        raise PartialDataError(
            f"{run.folder}: {gap.ticks} ticks are missing after tick {gap.after_tick} ({gap.why})",
            "a run with a hole cannot be replayed",
        )
    blocks = run.parameters
    wanted = {int(sequence) for sequence in np.unique(samples["sequence"])} - {0}  # 0: nothing was published yet
    if missing := sorted(wanted - set(blocks)):
        raise PartialDataError(f"{run.folder}: parameter block {missing[0]} is missing", "it cannot be replayed")
    current = {sequence: current_block(blocks[sequence], run.rows.get(sequence)) for sequence in sorted(wanted)}
    known = {sequence: block for sequence, block in current.items() if block is not None}
    if len(known) < len(current):
        version = run.session.get("versions", {}).get("mimics_app", "another version")
        raise PartialDataError(f"{run.folder} was recorded by {version}, whose parameters differ", "use that version")
    rows = {sequence: run.rows[sequence] for sequence in sorted(wanted) if sequence in run.rows}
    return ReplayData(samples, known, rows, read_statics(run.folder))


def compare(recorded: NDArray[Any], replayed: NDArray[Any], absent: Sequence[str] = ()) -> Difference | None:
    """Return the first output that is not bit-identical, in the order of ticks and columns; None without one.

    Args:
        recorded: SAMPLE records, shape [n].
        replayed: SAMPLE records, shape [n], the same ticks.
        absent: Names of columns that are left out, see `SampleLayout.uncompared`.

    Raises:
        ValueError: They do not cover the same number of ticks.
    """
    if len(recorded) != len(replayed):
        raise ValueError(f"{len(recorded)} recorded and {len(replayed)} replayed ticks cannot be compared")
    one, other = rows_of(recorded), rows_of(replayed)
    places = [int(each) for each in field_columns(OUTPUT_FIELDS) if each < one.shape[1]]
    columns = np.array([each for each in places if name_of(each) not in absent])
    one, other = one[:, columns], other[:, columns]
    differs = one.view(np.uint64) != other.view(np.uint64)
    if not differs.any():
        return None
    row, column = np.unravel_index(int(differs.argmax()), differs.shape)
    return Difference(
        tick=int(recorded["tick"][row]),
        column=name_of(int(columns[column])),
        recorded=float(one[row, column]),
        replayed=float(other[row, column]),
        count=int(differs.sum()),
    )


def compare_events(recorded: NDArray[Any], replayed: NDArray[Any], end: int) -> Difference | None:
    """Return the first event of the loop that is missing, additional or different; None without one.

    The monotonic time of a live loop is not compared. Numbers that are not finite are equal: JSON has null for all.

    Args:
        recorded: EVENT records, shape [n].
        replayed: EVENT records, shape [m].
        end: Events from this tick on are not compared: a run that was cut off may have lost some of them.
    """
    one, other = (events[events["tick"] < end] for events in (recorded, replayed))
    length = min(len(one), len(other))
    a, b = _numbers(one[:length]), _numbers(other[:length])
    differs = (a != b) & ~(np.isnan(a) & np.isnan(b))
    if differs.any():
        row, column = np.unravel_index(int(differs.argmax()), differs.shape)
        name = f"event {row}, {_EVENT_COLUMNS[column]}"
        count = int(differs.any(axis=1).sum())
        return Difference(int(one["tick"][row]), name, float(a[row, column]), float(b[row, column]), count)
    if len(one) != len(other):
        tick = int((one if len(one) > length else other)["tick"][length])
        return Difference(tick, "number of events", len(one), len(other), abs(len(one) - len(other)))
    return None


def _numbers(events: NDArray[Any]) -> NDArray[np.float64]:
    """Return the compared values of EVENT records, shape [n, columns]; infinities become NaN."""
    columns = [events[name].astype(np.float64).reshape(len(events), _WIDTHS[name]) for name in _WIDTHS]
    numbers = np.concatenate(columns, axis=1)
    numbers[~np.isfinite(numbers)] = np.nan
    return numbers
