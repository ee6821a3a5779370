"""What a person is told about a trial: what happened, and what cost the most points."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from mimics_app.contracts.errors import counted
from mimics_app.contracts.messages.trial_counts import FINISHED
from mimics_app.tasks.kinds.kind import KindPlay
from mimics_app.tasks.score import lost_points
from mimics_app.tasks.task import MEASURES, DurationGoal, GoalSpec, PointGoal, ScoreSpec

__all__ = ["largest_losses", "result_lines", "what_happened"]

_LEAST_LOSS = 1.0
"""Smallest loss that is mentioned [points]."""
_MOST_LOSSES = 2
_CAPTIONS: Mapping[str, str] = {
    "path_error": "distance from the line",
    "contact_time": "time in contact",
    "smoothness": "unsteady movement",
    "path": "way of the hand",
    "grasp_error": "grip off the right force",
    "walk_left": "way left to the place",
}
"""Captions of parts of the score whose name says too little."""


def what_happened(
    goals: Sequence[GoalSpec], plays: Sequence[KindPlay], row: Mapping[str, object], *, acted: bool, limb: str
) -> str:
    """Return how a travel ended, as a sentence without its full stop.

    Args:
        goals: Goals of the task.
        plays: Its kinds; the last one that has words for it gives them.
        row: Outcome and measures by column of the trial table.
        acted: Whether the person took part.
        limb: Name of the first point of contact, e.g. "hand".
    """
    finished = row["outcome"] == FINISHED
    outcome = next((words for play in reversed(plays) if (words := play.outcome_words(row, finished=finished))), "")
    if not finished:
        outcome = outcome if acted else f"the {limb} did nothing"
        return f"Time is over: {outcome}" if outcome else "Time is over"
    if any(isinstance(goal, DurationGoal) for goal in goals):
        return f"Time is over: {outcome or _moved(row, limb)}"
    aim = "Point" if all(isinstance(goal, PointGoal) for goal in goals) else "Goal"
    return outcome or f"{aim} reached in {_number(row, 'time_s'):.1f} s"


def _moved(row: Mapping[str, object], limb: str) -> str:
    contacts = round(_number(row, "contacts"))
    touched = counted(contacts, "contacts") if contacts else "nothing touched"
    return f"the {limb} moved {_number(row, 'path_m'):.1f} m, {touched}"


def largest_losses(spec: ScoreSpec, row: Mapping[str, object]) -> str:
    """Return the two largest losses of a finished trial in words, e.g. "31 by time, 48.0 s"; "" without one."""
    lost = sorted(lost_points(spec, row).items(), key=lambda each: -each[1])
    named = [(part, points) for part, points in lost[:_MOST_LOSSES] if points >= _LEAST_LOSS]
    return ", ".join(f"{points:.0f} by {_caption(part, row)}" for part, points in named)


def result_lines(happened: str, score: float | None, lost: str, *, finished: bool) -> str:
    """Return the lines shown after a trial; points are those of a trial that reached its goal."""
    if score is None or not finished:
        return happened
    points = f"{score:.0f} of 100 points"
    return f"{happened}\n{points}{f'. Lost: {lost}' if lost else ''}"


def _caption(part: str, row: Mapping[str, object]) -> str:
    """Return the name of a part of the score, with its figure where that says something."""
    column = next(measure.column for measure in MEASURES if measure.part == part)
    name = _CAPTIONS.get(part, part.replace("_", " "))
    if column == "smoothness":
        return name
    value = _number(row, column)
    if column.endswith("_mps"):
        return f"{name} ({value:.2f} m/s)"
    if column.endswith("_s"):
        return f"{name} ({value:.1f} s)"
    if column.endswith("_n"):
        return f"{name} ({value:.1f} N)"
    if column.endswith("_m"):
        return f"{name} ({1e3 * value:.1f} mm)" if abs(value) < 0.1 else f"{name} ({value:.2f} m)"
    return f"{name} ({value:g})"


def _number(row: Mapping[str, object], name: str) -> float:
    value = row.get(name)
    return float(value) if isinstance(value, int | float) else 0.0
