"""Events of the task and the haptic loop that trigger a sound or an effect of the scene."""

from __future__ import annotations

from collections.abc import Mapping

from mimics_app.contracts.haptic import EventKind
from mimics_app.contracts.messages import TaskOrders
from mimics_app.contracts.trial_state import TrialState
from mimics_app.world.components.effects import Trigger

__all__ = ["TOUCHES", "CueWatch"]

_CUES: Mapping[TrialState, Trigger] = {TrialState.TRAVEL: "start", TrialState.FINISHED: "goal"}
"""State of a trial whose beginning is a trigger."""

TOUCHES: Mapping[int, Trigger] = {
    EventKind.CONTACT_BEGIN: "contact",
    EventKind.CONTACT_END: "contact_end",
    EventKind.IMPACT: "impact",
}
"""Events of the haptic loop that are one."""


class CueWatch:
    """Sees a trial change its state."""

    def __init__(self) -> None:
        self._state: TrialState | None = None

    def look(self, orders: TaskOrders) -> Trigger | None:
        """Return the trigger that begins in this frame, or None; call once per frame."""
        state = orders.view.state
        begins, self._state = state is not self._state, state
        return _CUES.get(state) if begins else None
