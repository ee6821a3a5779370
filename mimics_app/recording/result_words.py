"""Results of a session in plain words, for the page of results and for page one of the report."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from mimics_app.contracts.plural import counted
from mimics_app.contracts.trial_counts import COUNTED_TRIALS, FINISHED, SESSION_ENDED
from mimics_app.recording.history import EarlierRun
from mimics_app.recording.report_values import number

__all__ = ["mean_time", "outcome_word", "result_sentence", "trial_lines", "trial_names"]

_OUTCOMES = {FINISHED: "finished", "timeout": "time over", "aborted": "broken off"}

_NOTABLE = 0.02
"""Smallest relative difference to the last session's time that is mentioned."""

_COLUMNS: tuple[tuple[str, str, Callable[[float], str]], ...] = (
    ("time_s", "Time", lambda value: f"{value:.1f} s"),
    ("path_error_rms_m", "Off the line", lambda value: f"{1e3 * value:.1f} mm"),
    ("contacts", "Contacts", lambda value: f"{value:.0f}"),
    ("drops", "Drops", lambda value: f"{value:.0f}"),
    ("bruises", "Bruises", lambda value: f"{value:.0f}"),
    ("walked_m", "Walked", lambda value: f"{value:.0f} m"),
    ("walk_speed_mps", "Walking speed", lambda value: f"{value:.2f} m/s"),
    ("walk_steps", "Steps", lambda value: f"{value:.0f}"),
    ("walk_left_m", "Left to the place", lambda value: f"{value:.1f} m"),
    ("path_m", "Hand path", lambda value: f"{value:.2f} m"),
    ("score", "Score of 100", lambda value: f"{value:.0f}"),
)
"""Measures of a trial that the table shows where a trial has them: column of trials.csv, caption, text."""


def result_sentence(task: Mapping[str, Any], earlier: Sequence[EarlierRun]) -> str:
    """Return a sentence: number of finished trials, and their time relative to the previous session.

    Args:
        task: Totals under the keys of `mimics run --json`.
        earlier: Sessions of the same scene and participant before this one, oldest first.
    """
    trials = number(task.get("trials"))
    if not trials:
        practice = task.get("practice")
        ended = number(practice.get("trials")) if isinstance(practice, Mapping) else None
        return f"Practice only: {counted(int(ended), 'trials')}." if ended else "No trial came to its end."
    completed = number(task.get("completed")) or 0.0
    parts = [f"{completed:.0f} of {counted(int(trials), 'trials')} finished", *_against_last(task, earlier)]
    return ", ".join(parts) + "."


def mean_time(task: Mapping[str, Any]) -> float | None:
    """Return the mean time of the trials that count [s]; None where none ended."""
    return number(task.get("time_s")) if task.get("counted") == COUNTED_TRIALS else None


def trial_lines(rows: Sequence[Mapping[str, Any]]) -> tuple[list[str], list[tuple[str, ...]]]:
    """Return captions, and the texts of each row of trials.csv; without measures that no row has."""
    if not rows:
        return [], []
    shown = [column for column in _COLUMNS if any(_has(row, column[0]) for row in rows)]
    head = ["Trial", "Result", *(caption for _, caption, _ in shown)]
    return head, [(name, _outcome(row), *_cells(row, shown)) for name, row in zip(trial_names(rows), rows, strict=True)]


def trial_names(rows: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return the name of each row's trial: its number from 1, the same for further attempts, or "Practice"."""
    counting = [row for row in rows if not row.get("practice")]
    order = list(dict.fromkeys(str(row.get("trial")) for row in counting))
    return ["Practice" if row.get("practice") else str(order.index(str(row.get("trial"))) + 1) for row in rows]


def outcome_word(row: Mapping[str, Any]) -> str:
    """Return how a trial of trials.csv ended, in a word for people; "" where the row does not say."""
    outcome = str(row.get("outcome", ""))
    return _OUTCOMES.get(outcome, outcome)


def _outcome(row: Mapping[str, Any]) -> str:
    outcome, cause = outcome_word(row), row.get("cause")
    return f"{outcome}: {cause}" if cause and cause != SESSION_ENDED else outcome


def _has(row: Mapping[str, Any], column: str) -> bool:
    """Whether a row has a measure; an attempt without travel has none."""
    return number(row.get(column)) is not None and row.get("time_s") != 0.0


def _cells(row: Mapping[str, Any], shown: Sequence[tuple[str, str, Callable[[float], str]]]) -> list[str]:
    return [text(float(row[key])) if _has(row, key) else "" for key, _, text in shown]


def _against_last(task: Mapping[str, Any], earlier: Sequence[EarlierRun]) -> list[str]:
    """Return the comparison of the mean time with that of the last run; [] where either has none."""
    now, before = mean_time(task), next((run.time_s for run in reversed(earlier) if run.time_s), None)
    if now is None or before is None:
        return []
    change = (before - now) / before
    if abs(change) < _NOTABLE:
        return ["as fast as last time"]
    if change <= -1.0:
        return [f"{now / before:.1f} times as long as last time"]
    return [f"{100.0 * abs(change):.0f} % {'faster' if change > 0.0 else 'slower'} than last time"]
