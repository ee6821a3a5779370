"""Results of a session in plain words, for the page of results and for page one of the report."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from mimics_app.contracts.messages.trial_counts import (
    COUNTED_TRIALS,
    FINISHED,
    SESSION_ENDED,
    finished_words,
    practice_only,
)
from mimics_app.contracts.system.language import translated
from mimics_app.contracts.system.phrases import phrase
from mimics_app.recording.history import EarlierRun, finished_times
from mimics_app.recording.report_tables import caption_of
from mimics_app.recording.report_values import number

__all__ = [
    "finished_time",
    "has_caption",
    "mean_time",
    "mean_words",
    "measure_caption",
    "of_same_settings",
    "outcome_word",
    "result_sentence",
    "trial_lines",
    "trial_names",
]

_OUTCOMES = {FINISHED: phrase("finished"), "timeout": phrase("time over"), "aborted": phrase("broken off")}

_NOTABLE = 0.02
"""Smallest relative difference to the last session's time that is mentioned."""


class _Column(NamedTuple):
    """A measure of a trial: column of trials.csv, caption, format of a value, unit, and factor to that unit."""

    name: str
    caption: str
    form: str
    unit: str = ""
    factor: float = 1.0

    def text(self, value: float, form: str = "") -> str:
        """Return a value with its unit, in the present language."""
        return translated(f"{self.factor * value:{form or self.form}} {self.unit}".rstrip())


_COLUMNS = (
    _Column("time_s", phrase("Time"), ".1f", "s"),
    _Column("path_error_rms_m", phrase("Off the line"), ".1f", "mm", 1e3),
    _Column("contacts", phrase("Contacts"), ".0f"),
    _Column("drops", phrase("Drops"), ".0f"),
    _Column("bruises", phrase("Bruises"), ".0f"),
    _Column("distance_m", phrase("Walked"), ".0f", "m"),
    _Column("walk_speed_mps", phrase("Speed"), ".2f", "m/s"),
    _Column("symmetry", phrase("Even steps"), ".0f", "%", 100.0),
    _Column("missteps", phrase("Missteps"), ".0f"),
    _Column("walk_steps", phrase("Steps"), ".0f"),
    _Column("walk_left_m", phrase("Left to the place"), ".1f", "m"),
    _Column("taps", phrase("Taps"), ".0f"),
    _Column("ownership", phrase("Ownership"), "+.1f"),
    _Column("drift_m", phrase("Drift"), ".2f", "m"),
    _Column("path_m", phrase("Path"), ".2f", "m"),
    _Column("score", phrase("Score of 100"), ".0f"),
)
"""Measures of a trial that the table shows where a trial has them."""

_NAMED = (
    *_COLUMNS,
    _Column("walked_m", phrase("Walked"), ".0f", "m"),
    _Column("contact_time_s", phrase("Time in contact"), ".1f", "s"),
    _Column("smoothness", phrase("Smoothness"), ".2f"),
)
"""Measures that have a name for a person."""

_NOT_OF_WALKS = "path_m"
"""Column that says nothing about a walk, which the hand only steers."""

_OF_FINISHED = frozenset({"score"})
"""Columns that say something about trials that reached their goal only."""


def result_sentence(task: Mapping[str, Any], rows: Sequence[Mapping[str, Any]], earlier: Sequence[EarlierRun]) -> str:
    """Return what happened, and the time of finished trials against the last session with the same settings.

    Args:
        task: Totals under the keys of `mimics run --json`.
        rows: Rows of trials.csv.
        earlier: Sessions of the same scene and participant before this one, oldest first.
    """
    trials = number(task.get("trials"))
    if not trials:
        practice = task.get("practice")
        ended = number(practice.get("trials")) if isinstance(practice, Mapping) else None
        return translated(practice_only(int(ended)) if ended else phrase("No trial came to its end."))
    completed = number(task.get("completed")) or 0.0
    words = [str(row["happened"]) for row in rows if _counts(row) and row.get("happened")]
    parts = words[-1:] if trials == 1 else []
    parts = parts or [finished_words(round(completed), int(trials))]
    sentence = ", ".join(map(translated, [*parts, *_against_last(rows, earlier)])) + "."
    missed = [str(row["happened"]) for row in rows if _counts(row) and not _finished(row) and row.get("happened")]
    return f"{sentence} {translated(missed[-1])}." if missed and trials > 1 else sentence


def finished_time(rows: Sequence[Mapping[str, Any]]) -> float | None:
    """Return the mean time of the trials that reached their goal [s], without practice; None without any."""
    times = [time_s for row in rows if _counts(row) and _finished(row) and (time_s := number(row.get("time_s")))]
    return sum(times) / len(times) if times else None


def of_same_settings(rows: Sequence[Mapping[str, Any]], earlier: Sequence[EarlierRun]) -> list[EarlierRun]:
    """Return the earlier sessions that finished trials of the same conditions as this one, on the same device."""
    mine = finished_times(rows)
    return [run for run in earlier if run.alike and run.times and run.times.keys() == mine.keys()]


def _counts(row: Mapping[str, Any]) -> bool:
    return not row.get("practice")


def _finished(row: Mapping[str, Any]) -> bool:
    return bool(row.get("outcome") == FINISHED)


def mean_time(task: Mapping[str, Any]) -> float | None:
    """Return the mean time of the trials that count [s]; None where none ended."""
    return number(task.get("time_s")) if task.get("counted") == COUNTED_TRIALS else None


def trial_lines(rows: Sequence[Mapping[str, Any]]) -> tuple[list[str], list[tuple[str, ...]]]:
    """Return captions, and the texts of each row of trials.csv; without measures that no row has."""
    if not rows:
        return [], []
    walks = any(_has(row, "walk_speed_mps") for row in rows)
    columns = [column for column in _COLUMNS if not (walks and column.name == _NOT_OF_WALKS)]
    shown = [column for column in columns if any(_has(row, column.name) for row in rows)]
    head = [translated(each) for each in (phrase("Trial"), phrase("Result"), *(each.caption for each in shown))]
    return head, [(name, _outcome(row), *_cells(row, shown)) for name, row in zip(trial_names(rows), rows, strict=True)]


def trial_names(rows: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return the name of each row's trial: its number from 1, the same for further attempts, or "Practice"."""
    counting = [row for row in rows if not row.get("practice")]
    order = list(dict.fromkeys(str(row.get("trial")) for row in counting))
    return [
        translated(phrase("Practice")) if row.get("practice") else str(order.index(str(row.get("trial"))) + 1)
        for row in rows
    ]


def outcome_word(row: Mapping[str, Any]) -> str:
    """Return how a trial of trials.csv ended, in a word for people; "" where the row does not say."""
    outcome = str(row.get("outcome", ""))
    return translated(_OUTCOMES.get(outcome, outcome))


def _outcome(row: Mapping[str, Any]) -> str:
    if row.get("happened"):
        return translated(str(row["happened"]))
    outcome, cause = outcome_word(row), row.get("cause")
    return f"{outcome}: {translated(str(cause))}" if cause and cause != SESSION_ENDED else outcome


def _has(row: Mapping[str, Any], column: str) -> bool:
    """Whether a row has a measure; an attempt without travel has none, one that did not finish no points."""
    if column in _OF_FINISHED and not _finished(row):
        return False
    return number(row.get(column)) is not None and row.get("time_s") != 0.0


def measure_caption(column: str) -> str:
    """Return the caption of a measure, or, where it has no name for a person, that of the report."""
    return translated(_column_of(column).caption)


def has_caption(column: str) -> bool:
    """Whether a measure has a name for a person."""
    return any(each.name == column for each in _NAMED)


def mean_words(column: str, value: float) -> str:
    """Return a mean or a difference to three digits, in the unit in which a person reads it."""
    return _column_of(column).text(value, ".3g")


def _column_of(name: str) -> _Column:
    """Return a measure as a person reads it, else as the report has it, with the unit in its caption."""
    known = next((each for each in _NAMED if each.name == name), None)
    return known or _Column(name, caption_of(name, {}), "", factor=1e3 if name.endswith("_m") else 1.0)


def _cells(row: Mapping[str, Any], shown: Sequence[_Column]) -> list[str]:
    return [each.text(float(row[each.name])) if _has(row, each.name) else "" for each in shown]


def _against_last(rows: Sequence[Mapping[str, Any]], earlier: Sequence[EarlierRun]) -> list[str]:
    """Return the comparison of the mean time of finished trials with that of the last run of the same settings, if any.

    The means are over the conditions, each of which counts once.
    """
    alike, mine = of_same_settings(rows, earlier), finished_times(rows)
    if not alike or not mine:
        return []
    now, before = (sum(times.values()) / len(times) for times in (mine, alike[-1].times))
    if not before > 0.0:
        return []
    change = (before - now) / before
    if abs(change) < _NOTABLE:
        return [phrase("as fast as last time")]
    if change <= -1.0:
        return [phrase("{times:.1f} times as long as last time", times=now / before)]
    share = 100.0 * abs(change)
    if change > 0.0:
        return [phrase("{share:.0f} % faster than last time", share=share)]
    return [phrase("{share:.0f} % slower than last time", share=share)]
