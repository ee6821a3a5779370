"""State of a trial for stages other than the task."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

__all__ = ["TaskView", "TrialState"]


class TrialState(StrEnum):
    """States of a trial; transitions are in `tasks.state_machine`."""

    APPROACH = "approach"  # PD drives the robot to the start
    READY = "ready"  # start cue; the robot holds the start
    TRAVEL = "travel"  # the person acts, the force begins softly; the clock runs
    FINISHED = "finished"  # goal reached; the result is shown
    TIMEOUT = "timeout"  # time over; the result is shown
    ABORTED = "aborted"  # start not reached or not held in time, or goal reached too fast
    STOPPED = "stopped"  # safety stop; waits for the operator
    REST = "rest"  # pause before the next trial
    DONE = "done"  # the last trial is over


_PERSON_LEADS = frozenset({TrialState.TRAVEL, TrialState.STOPPED})


@dataclass(frozen=True, slots=True)
class TaskView:
    """State of the task in one frame, for other stages; text for the person is on the board.

    Attributes:
        state: State of the current trial.
        progress: Progress of that trial, 0-1: along its path, else of its time.
        trial: Number of the trial, from 1; 0 before the first.
        trials: Number of trials.
        elapsed_s: Time in the present state [s].
        paused: The task and its clock are paused until the person continues.
        reading: The first trial waits until the page of keys at the window is confirmed.
    """

    state: TrialState = TrialState.APPROACH
    progress: float = 0.0
    trial: int = 0
    trials: int = 0
    elapsed_s: float = 0.0
    paused: bool = False
    reading: bool = False

    @property
    def robot_leads(self) -> bool:
        """Whether the robot moves or holds the hand; the cursor then stays on the ball."""
        return self.paused or self.between_trials

    @property
    def between_trials(self) -> bool:
        """Whether no trial is under way."""
        return self.state not in _PERSON_LEADS
