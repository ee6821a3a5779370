"""Points of a trial, 0-100, and the totals of a session."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from mimics_app.tasks.tally import Measures
from mimics_app.tasks.task import ScorePartSpec, ScoreSpec

__all__ = ["part_marks", "session_result", "trial_points"]


def trial_points(spec: ScoreSpec, measures: Measures, *, finished: bool) -> float:
    """Points of one trial.

        100 * sum(weight_i * marks_i) / sum(weight_i), marks_i falling linearly from 1 at `best` to 0 at `worst`

    A trial that did not reach its goal earns that times the share of the way it came, so that a short unfinished
    travel cannot beat a finished one. Smoothness that cannot be judged (nothing moved) counts as 0 marks.
    """
    values = {
        "time": measures.time_s,
        "path_error": measures.path_error_rms_m,
        "contacts": float(measures.contacts),
        "smoothness": -math.inf if measures.smoothness is None else measures.smoothness,
        "path": measures.path_m,
        "drops": float(measures.drops),
        "bruises": float(measures.bruises),
        "grasp_error": measures.grasp_error_n,
    }
    parts: dict[str, ScorePartSpec] = {name: getattr(spec, name) for name in values}
    total = sum(part.weight for part in parts.values())
    marks = sum(part.weight * part_marks(part, values[name]) for name, part in parts.items()) / total
    return 100.0 * marks * (1.0 if finished else min(max(measures.progress, 0.0), 1.0))


def part_marks(part: ScorePartSpec, value: float) -> float:
    """Marks 0-1 of one measure; beyond `best` no more than 1, beyond `worst` no less than 0."""
    if math.isinf(value):
        return 1.0 if (value > 0.0) == (part.best > part.worst) else 0.0
    return min(max((part.worst - value) / (part.worst - part.best), 0.0), 1.0)


def session_result(
    rows: Sequence[Mapping[str, object]], *, trials: int, completed: int, carries: bool = False
) -> dict[str, float]:
    """Totals under the keys of `mimics run --json`.

    Args:
        rows: Trial rows that count.
        trials: Trials that are over.
        completed: Those that reached their goal.
        carries: Something is carried in this task: every trial completed placed it.

    Returns:
        completed, trials; score, time_s [s] and path_error_m (rms) [m] as means over the rows; contacts as their sum;
        placed: how often what is carried was set down at its mark. Where something is carried also drops and bruises
        (sums), path_m [m] and grasp_error_n [N] (means).
    """
    carried = {
        "drops": int(sum(_number(row, "drops") for row in rows)),
        "bruises": int(sum(_number(row, "bruises") for row in rows)),
        "path_m": _mean(rows, "path_m"),
        "grasp_error_n": _mean(rows, "grasp_error_n"),
    }
    return {
        "completed": completed,
        "trials": trials,
        "score": _mean(rows, "score"),
        "time_s": _mean(rows, "time_s"),
        "path_error_m": _mean(rows, "path_error_rms_m"),
        "contacts": int(sum(_number(row, "contacts") for row in rows)),
        "placed": completed if carries else 0,
        **(carried if carries else {}),
    }


def _mean(rows: Sequence[Mapping[str, object]], name: str) -> float:
    return sum(_number(row, name) for row in rows) / len(rows) if rows else 0.0


def _number(row: Mapping[str, object], name: str) -> float:
    value = row[name]
    if not isinstance(value, int | float):
        raise TypeError(f'"{name}" of a trial row is {value!r}, no number')
    return float(value)
