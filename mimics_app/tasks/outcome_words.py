"""Words to a person about a trial: what happened, and what cost the most points."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from mimics_app.contracts.messages.trial_counts import FINISHED
from mimics_app.contracts.system.phrases import counted_phrase, phrase
from mimics_app.tasks.kinds.kind import KindPlay
from mimics_app.tasks.kinds.registry import task_kinds
from mimics_app.tasks.score import lost_points
from mimics_app.tasks.task import MEASURES, DurationGoal, GoalSpec, PointGoal, ScoreSpec

__all__ = ["largest_losses", "loss_captions", "result_lines", "what_happened"]

_LEAST_LOSS = 1.0
"""Smallest loss that is mentioned [points]."""
_MOST_LOSSES = 2
_CAPTIONS: Mapping[str, str] = {
    "path_error": phrase("distance from the line"),
    "contact_time": phrase("time in contact"),
    "smoothness": phrase("unsteady movement"),
    "path": phrase("way of the hand"),
    "grasp_error": phrase("grip off the right force"),
    "walk_left": phrase("way left to the place"),
}
"""Captions of parts of the score whose name says too little."""
_SHARES = ("on_beam_share", "symmetry", "obstacles_met")
"""Columns whose values are shares, 0 to 1."""


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
        outcome = outcome if acted else phrase("the {limb} did nothing", limb=limb)
        return _time_is_over(outcome) if outcome else phrase("Time is over")
    if any(isinstance(goal, DurationGoal) for goal in goals):
        return _time_is_over(outcome or _moved(row, limb))
    if outcome:
        return outcome
    seconds = _number(row, "time_s")
    if all(isinstance(goal, PointGoal) for goal in goals):
        return phrase("Point reached in {seconds:.1f} s", seconds=seconds)
    return phrase("Goal reached in {seconds:.1f} s", seconds=seconds)


def _time_is_over(outcome: str) -> str:
    return phrase("Time is over: {outcome}", outcome=outcome)


def _moved(row: Mapping[str, object], limb: str) -> str:
    contacts, metres = round(_number(row, "contacts")), _number(row, "path_m")
    if contacts == 0:
        return phrase("the {limb} moved {metres:.1f} m", limb=limb, metres=metres)
    touched = counted_phrase("{n:d} contact", "{n:d} contacts", contacts)
    return phrase("the {limb} moved {metres:.1f} m, {touched}", limb=limb, metres=metres, touched=touched)


def largest_losses(spec: ScoreSpec, row: Mapping[str, object]) -> str:
    """Return the two largest losses of a finished trial in words, e.g. "31 by time, 48.0 s"; "" without one."""
    lost = sorted(lost_points(spec, row).items(), key=lambda each: -each[1])
    named = [(part, points) for part, points in lost[:_MOST_LOSSES] if points >= _LEAST_LOSS]
    return ", ".join(_loss(part, points, row) for part, points in named)


def result_lines(happened: str, score: float | None, lost: str, *, finished: bool) -> str:
    """Return the lines shown after a trial; points are those of a trial that reached its goal."""
    if score is None or not finished:
        return happened
    if not lost:
        return "\n".join((happened, phrase("{score:.0f} of 100 points", score=score)))
    return "\n".join((happened, phrase("{score:.0f} of 100 points. Lost: {lost}", score=score, lost=lost)))


def loss_captions() -> list[str]:
    """Return the captions of the parts that a score usually has, which are phrases."""
    unscored = {measure.part for kind in task_kinds() if not kind.scored for measure in kind.measures}
    return [_caption(measure.part) for measure in MEASURES if measure.part not in unscored]


def _caption(part: str) -> str:
    return _CAPTIONS.get(part, part.replace("_", " "))


def _loss(part: str, points: float, row: Mapping[str, object]) -> str:
    """Return lost points with the name of their part, and with its figure where that says something."""
    column = next(measure.column for measure in MEASURES if measure.part == part)
    caption = _caption(part)
    if column == "smoothness":
        return phrase("{points:.0f} by {caption:s}", points=points, caption=caption)
    figure = _figure(column, _number(row, column))
    return phrase("{points:.0f} by {caption:s} ({figure:s})", points=points, caption=caption, figure=figure)


def _figure(column: str, value: float) -> str:
    if column.endswith("_mps"):
        return f"{value:.2f} m/s"
    if column.endswith("_s"):
        return f"{value:.1f} s"
    if column.endswith("_n"):
        return f"{value:.1f} N"
    if column.endswith("_m"):
        return f"{1e3 * value:.1f} mm" if abs(value) < 0.1 else f"{value:.2f} m"
    return f"{100.0 * value:.0f} %" if column in _SHARES else f"{value:g}"


def _number(row: Mapping[str, object], name: str) -> float:
    value = row.get(name)
    return float(value) if isinstance(value, int | float) else 0.0
