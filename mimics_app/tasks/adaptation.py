"""Present values of the adaptable parameters, and their changes: between trials, or at a rate inside a trial."""

from __future__ import annotations

from collections.abc import Mapping

from mimics_app.contracts.messages.action_space import ActionSpace
from mimics_app.contracts.messages.stage_messages import TaskAction

__all__ = ["Adaptation"]


class Adaptation:
    """Present values, target values, and actions that wait for their trial.

    Values of the trial list hold for their trial only: the next one begins with the session's values again, the
    defaults as changed by actions. So a condition means the same wherever it is drawn.

    A parameter with a `rate` moves to its target by at most rate * dt; one without changes between trials.

    Attributes:
        values: Present values by name.
        clipped: Names clipped by the last `take`, for the log.
    """

    def __init__(self, space: ActionSpace) -> None:
        self._space = space
        self.values = space.defaults()
        self._session = dict(self.values)
        self._aims = dict(self.values)
        self._waiting: dict[int, dict[str, float]] = {}
        self.clipped: tuple[str, ...] = ()

    def take(self, action: TaskAction) -> None:
        """Set the targets to an action's values, or keep these for its trial."""
        allowed, self.clipped = self._space.clip(action)
        if allowed.at_trial is None:
            self._session.update(allowed.values)
            self._aims.update(allowed.values)
        else:
            self._waiting.setdefault(allowed.at_trial, {}).update(allowed.values)

    def override(self, values: Mapping[str, float]) -> None:
        """Set the targets to the values of a command; earlier choices of the same parameters that wait are dropped."""
        self.take(TaskAction(values))
        for waiting in self._waiting.values():
            for name in values:
                waiting.pop(name, None)

    def begin_trial(self, number: int, values: Mapping[str, float]) -> None:
        """Set all values for a trial: the session's, the trial list's, those of the actions that waited for it.

        Args:
            number: Number of the trial, 0 first. Actions for earlier trials that never began are applied too.
            values: Values of the trial list.
        """
        allowed, self.clipped = self._space.clip(TaskAction(values))
        self._aims = {**self._session, **allowed.values}
        for due in sorted(trial for trial in self._waiting if trial <= number):
            self._session.update(self._waiting[due])
            self._aims.update(self._waiting.pop(due))
        self.values = dict(self._aims)

    def upcoming(self, number: int) -> dict[str, float]:
        """Return the session's values at the beginning of a trial, without those of the trial list."""
        values = dict(self._session)
        for due in sorted(trial for trial in self._waiting if trial <= number):
            values.update(self._waiting[due])
        return values

    def step(self, seconds: float) -> None:
        """Move the values that may change inside a trial towards their targets for a time [s]."""
        for parameter in self._space:
            aim, value = self._aims[parameter.name], self.values[parameter.name]
            reach = parameter.rate * seconds
            if reach > 0.0 and aim != value:
                self.values[parameter.name] = aim if abs(aim - value) <= reach else value + reach * _sign(aim - value)


def _sign(x: float) -> float:
    return 1.0 if x > 0.0 else -1.0
