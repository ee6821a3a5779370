"""Action space of a task: its adaptable parameters with limits and units, chosen by learning, enforced by the task."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

from mimics_app.contracts.messages.stage_messages import TaskAction

__all__ = ["ActionSpace", "Parameter"]


@dataclass(frozen=True, slots=True)
class Parameter:
    """One adaptable parameter.

    Attributes:
        name: Name in actions.
        default: Value at the start of the session.
        low: Smallest value.
        high: Largest value, >= low.
        step: Spacing of the allowed values from `low` on; 0: any value.
        rate: Largest change per second inside a trial; 0: changes only between trials.
        unit: Unit of all the values above; "-" for none.
        kind: A `tasks.task.ActionKind`: what the parameter changes.
        harder: 1: larger values make the task harder, -1: smaller ones do, 0: neither.
        cost: What a value as far from the default as the range is wide costs a learning system with each reward, in
            units of the reward; in proportion nearer to the default.
        dwell_s: Shortest time between two changes by a learning system [s].
    """

    name: str
    default: float
    low: float
    high: float
    step: float = 0.0
    rate: float = 0.0
    unit: str = "-"
    kind: str = "difficulty"
    harder: int = 0
    cost: float = 0.0
    dwell_s: float = 0.0

    def demand(self, value: float) -> float | None:
        """Return the difficulty at a value, 0 to 1; None for a parameter that does not affect it."""
        if self.harder == 0 or self.high <= self.low:
            return None
        share = (value - self.low) / (self.high - self.low)
        return share if self.harder > 0 else 1.0 - share

    def at_demand(self, demand: float) -> float:
        """Return the value for a difficulty of 0 to 1; the default for a parameter that does not affect it."""
        if self.harder == 0:
            return self.default
        share = min(max(demand, 0.0), 1.0)
        return self.clip(self.low + (self.high - self.low) * (share if self.harder > 0 else 1.0 - share))

    def clip(self, value: float) -> float:
        """Return the allowed value nearest to `value`, which is not NaN."""
        if self.step > 0.0:
            value = self.low + round((min(max(value, self.low), self.high) - self.low) / self.step) * self.step
        return min(max(value, self.low), self.high)

    def fits(self, value: float) -> bool:
        """Whether a value is inside the limits; False for NaN."""
        return self.low <= value <= self.high


class ActionSpace:
    """Parameters by name, in the order of the scene file."""

    def __init__(self, parameters: Iterable[Parameter] = ()) -> None:
        self._parameters = {parameter.name: parameter for parameter in parameters}

    def __iter__(self) -> Iterator[Parameter]:
        return iter(self._parameters.values())

    def __len__(self) -> int:
        return len(self._parameters)

    def __contains__(self, name: object) -> bool:
        return name in self._parameters

    def __getitem__(self, name: str) -> Parameter:
        return self._parameters[name]

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the parameters."""
        return tuple(self._parameters)

    def defaults(self) -> dict[str, float]:
        """The values a session starts with."""
        return {parameter.name: parameter.default for parameter in self}

    def demand(self, values: Mapping[str, float]) -> float | None:
        """Return the mean difficulty at these values, 0 to 1, over the parameters that affect it; None for none."""
        shares = [share for p in self if p.name in values and (share := p.demand(values[p.name])) is not None]
        return sum(shares) / len(shares) if shares else None

    def clip(self, action: TaskAction) -> tuple[TaskAction, tuple[str, ...]]:
        """Clip an action to the limits and round it to the steps.

        Returns:
            The valid action, and the names whose value was outside the limits, not a number, or unknown (the last two
            are left out of the action, so that the parameter is unchanged). Rounding to a step is not reported.
        """
        values: dict[str, float] = {}
        clipped: list[str] = []
        for name, value in action.values.items():
            if name not in self or math.isnan(value):
                clipped.append(name)
                continue
            parameter = self._parameters[name]
            values[name] = parameter.clip(value)
            if not parameter.fits(value):
                clipped.append(name)
        return TaskAction(values, action.at_trial, action.propensity), tuple(clipped)
