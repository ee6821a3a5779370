"""Tidy tables of a study: one row per observation, one column per variable, the subject first."""

from __future__ import annotations

import csv
import json
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from statistics import fmean, stdev
from typing import Any

from mimics_app.app.study.subjects import SubjectRun
from mimics_app.contracts.system.whole_file import private_text
from mimics_app.recording.event_log import read_lines
from mimics_app.recording.run_folder import FILES
from mimics_app.recording.trial_table import read_trials
from mimics_app.tasks.kinds.avatar_cord.tap_schedule import tap_of_number

__all__ = ["ANSWER_COLUMNS", "TAP_COLUMNS", "read_study", "summarise_conditions", "write_table"]

Row = dict[str, Any]

TAP_COLUMNS = ["subject", "trial", "condition", "tap", "place", "felt_at", "seen_scheduled_ns", "seen_submitted_ns"]
TAP_COLUMNS += ["seen_display_ns", "felt_scheduled_ns", "felt_commanded_ns", "felt_ns", "offset_ms"]
ANSWER_COLUMNS = ["subject", "trial", "condition", "item", "scale", "value", "seconds", "t_ns"]
_FORMULA = re.compile("^[ \u00a0]*[=+\\-@\t\r\n\uff1d\uff0b\uff0d\uff20]")
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?")


def read_study(runs: Sequence[SubjectRun]) -> tuple[list[Row], list[Row], list[Row]]:
    """Trials, taps and answers of all subjects that have a run folder."""
    trials, taps, answers = list[Row](), list[Row](), list[Row]()
    for run in runs:
        if run.folder is None:
            continue
        whose = {"subject": run.subject, "participant": run.participant, "seed": run.seed}
        trials += [{**whose, **row} for row in _rows(run.folder / "trials.csv")]
        journal = run.folder / FILES["events"]
        events = read_lines(journal)[0] if journal.exists() else []
        taps += _taps(run.subject, events)
        for event in events:
            if event.get("kind") == "answer":
                answers.append({"subject": run.subject, **{name: event.get(name) for name in ANSWER_COLUMNS[1:]}})
    return trials, taps, answers


def write_table(file: Path, rows: Sequence[Mapping[str, Any]], columns: Sequence[str] = ()) -> None:
    """Write rows as CSV, for this user alone; columns in the order given, else of first occurrence."""
    names = list(columns) or list(dict.fromkeys(name for row in rows for name in row))
    with private_text(file) as stream:
        writer = csv.writer(stream)
        writer.writerow(map(_as_cell, names))
        writer.writerows([_as_cell(row.get(name, "")) for name in names] for row in rows)


def _as_cell(value: object) -> object:
    """Return a value for a cell; text that a spreadsheet would run gets an apostrophe before it, numbers never."""
    if isinstance(value, str) and _FORMULA.match(value) and not _NUMBER.fullmatch(value):
        return f"'{value}"
    return value


def summarise_conditions(trials: Sequence[Row], measures: Sequence[str]) -> list[Row]:
    """Mean and standard deviation of measures over finished trials, by condition; n is the number of trials."""
    finished = [row for row in trials if row.get("outcome") == "finished"]
    summary = []
    for label in dict.fromkeys(row.get("label", "") for row in finished):
        of_label = [row for row in finished if row.get("label", "") == label]
        line: Row = {"condition": label, "n": len(of_label)}
        for measure in measures:
            values = [float(row[measure]) for row in of_label if row.get(measure) not in (None, "")]
            line[measure] = fmean(values) if values else None
            line[f"{measure}_sd"] = stdev(values) if len(values) > 1 else None
        summary.append(line)
    return summary


def _taps(subject: int, events: Sequence[Row]) -> list[Row]:
    """Return one row per tap, with its visual and its tactile times."""
    rows: dict[tuple[int, int], Row] = {}
    for event in events:
        kind = event.get("kind")
        if kind == "tap_seen":
            key = event["trial"], event["tap"]
            seen = {f"seen_{name}": event[name] for name in ("scheduled_ns", "submitted_ns", "display_ns")}
            rows.setdefault(key, {}).update(condition=event["condition"], place=event["place"], **seen)
        elif kind == "tap_felt":
            key = event["trial"], event["tap"]
            scheduled = {"felt_scheduled_ns": event["scheduled_ns"], "offset_ms": event["offset_ms"]}
            rows.setdefault(key, {}).update(condition=event["condition"], felt_at=event["at"], **scheduled)
        elif kind == "tactile" and "number" in event:
            key = tap_of_number(event["number"])
            times = {"felt_commanded_ns": event["commanded_ns"], "felt_ns": event["felt_ns"]}
            rows.setdefault(key, {}).update(times)
    return [{"subject": subject, "trial": trial, "tap": tap, **row} for (trial, tap), row in sorted(rows.items())]


def _rows(file: Path) -> list[Row]:
    """Return the rows of a trials.csv as text: a name that reads like a number has quotes in the file only."""
    return [
        {name: value if isinstance(value, str) else json.dumps(value) for name, value in row.items()}
        for row in read_trials(file)
    ]
