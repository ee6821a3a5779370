"""Pause of the task, switched by keys."""

from __future__ import annotations

from mimics_app.contracts.trial_state import TrialState
from mimics_app.tasks.observation import Observation

__all__ = ["PAUSED", "Pause"]

_KEYS = frozenset({"p", "pad_start"})
_NEVER_IN = (TrialState.STOPPED, TrialState.DONE)

PAUSED = "Paused. P goes on"
"""Line shown during a pause."""


class Pause:
    """State of the pause.

    Attributes:
        on: Whether the task is halted.
    """

    def __init__(self) -> None:
        self.on = False

    def switched(self, seen: Observation, state: TrialState) -> bool:
        """Whether a pause begins or ends with this frame; a safety stop ends one."""
        before = self.on
        if seen.latched or state in _NEVER_IN:
            self.on = False
        elif _KEYS & set(seen.pressed):
            self.on = not self.on
        return self.on is not before
