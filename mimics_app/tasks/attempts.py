"""Trials and attempts of a session: the present one, and the rows of the finished ones."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, replace
from typing import Any, NamedTuple

from mimics_app.contracts.messages.stage_messages import TrialResult
from mimics_app.contracts.messages.trial_counts import ABORTED, FINISHED, SESSION_ENDED, count_trials, counted_rows
from mimics_app.contracts.system.phrases import phrase
from mimics_app.tasks.kinds.kind import KindPlay
from mimics_app.tasks.observation import Observation
from mimics_app.tasks.outcome_words import largest_losses
from mimics_app.tasks.score import session_result, trial_points
from mimics_app.tasks.tally import Measures, Tally
from mimics_app.tasks.task import ScoreSpec
from mimics_app.tasks.trials import Trial

__all__ = ["TIMEOUT", "Attempts", "PlayedKinds", "Row"]

Row = dict[str, Any]
"""One attempt: trial, attempt, block, label, repetition, practice, outcome, cause, begin_ns, end_ns, the fields of
`Measures`, what the task's kinds measure, score, happened and lost (for the person, see `tasks.outcome_words`), and
`parameter.NAME` for each adaptable parameter as it stood at the end. The same keys in every row; a measure is None
where it does not apply or cannot be evaluated, the score where the attempt was aborted or the task has none. A trial
that did not reach its goal has no points."""

TIMEOUT = "timeout"


class PlayedKinds(NamedTuple):
    """What the kinds of a task say of its attempts.

    Attributes:
        plays: The kinds as they play.
        counts: Their names for the number of trials that reached their goal.
        tell: Returns in words how the travel of a row ended.
        touches: Whether contacts are counted.
    """

    plays: Sequence[KindPlay]
    counts: Sequence[str]
    tell: Callable[[Row], str]
    touches: bool


class Attempts:
    """Counts trials and attempts, and writes a row at the end of each attempt.

    Attributes:
        number: Number of the current trial, 0 first; -1 before the first.
        attempt: Number of the attempt at it, 1 first.
        begun: Number of attempts in the session.
        tally: Measures of the travel, once it has begun.
        rows: Rows of the attempts so far.
        score: Score of the last trial that has one.

    Args:
        plan: The trials.
        score: Weights; None for a task without a score.
        most_attempts: Largest number of attempts at a trial.
        on_row: Called with each row.
        kinds: What the task's kinds say of them.
        first: Trial to begin with, 0 first.
    """

    def __init__(
        self,
        plan: Sequence[Trial],
        score: ScoreSpec | None,
        most_attempts: int,
        on_row: Callable[[Row], None],
        kinds: PlayedKinds,
        first: int,
    ) -> None:
        self.plan = tuple(plan)
        self.number = first - 1
        self.attempt = 0
        self.begun = 0
        self.tally: Tally | None = None
        self.rows: list[Row] = []
        self.score = 0.0
        self._score_spec = score
        self._most = most_attempts
        self._on_row = on_row
        self._kinds = kinds
        self._begin_ns = 0
        self._open = self._given_up = False

    @property
    def finished(self) -> int:
        """Trials that reached their goal so far."""
        return sum(row["outcome"] == FINISHED for row in self.rows)

    @property
    def trial(self) -> Trial:
        """The current trial."""
        return self.plan[max(self.number, 0)]

    @property
    def which(self) -> str:
        """Caption of the current trial: practice, or its number among those that count."""
        if self.trial.practice:
            return phrase("Practice")
        counted = [trial for trial in self.plan if not trial.practice]
        number = sum(not trial.practice for trial in self.plan[: max(self.number, 0) + 1])
        return phrase("Trial {number:d} of {trials:d}", number=number, trials=len(counted))

    @property
    def trials_left(self) -> bool:
        """Whether another trial follows the current one."""
        return self.number + 1 < len(self.plan)

    @property
    def attempts_left(self) -> bool:
        """Whether another attempt at the current trial is allowed."""
        return self.attempt < self._most and not self._given_up

    @property
    def trial_over(self) -> bool:
        """Whether the current trial reached its goal or its time limit, or has no attempts left."""
        if self._open or not self.rows:
            return False
        return self.rows[-1]["outcome"] != ABORTED or not self.attempts_left

    @property
    def under_way(self) -> bool:
        """Whether a trial has begun and is not over; it may wait for its next attempt."""
        return self.begun > 0 and not self.trial_over

    def own_values(self, name: str) -> tuple[int, int]:
        """Return how many of the trials to come have their own value of a parameter, and how many are to come."""
        coming = self.plan[self.number + 1 :]
        return sum(name in trial.values for trial in coming), len(coming)

    def prefer(self, block: int) -> None:
        """Let the first remaining trial of a block, 1 first, be next; 0 or a finished block keeps the order."""
        ahead = self.number + 1
        names = list(dict.fromkeys(trial.block for trial in self.plan))
        if not 1 <= block <= len(names):
            return
        found = next((i for i in range(ahead, len(self.plan)) if self.plan[i].block == names[block - 1]), None)
        if found is not None and found != ahead:
            left = [self.plan[found], *(t for i, t in enumerate(self.plan[ahead:], ahead) if i != found)]
            left = [replace(trial, number=ahead + i) for i, trial in enumerate(left)]
            self.plan = (*self.plan[:ahead], *left)

    def give_up(self) -> None:
        """Allow no further attempt at the current trial."""
        self._given_up = True

    def repeat(self) -> None:
        """Let the current trial be played once more as the next one; those after it keep their order."""
        ahead = self.number + 1
        following = (self.trial, *self.plan[ahead:])
        self.plan = (*self.plan[:ahead], *(replace(t, number=ahead + i) for i, t in enumerate(following)))

    def begin(self, now_ns: int) -> bool:
        """Begin the next attempt, at the next trial where the current is over; return True for a new trial."""
        fresh = self.begun == 0 or self.trial_over
        if fresh:
            self.number += 1
            self.attempt = 0
            self._given_up = False
        self.attempt += 1
        self.begun += 1
        self.tally = None
        self._begin_ns = now_ns
        self._open = True
        return fresh

    def start_attempt(self, seen: Observation) -> None:
        """Begin the travel with this frame."""
        self.tally = Tally(seen, self._kinds.plays)
        for play in self._kinds.plays:
            play.start_attempt(seen)

    def end(self, outcome: str, cause: str, parameters: Mapping[str, float], now_ns: int) -> None:
        """Write the row of the attempt under way, if any."""
        if not self._open:
            return
        row = self._row(outcome, cause, parameters, now_ns)
        self._open = False
        if row["score"] is not None:
            self.score = row["score"]
        self.rows.append(row)
        self._on_row(row)

    def trial_result(self, values: Mapping[str, float], now_ns: int) -> TrialResult:
        """Return the result of the attempt that just finished or timed out, for a learning system.

        The performance of a trial whose time was over is that of its measures, times its progress.
        """
        row = self.rows[-1]
        finished = row["outcome"] == FINISHED
        performance = float(finished)
        if self._score_spec is not None:
            performance = trial_points(self._score_spec, row, finished=finished) / 100.0
        return TrialResult(
            row["trial"], now_ns, row["outcome"], performance, performance, bool(row["practice"]), dict(values)
        )

    def result(self, now_ns: int) -> dict[str, Any]:
        """Return the totals of the session: its `TrialCounts`, and the totals of `tasks.score.session_result`.

        The latter are over trials that finished or timed out, over practice only where there is nothing else, and over
        the one under way or cut off by the session's end where none has ended. `counted` states which.
        """
        cut_off = [row for row in self.rows if row["cause"] == SESSION_ENDED and row["time_s"] > 0.0]
        if self._open and self.tally is not None:
            cut_off.append(self._row(ABORTED, SESSION_ENDED, {}, now_ns))
        which, ended = counted_rows(self.rows)
        totals: dict[str, Any] = session_result(ended or cut_off)
        if totals:
            totals["counted"] = which
        counts = count_trials(self.rows)
        return {**counts.as_dict(), **totals, **dict.fromkeys(self._kinds.counts, counts.completed)}

    def _row(self, outcome: str, cause: str, parameters: Mapping[str, float], now_ns: int) -> Row:
        measures = self.tally.row() if self.tally else self._blank()
        if not self._kinds.touches:
            measures |= dict.fromkeys(("contacts", "contact_time_s"))
        row = {
            "trial": self.number,
            "attempt": self.attempt,
            "block": self.trial.block,
            "label": self.trial.label,
            "repetition": self.trial.repetition,
            "practice": self.trial.practice,
            "outcome": outcome,
            "cause": cause,
            "begin_ns": self.tally.begin_ns if self.tally else self._begin_ns,
            "end_ns": now_ns,
            **measures,
            "score": self._points(measures, outcome),
        }
        row["happened"] = "" if outcome == ABORTED else self._kinds.tell(row)
        row["lost"] = largest_losses(self._score_spec, row) if self._score_spec and outcome == FINISHED else ""
        return row | {f"parameter.{name}": value for name, value in parameters.items()}

    def _points(self, measures: Mapping[str, object], outcome: str) -> float | None:
        """Return the score of a row; None where the attempt was aborted or the task has none."""
        if self._score_spec is None or outcome == ABORTED:
            return None
        return trial_points(self._score_spec, measures, finished=True) if outcome == FINISHED else 0.0

    def _blank(self) -> dict[str, Any]:
        """Return the measures of an attempt without travel, with the same columns."""
        return asdict(Measures()) | {column: None for play in self._kinds.plays for column in play.measures}
