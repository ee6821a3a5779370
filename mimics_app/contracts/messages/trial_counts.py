"""Counts of ended and completed trials of a session, the same for the terminal, `--json` and the report.

A trial *ended* when it reached its goal, ran out of time, or its last attempt was aborted, but not when the session
ended during it. It is *completed* when an attempt at it reached its goal. Practice is counted separately.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from mimics_app.contracts.system.phrases import counted_phrase

__all__ = [
    "ABORTED",
    "COUNTED_PRACTICE",
    "COUNTED_TRIALS",
    "COUNTED_UNDER_WAY",
    "FINISHED",
    "SESSION_ENDED",
    "TrialCounts",
    "count_trials",
    "counted_rows",
    "finished_words",
    "practice_only",
]

FINISHED = "finished"
"""Outcome of an attempt that reached its goal."""

ABORTED = "aborted"
"""Outcome of an attempt that neither reached its goal nor ran out of time."""

SESSION_ENDED = "session ended"
"""Cause in the row of an attempt during which the session was closed."""

COUNTED_TRIALS, COUNTED_PRACTICE, COUNTED_UNDER_WAY = "trials", "practice", "under way"
"""Basis of a session's totals (key `counted`): trials that ended, practice only, or a trial under way."""


@dataclass(frozen=True, slots=True)
class TrialCounts:
    """Trials of a session.

    Attributes:
        completed, trials: Completed and ended trials without practice.
        practice_completed, practice_trials: Completed and ended practice trials.
    """

    completed: int = 0
    trials: int = 0
    practice_completed: int = 0
    practice_trials: int = 0

    def as_dict(self) -> dict[str, object]:
        """Return the counts under the keys of `mimics run --json`; `practice` only if such trials ended."""
        practice = {"completed": self.practice_completed, "trials": self.practice_trials}
        return {
            "completed": self.completed,
            "trials": self.trials,
            **({"practice": practice} if self.practice_trials else {}),
        }


def count_trials(rows: Iterable[Mapping[str, object]]) -> TrialCounts:
    """Count the trials in rows of trials.csv, in order; the last attempt at a trial decides."""
    last = {str(row.get("trial")): row for row in rows}  # a damaged table may hold any value
    ended = [row for row in last.values() if row.get("cause") != SESSION_ENDED]
    practice = [row for row in ended if row.get("practice")]
    counted = [row for row in ended if not row.get("practice")]
    return TrialCounts(_completed(counted), len(counted), _completed(practice), len(practice))


def counted_rows(rows: Iterable[Mapping[str, object]]) -> tuple[str, list[Mapping[str, object]]]:
    """Return the basis of a session's totals and its rows; ("under way", []) if none ended.

    The rows are those of attempts that reached their goal or ran out of time; practice only if there are no others.
    """
    ended = [row for row in rows if row.get("outcome") != ABORTED]
    trials = [row for row in ended if not row.get("practice")]
    return COUNTED_TRIALS if trials else COUNTED_PRACTICE if ended else COUNTED_UNDER_WAY, trials or ended


def finished_words(completed: int, trials: int) -> str:
    """Return how many trials were finished, as a phrase."""
    return counted_phrase(
        "{done:d} of {n:d} trial finished", "{done:d} of {n:d} trials finished", trials, done=completed
    )


def practice_only(trials: int) -> str:
    """Return how many trials of practice ended where no other did, as a phrase."""
    return counted_phrase("Practice only: {n:d} trial.", "Practice only: {n:d} trials.", trials)


def _completed(rows: Iterable[Mapping[str, object]]) -> int:
    return sum(row.get("outcome") == FINISHED for row in rows)
