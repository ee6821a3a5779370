"""The flow of a trial: which state follows which, and when.

approach --arrived--> ready --soft start over--> travel --goal--> finished --> rest --> approach of the next trial
   |                    |                          `--time over--> timeout -----^ `--> done after the last one
   `----- too slow -----+--> aborted --> approach of the same trial, or rest when its attempts are spent
any state but done --SAFE_STOP, E_STOP--> stopped --operator's reset--> as after aborted; rest when the trial was over
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

__all__ = ["Conditions", "State", "next_state"]


class State(StrEnum):
    """Where a trial stands."""

    APPROACH = "approach"  # PD drives the robot to the start
    READY = "ready"  # start cue; the force is let in softly
    TRAVEL = "travel"  # the person acts; the clock runs
    FINISHED = "finished"  # goal met; the result is shown
    TIMEOUT = "timeout"  # time over; the result is shown
    ABORTED = "aborted"  # start not reached, or soft start not over, in time
    STOPPED = "stopped"  # safety stop; waits for the operator
    REST = "rest"  # pause before the next trial
    DONE = "done"  # the last trial is over


@dataclass(frozen=True, slots=True)
class Conditions:
    """What the next state depends on.

    Attributes:
        elapsed_s: Time in the present state [s].
        latched: A safety stop holds.
        arrived: The robot has stayed at the start long enough.
        go: Soft start over and the start cue shown long enough.
        goal: All goals are met.
        start_limit_s: Longest approach, and longest soft start [s].
        time_limit_s: Longest travel [s].
        result_s: How long a result is shown [s].
        rest_s: Pause [s].
        trial_over: The current trial reached its goal or its time, or was given up.
        attempts_left: The current trial may be begun again.
        trials_left: Another trial follows.
    """

    elapsed_s: float
    latched: bool = False
    arrived: bool = False
    go: bool = False
    goal: bool = False
    start_limit_s: float = 20.0
    time_limit_s: float = 60.0
    result_s: float = 2.0
    rest_s: float = 3.0
    trial_over: bool = False
    attempts_left: bool = True
    trials_left: bool = True


def next_state(state: State, seen: Conditions) -> State:
    """The state of the next frame; the same one when nothing happened. A goal met at the limit counts as met."""
    if state is State.DONE:
        return state
    if seen.latched:
        return State.STOPPED
    return _FLOW[state](seen)


def _leave_approach(seen: Conditions) -> State:
    if seen.arrived:
        return State.READY
    return State.ABORTED if seen.elapsed_s >= seen.start_limit_s else State.APPROACH


def _leave_ready(seen: Conditions) -> State:
    if seen.go:
        return State.TRAVEL
    return State.ABORTED if seen.elapsed_s >= seen.start_limit_s else State.READY


def _leave_travel(seen: Conditions) -> State:
    if seen.goal:
        return State.FINISHED
    return State.TIMEOUT if seen.elapsed_s >= seen.time_limit_s else State.TRAVEL


def _leave_finished(seen: Conditions) -> State:
    return State.FINISHED if seen.elapsed_s < seen.result_s else _follow_trial(seen)


def _leave_timeout(seen: Conditions) -> State:
    return State.TIMEOUT if seen.elapsed_s < seen.result_s else _follow_trial(seen)


def _leave_aborted(seen: Conditions) -> State:
    return State.ABORTED if seen.elapsed_s < seen.result_s else _follow_attempt(seen)


def _leave_stopped(seen: Conditions) -> State:
    return _follow_trial(seen) if seen.trial_over else _follow_attempt(seen)


def _leave_rest(seen: Conditions) -> State:
    return State.REST if seen.elapsed_s < seen.rest_s else State.APPROACH


def _follow_trial(seen: Conditions) -> State:
    return State.REST if seen.trials_left else State.DONE


def _follow_attempt(seen: Conditions) -> State:
    return State.APPROACH if seen.attempts_left else _follow_trial(seen)


_FLOW = {
    State.APPROACH: _leave_approach,
    State.READY: _leave_ready,
    State.TRAVEL: _leave_travel,
    State.FINISHED: _leave_finished,
    State.TIMEOUT: _leave_timeout,
    State.ABORTED: _leave_aborted,
    State.STOPPED: _leave_stopped,
    State.REST: _leave_rest,
}
