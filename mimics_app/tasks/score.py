"""Score of a trial, 0 to 100, and the totals of a session."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from mimics_app.tasks.kinds.kind import Measure, ScorePartSpec
from mimics_app.tasks.task import MEASURES, ScoreSpec

__all__ = ["lost_points", "part_marks", "session_result", "trial_points"]


def trial_points(spec: ScoreSpec, row: Mapping[str, object], *, finished: bool) -> float:
    """Return the score of one trial.

        100 * sum(weight_i * marks_i) / sum(weight_i), marks_i falling linearly from 1 at `best` to 0 at `worst`

    A measure that does not apply (a path error without a path) counts in neither sum. Undefined smoothness (without
    movement) counts as 0 marks. The score of a trial that did not reach its goal is multiplied by its progress: a short
    unfinished travel cannot exceed a finished one.

    Args:
        spec: The weights.
        row: Measures by column of the trial table (`Tally.row`).
        finished: Whether the goal was reached.
    """
    taken = [measure for measure in MEASURES if _is_taken(measure, row)]
    total = sum(spec.part(measure.part).weight for measure in taken)
    if total <= 0.0:
        return 0.0
    marks = sum(spec.part(m.part).weight * part_marks(spec.part(m.part), _value(m, row)) for m in taken) / total
    share = 0.0 if row.get("progress") is None else _number(row, "progress")
    return 100.0 * marks * (1.0 if finished else min(max(share, 0.0), 1.0))


def lost_points(spec: ScoreSpec, row: Mapping[str, object]) -> dict[str, float]:
    """Return the points that each part of the score costs a finished trial; they and its score sum up to 100."""
    taken = [(measure, spec.part(measure.part)) for measure in MEASURES if _is_taken(measure, row)]
    total = sum(part.weight for _, part in taken)
    return {
        measure.part: 100.0 * part.weight / total * (1.0 - part_marks(part, _value(measure, row)))
        for measure, part in taken
        if part.weight > 0.0
    }


def _is_taken(measure: Measure, row: Mapping[str, object]) -> bool:
    return measure.part == "smoothness" or row.get(measure.column) is not None


def _value(measure: Measure, row: Mapping[str, object]) -> float:
    """Return the measure; -inf for an undefined smoothness."""
    return -math.inf if row.get(measure.column) is None else _number(row, measure.column)


def part_marks(part: ScorePartSpec, value: float) -> float:
    """Return the marks of one measure, linear between `worst` (0) and `best` (1) and limited to this range."""
    if math.isinf(value):
        return 1.0 if (value > 0.0) == (part.best > part.worst) else 0.0
    return min(max((part.worst - value) / (part.worst - part.best), 0.0), 1.0)


def session_result(rows: Sequence[Mapping[str, object]]) -> dict[str, float]:
    """Return the totals over the trial rows that count, under the keys of `mimics run --json`.

    Returns:
        The mean score, then the total of each measure (a mean or a sum over the rows, see `Measure`). Measures without
        a value in any row are left out.
    """
    totals: dict[str, float] = {}
    for column, total, sums in [("score", "score", False), *((m.column, m.total, m.sums) for m in MEASURES)]:
        taken = [row for row in rows if row.get(column) is not None]
        if total and taken:
            whole = sum(_number(row, column) for row in taken)
            totals[total] = whole if sums else whole / len(taken)
    return totals


def _number(row: Mapping[str, object], name: str) -> float:
    value = row[name]
    if not isinstance(value, int | float):
        raise TypeError(f'"{name}" of a trial row is {value!r}, no number')
    return value
