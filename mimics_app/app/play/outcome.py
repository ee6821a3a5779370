"""What a session came to, in the words of the page of results."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from mimics_app.contracts.plural import counted
from mimics_app.contracts.trial_counts import COUNTED_TRIALS, FINISHED
from mimics_app.recording.history import EarlierRun
from mimics_app.rendering.visual.launcher.result_page import Button, ResultContent

__all__ = ["result_content"]

_BUTTONS = (
    Button("again", "Again", "n"),
    Button("other", "Another scene", "o"),
    Button("report", "Open report", "r"),
    Button("leave", "Close", "c"),
)

_OUTCOMES = {FINISHED: "finished", "timeout": "time was over", "aborted": "broken off"}

_NOTABLE = 0.02
"""Difference to the last time from which it is worth a word [-]."""

_COLUMNS: tuple[tuple[str, str, Callable[[float], str]], ...] = (
    ("time_s", "Time", lambda value: f"{value:.1f} s"),
    ("path_error_m", "Off the centre line", lambda value: f"{1e3 * value:.1f} mm"),
    ("contacts", "Contacts", lambda value: f"{value:.0f}"),
    ("placed", "Placed", lambda value: f"{value:.0f}"),
    ("drops", "Drops", lambda value: f"{value:.0f}"),
    ("score", "Score of 100", lambda value: f"{value:.0f}"),
)
"""Measures of a trial that the table shows where a trial has them: key, caption, text."""


def result_content(
    title: str, answer: Mapping[str, Any], rows: Sequence[Mapping[str, Any]], earlier: Sequence[EarlierRun]
) -> ResultContent:
    """The page's content.

    Args:
        title: Of the scene.
        answer: The object of `mimics run --json`.
        rows: Of trials.csv.
        earlier: Runs of the same scene and participant before this one, oldest first.
    """
    task = answer["task"]
    shown = [column for column in _COLUMNS if any(row.get(column[0]) is not None for row in rows)]
    return ResultContent(
        title=title,
        sentence=_sentence(task, earlier),
        tiles=_tiles(task, earlier),
        head=("Trial", "Result", *(caption for _, caption, _ in shown)) if rows else (),
        rows=[_line(row, shown) for row in rows],
        buttons=_BUTTONS if answer.get("report") else tuple(each for each in _BUTTONS if each.name != "report"),
        footnote=f"Recorded in {answer['run_dir']}",
    )


def _sentence(task: Mapping[str, Any], earlier: Sequence[EarlierRun]) -> str:
    trials = task["trials"]
    if not trials:
        practice = task.get("practice")
        return f"Practice only: {counted(practice['trials'], 'trials')}." if practice else "No trial was ended."
    parts = [f"{task['completed']} of {counted(trials, 'trials')} finished", *_against_last(task, earlier)]
    return ", ".join(parts) + "."


def _against_last(task: Mapping[str, Any], earlier: Sequence[EarlierRun]) -> list[str]:
    """How the mean time compares with that of the run before; nothing where either has none."""
    now, before = _time_of(task), next((run.time_s for run in reversed(earlier) if run.time_s), None)
    if now is None or before is None:
        return []
    change = (before - now) / before
    if abs(change) < _NOTABLE:
        return ["as fast as last time"]
    return [f"{100.0 * abs(change):.0f} % {'faster' if change > 0.0 else 'slower'} than last time"]


def _time_of(task: Mapping[str, Any]) -> float | None:
    return task["time_s"] if task.get("counted") == COUNTED_TRIALS and "time_s" in task else None


def _tiles(task: Mapping[str, Any], earlier: Sequence[EarlierRun]) -> list[tuple[str, str]]:
    """Totals that apply; the best score is over this run and the earlier ones."""
    if task.get("counted") != COUNTED_TRIALS:
        return []
    tiles = []
    if "score" in task:
        best = max([task["score"], *(run.score for run in earlier if run.score is not None)])
        tiles += [("Score of 100", f"{task['score']:.0f}"), ("Best so far", f"{best:.0f}")]
    if (time_s := _time_of(task)) is not None:
        tiles.append(("Mean time" if task["trials"] > 1 else "Time", f"{time_s:.1f} s"))
    if "contacts" in task:
        tiles.append(("Contacts", f"{task['contacts']}"))
    if "placed" in task:
        tiles.append(("Placed", f"{task['placed']}"))
    return tiles


def _line(row: Mapping[str, Any], shown: Sequence[tuple[str, str, Callable[[float], str]]]) -> tuple[str, ...]:
    name = "Practice" if row.get("practice") else f"{row.get('trial', '')}"
    outcome = _OUTCOMES.get(str(row.get("outcome")), str(row.get("outcome", "")))
    cause = row.get("cause")
    cells = ("" if (value := row.get(key)) is None else text(value) for key, _, text in shown)
    return (name, f"{outcome}: {cause}" if cause else outcome, *cells)
