"""Tables of events and attempts of a recording as columns: what exporters write beside the series."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping, Sequence
from operator import itemgetter
from typing import Any, overload

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.clock import SECOND_NS
from mimics_app.recording.run import Run
from mimics_app.recording.series import Series

__all__ = [
    "Column",
    "Rows",
    "attempts_table",
    "columns_of",
    "event_kinds",
    "event_rows",
    "gaps_table",
    "safe_cell",
    "text_of",
    "timed_events",
]

Column = F8 | list[str]
"""Numbers of shape [n], vectors of shape [n, k], or texts; a missing number is NaN, a missing text is empty."""

Rows = Sequence[Mapping[str, Any]]

_FORMULA = re.compile("^[ \u00a0]*[=+\\-@\t\r\n\uff1d\uff0b\uff0d\uff20]")
"""Beginning of a text that a spreadsheet runs as a formula, blanks aside."""
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?")


def event_kinds(run: Run) -> list[tuple[str, str]]:
    """Return source and kind of the events of a recording, in the order of their first lines."""
    return list(dict.fromkeys((line["source"], line["kind"]) for line in run.lines))


class _TimedLines(Sequence[Mapping[str, Any]]):
    """Lines of events.jsonl, each with its time since tick 0 [s] in front where it has one.

    A row is made when it is asked for: an hour has 216,000 lines of frames.
    """

    def __init__(self, lines: Sequence[Mapping[str, Any]], start_ns: int) -> None:
        self._lines, self._start_ns = lines, start_ns

    def __len__(self) -> int:
        return len(self._lines)

    @overload
    def __getitem__(self, number: int) -> Mapping[str, Any]: ...

    @overload
    def __getitem__(self, number: slice) -> Sequence[Mapping[str, Any]]: ...

    def __getitem__(self, number: int | slice) -> Mapping[str, Any] | Sequence[Mapping[str, Any]]:
        if isinstance(number, slice):
            return _TimedLines(self._lines[number], self._start_ns)
        line = self._lines[number]
        t_ns = line.get("t_ns")
        return {"t_s": (t_ns - self._start_ns) / SECOND_NS, **line} if isinstance(t_ns, int) else line


def event_rows(run: Run, source: str, kind: str) -> Rows:
    """Return the events of a kind, each with its time since tick 0 [s] in front where it has one."""
    return _TimedLines(run.lines_of(source, kind), run.start_ns)


def timed_events(run: Run, *, frames: bool = True) -> Rows:
    """Return the events that have a time, in its order, with or without the frames, of which there are 60 a second."""
    kinds = [kind for kind in event_kinds(run) if frames or kind != ("app", "frame")]
    timed = [line for kind in kinds for line in run.lines_of(*kind) if isinstance(line.get("t_ns"), int)]
    return _TimedLines(sorted(timed, key=itemgetter("t_ns")), run.start_ns)


def attempts_table(run: Run) -> list[dict[str, Any]]:
    """Return the rows of trials.csv, each with begin and end since tick 0 [s] where it has them."""
    rows = []
    for row in run.trials:
        times = {
            f"{name}_s": (row[f"{name}_ns"] - run.start_ns) / SECOND_NS
            for name in ("begin", "end")
            if isinstance(row.get(f"{name}_ns"), int)
        }
        rows.append({**times, **row})
    return rows


def gaps_table(series: Sequence[Series]) -> list[dict[str, Any]]:
    """Return the gaps of series that were read: series, begin and end [s], reason."""
    return [
        {"series": each.name, "begin_s": begin, "end_s": end, "why": why}
        for each in series
        for begin, end, why in each.gaps()
    ]


def columns_of(rows: Rows) -> Iterator[tuple[str, Column]]:
    """Yield name and values of each column: numbers and vectors of one length as float64, all else as text."""
    for name in dict.fromkeys(name for row in rows for name in row):
        yield name, _column([row.get(name) for row in rows])


def text_of(value: object) -> str:
    """Return a value as text: "" for None, texts as they are, all else as JSON."""
    if value is None:
        return ""
    return value if isinstance(value, str) else json.dumps(value, ensure_ascii=False)


def safe_cell(value: object) -> object:
    """Return a value for a cell; text that a spreadsheet would run gets an apostrophe before it, numbers never."""
    if isinstance(value, str) and _FORMULA.match(value) and not _NUMBER.fullmatch(value):
        return f"'{value}"
    return value


def _column(cells: list[Any]) -> Column:
    known = [cell for cell in cells if cell is not None]
    if known and all(_is_number(cell) for cell in known):
        return np.array([np.nan if cell is None else float(cell) for cell in cells])
    width = {len(cell) if isinstance(cell, list) else 0 for cell in known}
    if len(width) == 1 and width != {0} and all(x is None or _is_number(x) for cell in known for x in cell):
        missing = [None] * width.pop()
        return np.array([missing if cell is None else cell for cell in cells], float)
    return [text_of(cell) for cell in cells]


def _is_number(value: object) -> bool:
    """Whether a value is a number of a float's range; truth values are numbers 0 and 1."""
    return isinstance(value, float) or (isinstance(value, int) and abs(value) < 2**1023)
