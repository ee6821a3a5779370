"""Triggers of a task: conditions, and the actions carried out when they occur."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from mimics_app.contracts.messages.trial_state import TrialState
from mimics_app.tasks.kinds.kind import KindPlay
from mimics_app.tasks.observation import Observation
from mimics_app.tasks.task import (
    ContactCondition,
    Deed,
    EnterCondition,
    ExitCondition,
    KeyCondition,
    ProgressCondition,
    TriggerSpec,
)
from mimics_app.world.components.registry import Component

__all__ = ["Moment", "Triggers"]


@dataclass(frozen=True, slots=True)
class Moment:
    """Inputs of the triggers in one frame.

    Attributes:
        state: TrialState of the trial after this frame.
        entered: The state that began in this frame, or None.
        left: The state that ended in this frame, or None.
        pressed: Keys and buttons that went down.
        seen: The observation.
    """

    state: TrialState
    entered: TrialState | None
    left: TrialState | None
    pressed: tuple[str, ...]
    seen: Observation


class Triggers:
    """The triggers of a task; those on progress fire once in an attempt.

    Args:
        specs: The triggers.
        plays: Kind of task of each condition; None for the task's own.
    """

    def __init__(self, specs: Sequence[TriggerSpec], plays: Sequence[KindPlay | None]) -> None:
        self._specs = tuple(specs)
        self._plays = tuple(plays)
        self._passed: set[int] = set()

    def restart(self) -> None:
        """Reset at the beginning of an attempt: progress may be crossed again."""
        self._passed.clear()

    def due(self, moment: Moment) -> list[Deed]:
        """Return the actions of this frame in the order of the scene file. Call once per frame."""
        return [deed for i, spec in enumerate(self._specs) if self._fires(i, spec.when, moment) for deed in spec.do]

    def _fires(self, i: int, when: Component, moment: Moment) -> bool:
        if isinstance(when, EnterCondition):
            return moment.entered == when.state
        if isinstance(when, ExitCondition):
            return moment.left == when.state
        if isinstance(when, KeyCondition):
            return when.key in moment.pressed
        if TrialState.TRAVEL not in (moment.state, moment.left):
            return False
        if isinstance(when, ContactCondition):
            return any(contact.begins and contact.force >= when.min_force for contact in moment.seen.contacts)
        if isinstance(when, ProgressCondition):
            return self._crosses(i, when, moment)
        play = self._plays[i]
        return play is not None and play.happens(when, moment.seen)

    def _crosses(self, i: int, when: ProgressCondition, moment: Moment) -> bool:
        if i in self._passed or moment.seen.progress < when.at_least:
            return False
        self._passed.add(i)
        return True
