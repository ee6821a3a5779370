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
    travel cannot beat a finished one. What cannot be judged (smoothness where nothing moved, grasp error where nothing
    was held) counts as 0 marks.
    """
    values = {
        "time": measures.time_s,
        "path_error": measures.path_error_rms_m,
        "contacts": float(measures.contacts),
        "smoothness": -math.inf if measures.smoothness is None else measures.smoothness,
        "path": measures.path_m,
        "drops": float(measures.drops),
        "bruises": float(measures.bruises),
        "grasp_error": math.inf if measures.grasp_error_n is None else measures.grasp_error_n,
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


def session_result(rows: Sequence[Mapping[str, object]]) -> dict[str, float]:
    """Figures of a session over the trial rows that count, those alone that the rows have.

    Returns:
        score, time_s [s], path_error_m (rms) [m] as means over the rows, contacts as their sum; where something is
        carried also drops and bruises (sums), path_m [m] and grasp_error_n [N] (means).
    """
    carries = any("drops" in row for row in rows)
    means = {"score": "score", "time_s": "time_s", "path_error_m": "path_error_rms_m"}
    carried = {"path_m": "path_m", "grasp_error_n": "grasp_error_n"}
    found: dict[str, float | None] = {key: _mean(rows, name) for key, name in means.items()}
    found["contacts"] = _sum(rows, "contacts")
    if carries:
        found |= {"drops": _sum(rows, "drops"), "bruises": _sum(rows, "bruises")}
        found |= {key: _mean(rows, name) for key, name in carried.items()}
    return {key: value for key, value in found.items() if value is not None}


def _mean(rows: Sequence[Mapping[str, object]], name: str) -> float | None:
    values = _numbers(rows, name)
    return sum(values) / len(values) if values else None


def _sum(rows: Sequence[Mapping[str, object]], name: str) -> int | None:
    values = _numbers(rows, name)
    return int(sum(values)) if values else None


def _numbers(rows: Sequence[Mapping[str, object]], name: str) -> list[float]:
    """The values of a column, rows without one left out."""
    values = [row[name] for row in rows if row.get(name) is not None]
    wrong = next((value for value in values if not isinstance(value, int | float)), None)
    if wrong is not None:
        raise TypeError(f'"{name}" of a trial row is {wrong!r}, no number')
    return [float(value) for value in values if isinstance(value, int | float)]
