"""Layout of the board of a task: its cards, and the line of its state."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from mimics_app.contracts.messages.board import Board, Card
from mimics_app.contracts.messages.trial_counts import FINISHED, TrialCounts, count_trials, finished_words
from mimics_app.contracts.messages.trial_state import TaskView, TrialState
from mimics_app.contracts.system.phrases import phrase
from mimics_app.tasks.attempts import Attempts
from mimics_app.tasks.cards import count_card, force_card, progress_card, state_card, time_card, trial_card
from mimics_app.tasks.kinds.kind import KindPlay, TaskKind
from mimics_app.tasks.observation import Observation
from mimics_app.tasks.outcome_words import result_lines
from mimics_app.tasks.prompt import aborted_words, cause_words, state_message
from mimics_app.tasks.task import StateName

__all__ = ["BoardLayout", "Times"]


@dataclass(frozen=True, slots=True)
class Times:
    """Times of a frame.

    Attributes:
        elapsed_s: In the present state [s].
        rest_s: Left of the rest [s].
        left_s: Left of the travel [s]; None outside of one.
        length_s: Length of a travel, or its limit [s].
    """

    elapsed_s: float
    rest_s: float
    left_s: float | None
    length_s: float


class BoardLayout:
    """Lays out the board of each frame.

    Args:
        plays: The task's kinds.
        captions: The kind that gives the captions.
        messages: Line of each state.
        limb: Name of the first point of contact, e.g. "hand".
        has_score: Whether the task has a score.
        neutral: Place of a lever's middle in the window, each coordinate -1 to 1; None without a lever.
        prompt: Line during a travel where no kind has anything to say.
    """

    def __init__(
        self,
        plays: Sequence[KindPlay],
        captions: TaskKind | type[TaskKind],
        messages: Mapping[StateName, str],
        limb: str,
        *,
        has_score: bool,
        neutral: tuple[float, float] | None = None,
        prompt: str = "",
    ) -> None:
        self._plays, self._captions, self._messages, self._limb = tuple(plays), captions, messages, limb
        self._has_score, self._neutral, self._prompt = has_score, neutral, prompt

    def lay_out(self, seen: Observation, view: TaskView, attempts: Attempts, cause: int, times: Times) -> Board:
        """Return the board of a frame.

        Args:
            seen: The observation.
            view: State of the task.
            attempts: Trials and attempts so far.
            cause: TripCause of the last stop.
            times: Times of the frame.
        """
        fields = self._fields(view, attempts, times.rest_s)
        prompt = self._prompt
        for play in self._plays:
            fields |= play.words
            prompt = play.prompt or prompt
        if view.state is TrialState.STOPPED:
            fields["cause"] = cause_words(cause)
        line = state_message(view.state, self._messages, times.elapsed_s, fields, prompt)
        alarm, leads = view.state is TrialState.STOPPED, not view.robot_leads
        neutral = self._neutral if leads else None
        asks = view.state is TrialState.TRAVEL and any(play.asks for play in self._plays)
        return Board(self._cards(seen, view, attempts, times), line, alarm=alarm, neutral=neutral, asks=asks)

    def _fields(self, view: TaskView, attempts: Attempts, rest_s: float) -> dict[str, str]:
        row = attempts.rows[-1] if attempts.rows else {}
        finished = row.get("outcome") == FINISHED
        counts: TrialCounts = count_trials(attempts.rows) if view.state is TrialState.DONE else TrialCounts()
        return {
            "score": f"{attempts.score:.0f}",
            "happened": row.get("happened", ""),
            "result": result_lines(row.get("happened", ""), row.get("score"), row.get("lost", ""), finished=finished),
            "aborted": aborted_words(row.get("cause", "")),
            "completed": finished_words(counts.completed, counts.trials),
            "seconds": str(math.ceil(rest_s)),
            "trial": str(view.trial),
            "trials": str(view.trials),
            "which": attempts.which,
        }

    def _cards(self, seen: Observation, view: TaskView, attempts: Attempts, times: Times) -> dict[str, Card]:
        tally = attempts.tally
        cards = {
            "trial": trial_card(attempts.which),
            "state": state_card(view.state),
            **({"progress": progress_card(view.progress, self._captions.label)} if self._plays else {}),
            "time": time_card(tally.time_s if tally else 0.0, times.left_s, times.length_s),
            "contacts": count_card(self._captions.contacts, tally.contacts if tally else 0),
            "force": force_card(seen.force, self._limb),
            **({"score": count_card(phrase("Score"), attempts.score, width=130.0)} if self._has_score else {}),
        }
        for play in self._plays:
            cards |= play.cards(seen, attempts.finished)
        return cards
