"""Where a trial stands: what stages other than the task steer by."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

__all__ = ["TaskView", "TrialState"]


class TrialState(StrEnum):
    """States of a trial; which follows which: `tasks.state_machine`."""

    APPROACH = "approach"  # PD drives the robot to the start
    READY = "ready"  # start cue; the force is let in softly
    TRAVEL = "travel"  # the person acts; the clock runs
    FINISHED = "finished"  # goal met; the result is shown
    TIMEOUT = "timeout"  # time over; the result is shown
    ABORTED = "aborted"  # start not reached, or soft start not over, in time
    STOPPED = "stopped"  # safety stop; waits for the operator
    REST = "rest"  # pause before the next trial
    DONE = "done"  # the last trial is over


_PERSON_LEADS = frozenset({TrialState.READY, TrialState.TRAVEL, TrialState.STOPPED})


@dataclass(frozen=True, slots=True)
class TaskView:
    """How the task stands in one frame, for whoever acts on it; what a person reads is the board's.

    Attributes:
        state: Of the trial under way.
        progress: Share of that trial that is done, 0-1: of its way, else of its time.
        trial: Its number, from 1; 0 before the first.
        trials: How many there are.
        elapsed_s: Time in the present state [s].
        on_a_way: Whether a kind of task measures the progress; else it is that of the time.
        paused: The task and its clock are halted until the person goes on.
        reading: The first trial waits until somebody at the window has read the page of keys.
    """

    state: TrialState = TrialState.APPROACH
    progress: float = 0.0
    trial: int = 0
    trials: int = 0
    elapsed_s: float = 0.0
    on_a_way: bool = True
    paused: bool = False
    reading: bool = False

    @property
    def robot_leads(self) -> bool:
        """Whether the robot moves, or holds, the hand: a cursor then rests on the ball."""
        return self.paused or self.state not in _PERSON_LEADS
