"""The tables of a report: trials, contacts with their picture and sound, trips, settings, methods."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.errors import counted
from mimics_app.contracts.loop.haptic import EventKind, SafetyState
from mimics_app.contracts.system.phrases import counted_phrase, phrase
from mimics_app.recording.columns import row_norms
from mimics_app.recording.report_values import Seconds, mapping, number, scaled
from mimics_app.recording.run import Run
from mimics_app.recording.trips import TripReader

__all__ = [
    "Contacts",
    "Table",
    "Trials",
    "caption_of",
    "contact_rows",
    "contacts_of",
    "governor_tables",
    "key_table",
    "lines_table",
    "loss_table",
    "plan_tables",
    "state_table",
    "trials_of",
    "trip_table",
]

_MOST_MOVES = 100  # changes of quality that are listed
_MOST_ROWS = 300  # rows of a table that are listed
_SHORT = 20  # rows; a longer table is folded
_MOST_COLUMNS = 12  # of trials, about what 1100 px hold
_LONG_LIST = 12  # values; a longer list is counted
_DEEPEST = 12  # levels of nesting that are named
_HIDDEN = ("begin_ns", "end_ns")  # session clock, for programs
_PARAMETER = "parameter."
_METRES = "_m"
_TITLES = {"smoothness": phrase("smoothness (spectral arc length) [–]")}
_TAKEN = ((phrase("frame after [ms]"), phrase("in the picture")), (phrase("sound after [ms]"), phrase("heard")))
_ENDINGS = (
    *(("_m_s", "m/s"), ("_mps", "m/s"), ("_db", "dB"), ("_px", "px"), ("_ms", "ms")),
    *(("_s", "s"), (_METRES, "mm"), ("_n", "N"), ("_j", "J")),
)


@dataclass(frozen=True, slots=True)
class Table:
    """A table: names of columns, rows of plain values, class in the style sheet ("keys": names and values).

    With `words` its cells are shown in the language of the report; else only the names of its columns, and numbers.
    """

    names: Sequence[str]
    rows: Sequence[Sequence[Any]]
    kind: str = ""
    words: bool = False

    @property
    def numeric(self) -> list[bool]:
        """Whether each column holds numbers only and is aligned to the right."""
        return [all(_is_number(row[i]) for row in self.rows) for i in range(len(self.names))]

    @property
    def first(self) -> Table:
        """The table limited to the rows that a page lists."""
        return Table(self.names, self.rows[:_MOST_ROWS], self.kind, self.words)


def _is_number(cell: object) -> bool:
    return cell is None or (isinstance(cell, (int, float)) and not isinstance(cell, bool))


def key_table(content: Mapping[str, Any]) -> Table:
    """Return a table of names and values; nested mappings are named "outer.inner"."""
    return Table(["setting", "value"], _flat(content), "keys")


def _flat(content: Mapping[str, Any], before: str = "", depth: int = 0) -> list[tuple[str, Any]]:
    rows: list[tuple[str, Any]] = []
    for key, item in content.items():
        nested = isinstance(item, list) and any(isinstance(part, (Mapping, list)) for part in item)
        if depth < _DEEPEST and isinstance(item, Mapping):
            rows += _flat(item, f"{before}{key}.", depth + 1)
        elif isinstance(item, list) and len(item) > _LONG_LIST:
            rows.append((before + key, f"{len(item)} values"))
        elif depth < _DEEPEST and nested:
            rows += _flat({str(i): part for i, part in enumerate(item)}, f"{before}{key}.", depth + 1)
        else:
            rows.append((before + key, item))
    return rows


def lines_table(lines: Sequence[Mapping[str, Any]]) -> Table:
    """Return a table of lines of events.jsonl, with a column for each name."""
    names = [n for n in dict.fromkeys(n for line in lines for n in line) if n not in ("source", "kind")]
    return Table(names, _cells(lines, names))


@dataclass(frozen=True, slots=True)
class Trials:
    """Tables of trials.csv, one row per attempt.

    Attributes:
        measured: Measures, in tables no wider than the page, the most important first.
        given: Parameters; None for none.
    """

    measured: list[Table]
    given: Table | None


def trials_of(run: Run) -> Trials | None:
    """Return the trials of a run, with units and lengths in mm; None where none ended."""
    if not run.trials:
        return None
    trials = [{**row, "trial": row["trial"] + 1} if isinstance(row.get("trial"), int) else row for row in run.trials]
    names = [n for n in dict.fromkeys(name for row in trials for name in row) if _says_something(n, trials)]
    if "outcome" in names and "score" in names:  # the most important columns first
        names.remove("score")
        names.insert(names.index("outcome") + 1, "score")
    given = [name for name in names if name.startswith(_PARAMETER)]
    measured = [name for name in names if name not in given]
    rows = [_in_mm(row) for row in trials]
    units = _parameter_units(run)
    points = _points_of(run)
    titles = {name: caption_of(name, points) for name in measured} | {
        name: _parameter_column(name, units) for name in given
    }
    first = [name for name in measured if name == "trial"]
    rest = [name for name in measured if name != "trial"]
    parts = [rest[i : i + _MOST_COLUMNS] for i in range(0, len(rest), _MOST_COLUMNS)] or [[]]
    return Trials(
        [_columns_of(rows, [*first, *part], titles) for part in parts],
        _columns_of(trials, ["trial", *given], titles) if given else None,
    )


def _columns_of(rows: Sequence[Mapping[str, Any]], names: Sequence[str], titles: Mapping[str, str]) -> Table:
    return Table([titles.get(name, name) for name in names], _cells(rows, names), words=True)


def _in_mm(row: Mapping[str, Any]) -> dict[str, Any]:
    """Return the row with its lengths in mm."""
    return {name: scaled(item, 1000.0) if _is_length(name, item) else item for name, item in row.items()}


def _is_length(name: str, item: object) -> bool:
    return name.endswith(_METRES) and number(item) is not None


def _says_something(name: str, trials: Sequence[Mapping[str, Any]]) -> bool:
    """Whether a column of the trials holds more than its default value."""
    usual = {"attempt": 1, "repetition": 0}.get(name)
    return name not in _HIDDEN and any(row.get(name) not in (None, "", usual) for row in trials)


def _points_of(run: Run) -> dict[str, str]:
    """Return what the device calls each point of contact, by the beginning of its columns."""
    names = mapping(run.session.get("names")).get("points")
    return {f"point_{i}_": str(name) for i, name in enumerate(names)} if isinstance(names, list) else {}


def caption_of(name: str, points: Mapping[str, str]) -> str:
    """Return the caption of a column: time_s becomes time [s]; lengths are in mm."""
    of = next((point for point in points if name.startswith(point)), None)
    if of is not None:
        return f"{points[of]}, {caption_of(name.removeprefix(of), {})}"
    if name in _TITLES:
        return _TITLES[name]
    for ending, unit in _ENDINGS:
        if name.endswith(ending):
            return f"{name[: -len(ending)].replace('_', ' ')} [{unit}]"
    return name.replace("_", " ")


def _parameter_units(run: Run) -> dict[str, str]:
    """Return the unit of each parameter of the task from the recorded scene."""
    task = mapping(mapping(mapping(run.session.get("scene")).get("document")).get("task"))
    return {name: str(mapping(item).get("unit", "-")) for name, item in mapping(task.get("parameters")).items()}


def _parameter_column(column: str, units: Mapping[str, str]) -> str:
    name = column.removeprefix(_PARAMETER)
    unit = units.get(name, "").replace("-", "–")
    return name.replace("_", " ") + (f" [{unit}]" if unit else "")


def contact_rows(run: Run) -> list[dict[str, Any]]:
    """Return each contact with its first tick, the first frame that showed it, and the audio sample of its sound."""
    begins = run.events[run.events["kind"] == EventKind.CONTACT_BEGIN]
    frames = sorted(run.lines_of("app", "frame"), key=lambda line: int(line.get("tick") or 0))
    seen = np.array([int(line.get("tick") or 0) for line in frames], np.int64)
    sounds = {line.get("tick"): line for line in run.lines_of("app", "sound")}
    peaks = _peaks(run.haptic, begins)
    rows = []
    for event, (force, depth, length) in zip(begins, peaks, strict=True):
        tick = int(event["tick"])
        place = int(np.searchsorted(seen, tick))
        frame = frames[place] if place < len(frames) else {}
        sound = sounds.get(tick, {})
        rows.append(
            {
                phrase("at [s]"): Seconds(run.seconds(tick)),
                "tick": tick,
                phrase("approach [mm/s]"): 1000.0 * float(event["speed"]),
                phrase("peak force [N]"): force,
                phrase("depth [mm]"): depth,
                phrase("lasted [ms]"): length,
                phrase("first frame"): frame.get("frame"),
                phrase("frame after [ms]"): int(seen[place]) - tick if frame else None,
                phrase("sound"): sound.get("sound"),
                phrase("sample"): sound.get("sample"),
                phrase("sound after [ms]"): sound.get("latency_ms"),
            }
        )
    return rows


def _peaks(samples: NDArray[Any], begins: NDArray[Any]) -> list[tuple[float | None, float | None, int | None]]:
    """Return peak force on the person [N], peak depth [mm] and duration [ms] of each contact."""
    ticks = samples["tick"]
    force = row_norms(samples["f_user_world"])
    apart = np.append(np.flatnonzero(samples["penetration"] <= 0.0), len(samples))
    found: list[tuple[float | None, float | None, int | None]] = []
    for tick in begins["tick"]:
        start = int(np.searchsorted(ticks, tick))
        end = int(apart[np.searchsorted(apart, start)]) if start < len(samples) else start
        if end <= start:
            found.append((None, None, None))
            continue
        depth = 1000.0 * float(samples["penetration"][start:end].max())
        found.append((float(force[start:end].max()), depth, end - start))
    return found


@dataclass(frozen=True, slots=True)
class Contacts:
    """The contacts of a run.

    Attributes:
        words: Their number, and median and maximum latency of picture and sound.
        table: The contacts, limited to the first ones.
        folded: Whether the list is long.
        most: Number of contacts listed, 0 for all.
    """

    words: str
    table: Table
    folded: bool
    most: int


def contacts_of(run: Run) -> Contacts | None:
    """Return the contacts of a run; None without any."""
    rows = contact_rows(run)
    if not rows:
        return None
    taken = [
        phrase("{what:s} after {words:s}", what=what, words=words)
        for name, what in _TAKEN
        if (words := _median_and_most(rows, name))
    ]
    names = [name for name in rows[0] if name != "tick"]
    return Contacts(
        words=" · ".join([counted_phrase("{n:d} contact", "{n:d} contacts", len(rows)), *taken]),
        table=Table(names, _cells(rows[:_MOST_ROWS], names)),
        folded=len(rows) > _SHORT,
        most=_MOST_ROWS if len(rows) > _MOST_ROWS else 0,
    )


def _median_and_most(rows: Sequence[Mapping[str, Any]], name: str) -> str:
    taken = [value for row in rows if (value := number(row[name])) is not None]
    return (
        phrase("{median:.1f} ms in the median; {most:.1f} ms at most", median=float(np.median(taken)), most=max(taken))
        if taken
        else ""
    )


def trip_table(run: Run) -> Table | None:
    """Return the stops and short holds with cause and advice; None for none."""
    trips = TripReader().take(run.events)
    rows = [
        (Seconds(run.seconds(t.tick)), phrase("stop") if t.latched else phrase("short hold"), t.what, t.advice)
        for t in trips
    ]
    return (
        Table([phrase("at [s]"), phrase("what"), phrase("cause"), phrase("what to do")], rows, words=True)
        if rows
        else None
    )


def loss_table(run: Run) -> Table | None:
    """Return the parts of the scene that were no longer simulated; None for none."""
    lost = [e for e in run.events if e["kind"] in (EventKind.LEFT_OUT, EventKind.QUARANTINE)]
    rows = [(Seconds(run.seconds(e["tick"])), _loss(e)) for e in lost]
    return Table([phrase("from [s]"), phrase("not simulated")], rows) if rows else None


def state_table(run: Run) -> Table | None:
    """Return the changes of state; None for none."""
    states = run.events[run.events["kind"] == EventKind.STATE]
    rows = [(Seconds(run.seconds(e["tick"])), _word(e["force"])) for e in states]
    return Table([phrase("at [s]"), phrase("state from then on")], rows, words=True) if rows else None


def _loss(event: np.void) -> str:
    amount = _whole(event["force"])
    if event["kind"] == EventKind.LEFT_OUT:
        return f"{counted(amount, 'pairs')} of shapes near each other, for lack of capacity"
    return f"the force field of effect {amount + 1}, whose force was not finite"


def _word(code: float) -> str:
    try:
        return SafetyState(_whole(code)).name.replace("_", " ").lower()
    except ValueError:
        return str(_whole(code))


def _whole(code: float) -> int:
    """Return the value of an event as an integer; -1 where it is not finite."""
    return int(code) if np.isfinite(code) else -1


def plan_tables(plan: object) -> dict[str, Table]:
    """Return the tables of `mimics explain` by heading: chosen methods with cost and error, and parts left out."""
    names = ["part", "group", "method", "cost_us", "error", "unit", "tolerance"]
    parts, left_out = (_objects(mapping(plan).get(name)) for name in ("parts", "left_out"))
    tables: dict[str, Table] = {}
    if parts or left_out:
        titles = ["part", "group", "method", "cost", "error", "unit", "tolerance"]
        tables["Methods"] = Table(titles, _cells([_timed(part, "cost_us") for part in parts], names))
    if left_out:
        tables["Left out"] = Table(
            ["part", "why", "saves"],
            _cells([_timed(each, "saved_us") for each in left_out], ["part", "why", "saved_us"]),
        )
    return tables


def _timed(part: Mapping[str, Any], name: str) -> dict[str, Any]:
    """Return the part with a time [us] as text, in ms from 1 ms on."""
    us = number(part.get(name))
    if us is None:
        return dict(part)
    return {**part, name: f"{us:.3f} µs" if us < 1000.0 else f"{1e-3 * us:.3g} ms"}


def _objects(items: object) -> list[Mapping[str, Any]]:
    return [item for item in items if isinstance(item, Mapping)] if isinstance(items, list) else []


def _cells(rows: Sequence[Mapping[str, Any]], names: Sequence[str]) -> list[list[Any]]:
    return [[row.get(name) for name in names] for row in rows]


def governor_tables(run: Run) -> dict[str, Table]:
    """Return frame times, shares of frames by quality, and changes by the governor, by heading ("" for none)."""
    summary = mapping(run.summary.get("governor"))
    moves = run.lines_of("app", "governor")
    tables: dict[str, Table] = {}
    if summary:
        times = mapping(summary.get("frame_ms"))
        rows = [
            ("budget of a frame [ms]", summary.get("budget_ms")),
            ("median frame [ms]", times.get("p50")),
            ("95 % of frames within [ms]", times.get("p95")),
            ("times quality changed", summary.get("moves")),
        ]
        tables[""] = Table(["", "value"], rows)
        shares = [(name, scaled(share, 100.0)) for name, share in mapping(summary.get("shares")).items()]
        tables["Qualities"] = Table(["quality", "share of frames [%]"], shares)
    if moves:
        listed = [
            [line.get("step"), line.get("level"), line.get("direction", line.get("way")), line.get("frame_ms")]
            for line in moves[:_MOST_MOVES]
        ]  # older recordings say "way"
        tables["Changes of quality"] = Table(["step", "to", "direction", "frame before [ms]"], listed)
    return tables
