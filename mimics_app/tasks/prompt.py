"""The line of text shown to the person: of the state, or of a trigger."""

from __future__ import annotations

from collections.abc import Mapping

from mimics_app.contracts.loop.haptic import TripCause
from mimics_app.contracts.messages.trial_state import TrialState
from mimics_app.contracts.system.phrases import phrase
from mimics_app.tasks.task import StateName

__all__ = [
    "ABORTED_CAUSES",
    "BUILT_IN",
    "REPEATED",
    "SKIPPED",
    "Announcement",
    "aborted_words",
    "built_in_messages",
    "cause_words",
    "state_message",
]

BUILT_IN: Mapping[TrialState, str] = {
    TrialState.APPROACH: phrase("The robot moves to the start. Space stops it"),
    TrialState.READY: phrase("{which}: get ready"),
    TrialState.TRAVEL: phrase("Go!"),
    TrialState.FINISHED: "{result}",
    TrialState.TIMEOUT: "{result}",
    TrialState.ABORTED: "{aborted}",
    TrialState.STOPPED: phrase("Stopped: {cause}. When it is safe, the operator allows force again: R"),
    TrialState.REST: phrase("Rest: {seconds} s. Then the robot moves to the start"),
    TrialState.DONE: phrase("The session is over: {completed}"),
}
"""Text of each state unless the scene has its own; filled in are {result} (what happened, and the points with what cost
the most), {happened} (the first of the two), {score}, {seconds}, {cause}, {trial}, {trials}, {completed} ("3 of 4
trials finished"), {aborted} and {which} (practice, or which trial of how many)."""

_AT_POINTER: Mapping[TrialState, str] = {
    TrialState.APPROACH: phrase("Moving to the start"),
    TrialState.STOPPED: phrase("Stopped: {cause}. Press R to resume"),
    TrialState.REST: phrase("Rest: {seconds} s"),
}
"""Lines that differ without a robot."""

_CAUSES = {int(cause): cause.name.lower().replace("_", " ") for cause in TripCause if cause != TripCause.NONE}

ABORTED_CAUSES: Mapping[TrialState, str] = {
    TrialState.APPROACH: phrase("start not reached"),
    TrialState.READY: phrase("start not held"),
    TrialState.TRAVEL: phrase("goal reached faster than the way allows"),
}
"""Cause in the row of an attempt that was aborted in a state."""

SKIPPED, REPEATED = phrase("skipped"), phrase("repeated")
"""Causes in the row of an attempt that a command ended."""

_ABORTED: Mapping[str, str] = {
    SKIPPED: phrase("This trial is left out"),
    REPEATED: phrase("This trial is played once more"),
    ABORTED_CAUSES[TrialState.APPROACH]: phrase("The start was not reached"),
    ABORTED_CAUSES[TrialState.READY]: phrase("The start was not held, or something pushes there"),
    ABORTED_CAUSES[TrialState.TRAVEL]: phrase("Faster than the way to the goal allows: it does not count"),
}
"""The same for the person."""

_GO_S = 1.5
"""Time for which the travel's message is shown [s]."""


def built_in_messages(*, by_pointer: bool) -> Mapping[StateName, str]:
    """Return the built-in lines of the states."""
    lines = {**BUILT_IN, **(_AT_POINTER if by_pointer else {})}
    return {state.value: text for state, text in lines.items()}


def state_message(
    state: TrialState, texts: Mapping[StateName, str], elapsed_s: float, fields: Mapping[str, str], prompt: str = ""
) -> str:
    """Return the line of a state, `elapsed_s` [s] after its beginning, or the prompt of the next step.

    Only the named fields are replaced; other braces remain.
    """
    text = texts.get(state.value, "")
    if state is TrialState.TRAVEL and elapsed_s >= _GO_S:
        text = prompt
    if "{" in text:
        for name, value in fields.items():
            text = text.replace("{" + name + "}", value)
    return text


def aborted_words(cause: str) -> str:
    """Return the line about an aborted attempt with a cause of `ABORTED_CAUSES`."""
    return _ABORTED.get(cause, _ABORTED[ABORTED_CAUSES[TrialState.APPROACH]])


def cause_words(cause: int) -> str:
    """Return a TripCause in words, e.g. "stop key"."""
    return _CAUSES.get(cause, phrase("safety stop"))


class Announcement:
    """A trigger's message, which replaces the state's line for a time."""

    def __init__(self) -> None:
        self._text = ""
        self._until_ns = 0

    def show(self, text: str, until_ns: int) -> None:
        """Show a line until a time [ns]."""
        self._text, self._until_ns = text, until_ns

    def postpone(self, paused_ns: int) -> None:
        """Extend its time [ns]."""
        self._until_ns += paused_ns

    def line(self, now_ns: int, otherwise: str) -> str:
        """Return the line to be shown now."""
        return self._text if now_ns < self._until_ns else otherwise
