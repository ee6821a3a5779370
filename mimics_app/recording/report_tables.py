"""The tables of a report: scores, contacts with their picture and sound, trips, settings, methods, environment."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from html import escape
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.haptic import EventKind, SafetyState
from mimics_app.contracts.trips import TripReader
from mimics_app.recording.run import Run

__all__ = ["contact_rows", "contact_table", "event_table", "key_table", "plan_tables", "score_table", "table", "value"]

_MOST_ROWS = 300
_SHORT = 20
_LONG_LIST = 12
_HIDDEN = ("begin_ns", "end_ns")  # session clock, for programs
_PARAMETER = "parameter."
_METRES = "_m"


def value(item: Any) -> str:
    """A value as a person writes it, escaped for HTML."""
    if item is None or (isinstance(item, float) and not np.isfinite(item)):
        return "–"
    if isinstance(item, bool):
        return "yes" if item else "no"
    if isinstance(item, int):
        return f"{item}"
    if isinstance(item, float):
        return f"{item:.4g}"
    if isinstance(item, Mapping):
        return ", ".join(f"{escape(str(key))} {value(part)}" for key, part in item.items())
    if isinstance(item, (list, tuple)):
        return ", ".join(value(part) for part in item)
    return escape(str(item))


def table(names: Sequence[str], rows: Iterable[Sequence[Any]], kind: str = "") -> str:
    """An HTML table; columns of numbers are aligned to the right. `kind` is its class in the style sheet."""
    rows = list(rows)
    kind_of_table = f' class="{kind}"' if kind else ""
    numeric = [all(_is_number(row[i]) for row in rows) for i in range(len(names))]
    kinds = [' class="number"' if n else "" for n in numeric]
    head = "".join(f"<th{kind}>{escape(name)}</th>" for kind, name in zip(kinds, names, strict=True))
    body = "".join(
        "<tr>" + "".join(f"<td{kind}>{value(cell)}</td>" for kind, cell in zip(kinds, row, strict=True)) + "</tr>"
        for row in rows
    )
    return (
        f'<div class="scroll"><table{kind_of_table}><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table></div>'
    )


def _is_number(cell: Any) -> bool:
    return cell is None or (isinstance(cell, (int, float)) and not isinstance(cell, bool))


def key_table(content: Mapping[str, Any]) -> str:
    """Names and values below each other; nested mappings are shown as "outer.inner"."""
    return table(["setting", "value"], _flat(content), "keys")


def _flat(content: Mapping[str, Any], before: str = "") -> list[tuple[str, Any]]:
    rows: list[tuple[str, Any]] = []
    for key, item in content.items():
        if isinstance(item, Mapping):
            rows += _flat(item, f"{before}{key}.")
        elif isinstance(item, list) and len(item) > _LONG_LIST:
            rows.append((before + key, f"{len(item)} values"))
        elif isinstance(item, list) and any(isinstance(part, (Mapping, list)) for part in item):
            rows += _flat({str(i): part for i, part in enumerate(item)}, f"{before}{key}.")
        else:
            rows.append((before + key, item))
    return rows


def score_table(trials: Sequence[Mapping[str, Any]]) -> str:
    """What trials.csv says to a person, one row per attempt."""
    trials = [{**row, "trial": row["trial"] + 1} if isinstance(row.get("trial"), int) else row for row in trials]
    names = [n for n in dict.fromkeys(name for row in trials for name in row) if _says_something(n, trials)]
    if "outcome" in names and "score" in names:  # what people look for first
        names.remove("score")
        names.insert(names.index("outcome") + 1, "score")
    given = [name for name in names if name.startswith(_PARAMETER)]
    measured = [name for name in names if name not in given]
    text = table([_column(name) for name in measured], _cells([_in_mm(row) for row in trials], measured))
    if given:
        text += "<h3>Parameters of the trials</h3>"
        text += table([_column(name) for name in ("trial", *given)], _cells(trials, ["trial", *given]))
    return text


def _in_mm(row: Mapping[str, Any]) -> dict[str, Any]:
    """The row with its lengths in mm."""
    return {
        name: 1000.0 * item if name.endswith(_METRES) and isinstance(item, (int, float)) else item
        for name, item in row.items()
    }


def _says_something(name: str, trials: Sequence[Mapping[str, Any]]) -> bool:
    """Whether a column of the trials is more than its usual value."""
    usual = {"attempt": 1, "repetition": 0}.get(name)
    return name not in _HIDDEN and any(row.get(name) not in (None, "", usual) for row in trials)


def _column(name: str) -> str:
    """The name of a column for people: time_s becomes time [s]; lengths are told in mm."""
    if name.startswith(_PARAMETER):
        return name.removeprefix(_PARAMETER).replace("_", " ")
    for ending, unit in (("_m_s", "m/s"), ("_s", "s"), (_METRES, "mm"), ("_n", "N")):
        if name.endswith(ending):
            return f"{name[: -len(ending)].replace('_', ' ')} [{unit}]"
    return name.replace("_", " ")


def contact_rows(run: Run) -> list[dict[str, Any]]:
    """Each contact with the tick it began, the first frame that showed it and the sample that sounded it."""
    begins = run.events[run.events["kind"] == EventKind.CONTACT_BEGIN]
    frames = sorted(run.lines_of("app", "frame"), key=lambda line: int(line.get("tick") or 0))
    seen = np.array([int(line.get("tick") or 0) for line in frames], np.int64)
    sounds = {int(line.get("tick", -1)): line for line in run.lines_of("app", "sound")}
    peaks = _peaks(run.haptic, begins)
    rows = []
    for event, (force, depth, length) in zip(begins, peaks, strict=True):
        tick = int(event["tick"])
        place = int(np.searchsorted(seen, tick))
        frame = frames[place] if place < len(frames) else {}
        sound = sounds.get(tick, {})
        rows.append(
            {
                "tick": tick,
                "approach [mm/s]": 1000.0 * float(event["speed"]),
                "peak force [N]": force,
                "depth [mm]": depth,
                "lasted [ms]": length,
                "first frame": frame.get("frame"),
                "frame after [ms]": int(seen[place]) - tick if frame else None,
                "sound": sound.get("sound"),
                "sample": sound.get("sample"),
                "sound after [ms]": sound.get("latency_ms"),
            }
        )
    return rows


def _peaks(samples: NDArray[Any], begins: NDArray[Any]) -> list[tuple[float | None, float | None, int | None]]:
    """Peak of the force on the person [N], of the depth [mm], and length [ms] of each contact."""
    ticks = samples["tick"]
    force = np.sqrt(np.einsum("ij,ij->i", samples["f_user_world"], samples["f_user_world"]))
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


def contact_table(rows: Sequence[Mapping[str, Any]]) -> str:
    """The contacts, and what picture and sound took in the middle and at most."""
    if not rows:
        return '<p class="soft">Nothing was touched.</p>'
    text = ""
    for name, what in (("frame after [ms]", "in the picture"), ("sound after [ms]", "heard")):
        taken = np.array([row[name] for row in rows if row[name] is not None], np.float64)
        if len(taken):
            text += f" {what} after {np.median(taken):.1f} ms in the median, {taken.max():.1f} ms at most;"
    count = f"{len(rows)} contact{'' if len(rows) == 1 else 's'}"
    summary = f"<p>{count}{':' + text.rstrip(';') if text else ''}.</p>"
    listed = table(list(rows[0]), [list(row.values()) for row in rows[:_MOST_ROWS]])
    if len(rows) > _MOST_ROWS:
        listed += f'<p class="soft">The first {_MOST_ROWS} are listed.</p>'
    if len(rows) > _SHORT:
        listed = f"<details><summary>Every contact</summary>{listed}</details>"
    return summary + listed


def event_table(events: NDArray[Any]) -> str:
    """Stops and short holds with cause and advice, what was not simulated any more, and every change of state."""
    text = ""
    trips = TripReader().take(events)
    if trips:
        rows = [(t.tick, t.seconds, "stop" if t.latched else "short hold", t.what, t.advice) for t in trips]
        text += table(["at tick", "at [s]", "what", "cause", "what to do"], rows[:_MOST_ROWS])
    losses = [(int(e["tick"]), _loss(e)) for e in events if e["kind"] in (EventKind.LEFT_OUT, EventKind.QUARANTINE)]
    if losses:
        text += table(["from tick", "not simulated"], losses[:_MOST_ROWS])
    states = [(int(e["tick"]), _word(e["force"])) for e in events[events["kind"] == EventKind.STATE]]
    if states:
        listed = table(["tick", "state from then on"], states[:_MOST_ROWS])
        text += f"<details><summary>Every change of state ({len(states)})</summary>{listed}</details>"
    return text


def _loss(event: Any) -> str:
    number = int(event["force"])
    if event["kind"] == EventKind.LEFT_OUT:
        return f"{number} pair{'' if number == 1 else 's'} of shapes near each other, for want of room"
    return f"the force field of effect {number + 1}: it gave a number that is not finite"


def _word(number: float) -> str:
    try:
        return SafetyState(int(number)).name.replace("_", " ").lower()
    except ValueError:
        return str(int(number))


def plan_tables(plan: Mapping[str, Any]) -> str:
    """What `mimics explain` says: the methods chosen with cost and error, and what was left out."""
    names = ["part", "group", "method", "cost_us", "error", "unit", "tolerance"]
    parts = plan.get("parts", [])
    text = table(["part", "group", "method", "cost [µs]", "error", "unit", "tolerance"], _cells(parts, names))
    if left_out := plan.get("left_out", []):
        text += "<h3>Left out</h3>"
        text += table(["part", "why", "saves [µs]"], _cells(left_out, ["part", "why", "saved_us"]))
    return text if parts or left_out else ""


def _cells(rows: Sequence[Mapping[str, Any]], names: Sequence[str]) -> list[list[Any]]:
    return [[row.get(name) for name in names] for row in rows]
