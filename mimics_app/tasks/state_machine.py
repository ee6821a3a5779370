"""The state machine of a trial.

approach --arrived--> ready --go--> travel --goal--> finished --> rest --> approach of the next trial
   |                    |            |  `--time over--> timeout -----^ `--> done after the last one
   `----- too slow -----+-- too fast-+--> aborted --> approach of the same trial, or rest when its attempts are spent
approach, ready, travel --skip, repeat--> aborted, then the next trial;  a result, rest --start--> on at once
any state but done --SAFE_STOP, E_STOP--> stopped --operator's reset--> as after aborted; rest when the trial was over
"""

from __future__ import annotations

from collections.abc import Mapping

import msgspec

from mimics_app.contracts.messages.trial_state import TrialState
from mimics_app.contracts.system.phrases import phrase
from mimics_app.tasks.observation import Observation
from mimics_app.tasks.task import DurationGoal, TaskSpec
from mimics_app.tasks.trials import Trial

__all__ = ["PAUSED", "UNDER_WAY", "Conditions", "Pause", "TrialTimes", "next_state"]


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


_NEVER_IN = (TrialState.STOPPED, TrialState.DONE)
UNDER_WAY = (TrialState.APPROACH, TrialState.READY, TrialState.TRAVEL)
"""States of a trial that can be skipped."""
_SHOWS_RESULT = (TrialState.FINISHED, TrialState.TIMEOUT, TrialState.ABORTED)
PAUSED = phrase("Paused. Press P to resume")
"""Line shown during a pause."""


class Conditions(msgspec.Struct, frozen=True):
    """Inputs of a transition.

    Attributes:
        elapsed_s: Time in the present state [s].
        latched: A safety stop is latched.
        arrived: The robot has stayed at the start for the hold time.
        go: The start was held until now, no force waits there, and the start cue was shown for its time.
        goal: All goals are met, and the person took part.
        too_fast: The goal was reached sooner than the way to it allows.
        start_limit_s: Longest approach, and longest wait for the go [s].
        time_limit_s: Longest travel [s].
        result_s: Time for which a result is shown [s].
        rest_s: Rest between trials [s].
        trial_over: The current trial reached its goal or its time limit, or has no attempts left.
        attempts_left: Another attempt at the current trial is allowed.
        trials_left: Another trial follows.
        given_up: A command ended the trial under way.
        hurried: A command ended the showing of a result, or a rest.
    """

    elapsed_s: float
    latched: bool = False
    arrived: bool = False
    go: bool = False
    goal: bool = False
    too_fast: bool = False
    start_limit_s: float = 20.0
    time_limit_s: float = 60.0
    result_s: float = 2.0
    rest_s: float = 3.0
    trial_over: bool = False
    attempts_left: bool = True
    trials_left: bool = True
    given_up: bool = False
    hurried: bool = False


def next_state(state: TrialState, seen: Conditions) -> TrialState:
    """Return the next state, or the same one. A goal met at the time limit counts as met."""
    if state is TrialState.DONE:
        return state
    if seen.latched:
        return TrialState.STOPPED
    if seen.given_up and state in UNDER_WAY:
        return TrialState.ABORTED
    if state in _SHOWS_RESULT and seen.elapsed_s < seen.result_s and not seen.hurried:
        return state
    return _FLOW[state](seen)


def _leave_approach(seen: Conditions) -> TrialState:
    if seen.arrived:
        return TrialState.READY
    return TrialState.ABORTED if seen.elapsed_s >= seen.start_limit_s else TrialState.APPROACH


def _leave_ready(seen: Conditions) -> TrialState:
    if seen.go:
        return TrialState.TRAVEL
    return TrialState.ABORTED if seen.elapsed_s >= seen.start_limit_s else TrialState.READY


def _leave_travel(seen: Conditions) -> TrialState:
    if seen.too_fast:
        return TrialState.ABORTED
    if seen.goal:
        return TrialState.FINISHED
    return TrialState.TIMEOUT if seen.elapsed_s >= seen.time_limit_s else TrialState.TRAVEL


def _leave_stopped(seen: Conditions) -> TrialState:
    return _follow_trial(seen) if seen.trial_over else _follow_attempt(seen)


def _leave_rest(seen: Conditions) -> TrialState:
    return TrialState.REST if seen.elapsed_s < seen.rest_s and not seen.hurried else TrialState.APPROACH


def _follow_trial(seen: Conditions) -> TrialState:
    return TrialState.REST if seen.trials_left else TrialState.DONE


def _follow_attempt(seen: Conditions) -> TrialState:
    return TrialState.APPROACH if seen.attempts_left else _follow_trial(seen)


_FLOW = {
    TrialState.APPROACH: _leave_approach,
    TrialState.READY: _leave_ready,
    TrialState.TRAVEL: _leave_travel,
    TrialState.FINISHED: _follow_trial,
    TrialState.TIMEOUT: _follow_trial,
    TrialState.ABORTED: _follow_attempt,
    TrialState.STOPPED: _leave_stopped,
    TrialState.REST: _leave_rest,
}


class Pause:
    """State of the pause.

    Attributes:
        on: Whether the task is halted.
    """

    def __init__(self) -> None:
        self.on = False
        self._wanted: bool | None = None

    def want(self, on: bool, state: TrialState) -> str:
        """Ask for a pause, or its end, in this frame; return why that cannot be, "" where it can."""
        if state in _NEVER_IN:
            return "a stop is latched" if state is TrialState.STOPPED else "the session is over"
        if on is self.on:
            return "the task is paused already" if on else "the task is not paused"
        self._wanted = on
        return ""

    def switched(self, seen: Observation, state: TrialState) -> bool:
        """Whether a pause begins or ends with this frame; a safety stop ends one."""
        before, wanted = self.on, self._wanted
        self._wanted = None
        if seen.latched or state in _NEVER_IN:
            self.on = False
        elif wanted is not None:
            self.on = wanted
        return self.on is not before
