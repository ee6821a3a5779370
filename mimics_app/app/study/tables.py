"""Tidy tables of a study: one row per observation, one column per variable, the subject first."""

from __future__ import annotations

import csv
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from statistics import fmean, stdev
from typing import Any

from mimics_app.app.study.subjects import SubjectRun
from mimics_app.contracts.system.whole_file import private_text
from mimics_app.recording.event_log import read_lines
from mimics_app.recording.line_tables import safe_cell
from mimics_app.recording.run_folder import FILES
from mimics_app.recording.trial_table import read_trials
from mimics_app.tasks.kinds.kind import ObservationTable
from mimics_app.tasks.kinds.registry import task_kinds

__all__ = ["Row", "StudyTable", "read_study", "summarise_conditions", "write_table"]

Row = dict[str, Any]


@dataclass(frozen=True, slots=True)
class StudyTable:
    """Rows of one table of a kind of task, those of all subjects.

    Attributes:
        kind: The table as its kind describes it.
        rows: Its rows, the subject first.
    """

    kind: ObservationTable
    rows: list[Row] = field(default_factory=list)

    @property
    def columns(self) -> list[str]:
        """Its columns, the subject first."""
        return ["subject", *self.kind.columns]

    @property
    def summary(self) -> tuple[list[str], list[list[str]]]:
        """Heads and rows of its summary by condition for the page; empty without rows."""
        return self.kind.summary(self.rows) if self.rows else ([], [])


def read_study(runs: Sequence[SubjectRun]) -> tuple[list[Row], dict[str, StudyTable]]:
    """Return the trials of all subjects that have a run folder, and the tables of the kinds of task by name."""
    trials = list[Row]()
    tables = {table.name: StudyTable(table) for kind in task_kinds() for table in kind.tables}
    for run in runs:
        if run.folder is None:
            continue
        whose = {"subject": run.subject, "participant": run.participant, "seed": run.seed}
        trials += [{**whose, **row} for row in _rows(run.folder / "trials.csv")]
        journal = run.folder / FILES["events"]
        events = read_lines(journal)[0] if journal.exists() else []
        for table in tables.values():
            table.rows.extend({"subject": run.subject, **row} for row in table.kind.rows(events))
    return trials, tables


def write_table(file: Path, rows: Sequence[Mapping[str, Any]], columns: Sequence[str] = ()) -> None:
    """Write rows as CSV, for this user alone; columns in the order given, else of first occurrence."""
    names = list(columns) or list(dict.fromkeys(name for row in rows for name in row))
    with private_text(file) as stream:
        writer = csv.writer(stream)
        writer.writerow(map(safe_cell, names))
        writer.writerows([safe_cell(row.get(name, "")) for name in names] for row in rows)


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


def _rows(file: Path) -> list[Row]:
    """Return the rows of a trials.csv as text: a name that reads like a number has quotes in the file only."""
    return [
        {name: value if isinstance(value, str) else json.dumps(value) for name, value in row.items()}
        for row in read_trials(file)
    ]
