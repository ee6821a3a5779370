"""Limits in time of a trial: the trial's own, else a parameter's, else the task's."""

from __future__ import annotations

from collections.abc import Mapping

from mimics_app.tasks.task import DurationGoal, TaskSpec
from mimics_app.tasks.trials import Trial

__all__ = ["TrialTimes"]


class TrialTimes:
    """Times of the trials of a task; `settings` are the values of the task set by parameters, by name."""

    def __init__(self, spec: TaskSpec) -> None:
        self._spec = spec
        self._asked = max((goal.seconds for goal in spec.goals if isinstance(goal, DurationGoal)), default=0.0)

    def limit_s(self, trial: Trial, settings: Mapping[str, object]) -> float:
        """Return the longest travel [s]."""
        return _chosen(trial.time_limit_s, settings.get("time_limit_s"), self._spec.time_limit_s)

    def length_s(self, trial: Trial, settings: Mapping[str, object]) -> float:
        """Return the duration of a trial without a path: that of its goals, at most its limit [s]."""
        limit = self.limit_s(trial, settings)
        return min(self._asked, limit) if self._asked > 0.0 else limit

    def rest_s(self, trial: Trial, settings: Mapping[str, object]) -> float:
        """Return the rest after the trial [s]."""
        return _chosen(trial.rest_s, settings.get("rest_s"), self._spec.rest_s)


def _chosen(own: float | None, adapted: object, otherwise: float) -> float:
    if own is not None:
        return own
    return float(adapted) if isinstance(adapted, int | float) else otherwise
