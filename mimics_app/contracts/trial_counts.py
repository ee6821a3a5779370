"""How many trials of a session ended and were completed: one definition for the terminal, `--json` and the report.

A trial *ended* when it reached its goal, ran out of time, or its last attempt was aborted; one that the end of the
session cut off did not. It is *completed* when an attempt at it reached its goal. Practice is counted apart.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

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
]

FINISHED = "finished"
"""Outcome of an attempt that reached its goal."""

ABORTED = "aborted"
"""Outcome of an attempt that neither reached its goal nor ran out of time."""

SESSION_ENDED = "session ended"
"""Cause of the row of an attempt that was under way when the session was closed."""

COUNTED_TRIALS, COUNTED_PRACTICE, COUNTED_UNDER_WAY = "trials", "practice", "under way"
"""What the totals of a session are over (its key `counted`): trials that ended, practice alone, or one under way."""


@dataclass(frozen=True, slots=True)
class TrialCounts:
    """Trials of a session.

    Attributes:
        completed, trials: Completed and ended ones, practice left out.
        practice_completed, practice_trials: The same of practice.
    """

    completed: int = 0
    trials: int = 0
    practice_completed: int = 0
    practice_trials: int = 0

    def as_dict(self) -> dict[str, object]:
        """Under the keys of `mimics run --json`; `practice` only where some ended."""
        practice = {"completed": self.practice_completed, "trials": self.practice_trials}
        return {
            "completed": self.completed,
            "trials": self.trials,
            **({"practice": practice} if self.practice_trials else {}),
        }


def count_trials(rows: Iterable[Mapping[str, object]]) -> TrialCounts:
    """Count the trials that rows of trials.csv, in order, describe; the last attempt at a trial decides."""
    last = {str(row.get("trial")): row for row in rows}  # a damaged table may hold any value
    ended = [row for row in last.values() if row.get("cause") != SESSION_ENDED]
    practice = [row for row in ended if row.get("practice")]
    counted = [row for row in ended if not row.get("practice")]
    return TrialCounts(_completed(counted), len(counted), _completed(practice), len(practice))


def counted_rows(rows: Iterable[Mapping[str, object]]) -> tuple[str, list[Mapping[str, object]]]:
    """What the totals of a session are over, and these rows; none ended: ("under way", []).

    They are those of travels that came to their goal or their time; practice only where there is nothing else.
    """
    ended = [row for row in rows if row.get("outcome") != ABORTED]
    trials = [row for row in ended if not row.get("practice")]
    return COUNTED_TRIALS if trials else COUNTED_PRACTICE if ended else COUNTED_UNDER_WAY, trials or ended


def _completed(rows: Iterable[Mapping[str, object]]) -> int:
    return sum(row.get("outcome") == FINISHED for row in rows)
