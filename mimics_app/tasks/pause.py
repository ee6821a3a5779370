"""Whether the task is halted because somebody requested it, and until when."""

from __future__ import annotations

from mimics_app.contracts.trial_state import TrialState
from mimics_app.tasks.observation import Observation

__all__ = ["PAUSED", "Pause"]

_KEYS = frozenset({"p", "pad_start"})
_NEVER_IN = (TrialState.STOPPED, TrialState.DONE)

PAUSED = "Paused. P goes on"
"""What the person reads meanwhile."""


class Pause:
    """Watches the keys.

    Attributes:
        on: Whether the task is halted now.
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
