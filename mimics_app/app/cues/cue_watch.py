"""Triggers of sounds and effects: events of the task and of the haptic loop."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.loop.gait_state import GAIT_STATES
from mimics_app.contracts.loop.haptic import EventKind
from mimics_app.contracts.messages.stage_messages import SoundTrigger, TaskOrders
from mimics_app.contracts.messages.trial_state import TrialState
from mimics_app.world.components.effects import Trigger

__all__ = ["TOUCHES", "CueWatch", "gait_triggers", "with_gait_cues"]

_CUES: Mapping[TrialState, Trigger] = {TrialState.TRAVEL: "start", TrialState.FINISHED: "goal"}
"""Trigger at the beginning of a state of a trial."""

TOUCHES: Mapping[int, Trigger] = {
    EventKind.CONTACT_BEGIN: "contact",
    EventKind.CONTACT_END: "contact_end",
    EventKind.IMPACT: "impact",
}
"""Trigger of an event of the haptic loop."""


def gait_triggers(events: NDArray[np.void]) -> tuple[SoundTrigger, ...]:
    """Return a trigger for each new state of a walk in a gait orthosis among EVENT records [n], by its name."""
    begun = events[events["kind"] == EventKind.GAIT_STATE] if len(events) else ()
    return tuple(SoundTrigger(GAIT_STATES[int(event["force"])], int(event["t_ns"])) for event in begun)


def with_gait_cues(orders: TaskOrders, events: NDArray[np.void]) -> TaskOrders:
    """Return the orders of a task with the triggers of `gait_triggers` among those of its sounds."""
    return replace(orders, audio=replace(orders.audio, cues=(*orders.audio.cues, *gait_triggers(events))))


class CueWatch:
    """Detects changes of a trial's state."""

    def __init__(self) -> None:
        self._state: TrialState | None = None

    def poll(self, orders: TaskOrders) -> Trigger | None:
        """Return the trigger that begins in this frame, or None; call once per frame."""
        state = orders.view.state
        begins, self._state = state is not self._state, state
        return _CUES.get(state) if begins else None
