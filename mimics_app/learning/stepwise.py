"""Step-by-step learning inside a trial: tabular Q(lambda) over a few states, within one session."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.action_space import Parameter
from mimics_app.contracts.messages import TaskAction, TrialResult, UserState

__all__ = ["GAPS", "StepAgent", "StepValues", "place_of"]

GAPS = (0.5, 0.9, 1.4, 2.2)
"""Borders of the bins of the distance between guide and person [m], within Hall's zones."""

STATES = 2 * (len(GAPS) + 1)
"""Number of states: bins of distance, with the guide behind the person as seen from the goal, or between the two."""

_FIRST_VALUE = 0.1
"""Value of every action before it was tried [m gained]: above 0, so that each is tried."""
_RATE, _DISCOUNT, _TRACE = 0.15, 0.8, 0.6
"""Learning rate, discount factor per step, and lambda."""
_EXPLORES, _FADES, _LEAST = 0.5, 0.15, 0.05
"""Probability of a random action in a new state, its decay per visit, and its lower limit."""


def place_of(observed: Mapping[str, float]) -> int:
    """Return the state of a step: `gap` from person to guide and `left` from person to goal, both signed [m]."""
    between = observed.get("gap", 0.0) * observed.get("left", 1.0) > 0.0
    return int(np.searchsorted(GAPS, abs(observed.get("gap", 0.0)))) + (len(GAPS) + 1) * between


class StepValues:
    """Action values by state, learnt by Q(lambda) with an exploration rate that decays per state.

    Args:
        deeds: Number of actions.
        rng: Source of the exploration.
        learns: False: all actions with equal probability.
    """

    def __init__(self, deeds: int, rng: np.random.Generator, *, learns: bool = True) -> None:
        self._rng, self._deeds, self._learns = rng, deeds, learns
        self.values: NDArray[np.float64] = np.full((STATES, deeds), _FIRST_VALUE)
        self._traces = np.zeros_like(self.values)
        self._tried = np.zeros(STATES)

    def choose(self, state: int) -> tuple[int, float]:
        """Return an action and its propensity."""
        explore = 1.0 if not self._learns else max(_LEAST, _EXPLORES / (1.0 + _FADES * self._tried[state]))
        best = int(self.values[state].argmax())
        chances = np.full(self._deeds, explore / self._deeds)
        chances[best] += 1.0 - explore
        deed = int(self._rng.choice(self._deeds, p=chances))
        return deed, float(chances[deed])

    def learn(self, state: int, deed: int, reward: float, following: int) -> None:
        """Update the values with the reward of an action in a state and the state that followed."""
        self._tried[state] += 1.0
        aim = reward + _DISCOUNT * float(self.values[following].max())
        error = aim - self.values[state, deed]
        self._traces *= _DISCOUNT * _TRACE
        self._traces[state, deed] = 1.0
        self.values += _RATE * error * self._traces

    def end(self) -> None:
        """End a sequence: what follows is no consequence of its actions."""
        self._traces[:] = 0.0


class StepAgent:
    """Learning stage that chooses a value of one stepped parameter after every step of a task.

    Args:
        policy: "random", or any other name for learning.
        parameter: The parameter; its values are the actions.
        seed: Seed of the session.
    """

    def __init__(self, policy: str, parameter: Parameter, seed: int) -> None:
        self._parameter = parameter
        deeds = round((parameter.high - parameter.low) / parameter.step) + 1
        self.table = StepValues(deeds, np.random.default_rng([seed, 343]), learns=policy != "random")
        self._last: tuple[int, int] | None = None

    def choose(
        self, state: UserState, result: TrialResult | None, reward: float | None, now_ns: int
    ) -> TaskAction | None:
        """Return the next action after each step; the end of a trial ends the sequence, the values remain."""
        if result is None:
            return None
        if result.outcome != "step":
            self._last = None
            self.table.end()
            return None
        here = place_of(result.observed)
        if self._last is not None and reward is not None:
            self.table.learn(*self._last, reward, here)
        deed, chance = self.table.choose(here)
        self._last = (here, deed)
        return TaskAction({self._parameter.name: self._parameter.low + deed * self._parameter.step}, None, chance)
