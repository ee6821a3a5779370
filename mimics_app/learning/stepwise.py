"""Learning what to do next, step by step inside a trial: tabular values over a few places, within one session."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.action_space import Parameter
from mimics_app.contracts.messages import TaskAction, TrialResult, UserState

__all__ = ["GAPS", "StepAgent", "StepValues", "place_of"]

GAPS = (0.5, 0.9, 1.4, 2.2)
"""Borders of the bins of the distance between guide and person [m]: within Hall's zones, where most happens."""

STATES = 2 * (len(GAPS) + 1)
"""Bins of distance, with the guide behind the person as seen from the place, or between the two."""


def place_of(observed: Mapping[str, float]) -> int:
    """The state of a step: `gap` from person to guide and `way` from person to place, both signed [m]."""
    between = observed.get("gap", 0.0) * observed.get("way", 1.0) > 0.0
    return int(np.searchsorted(GAPS, abs(observed.get("gap", 0.0)))) + (len(GAPS) + 1) * between


class StepValues:
    """Values of deeds by state, learnt by Q(lambda) with a chance of trying another deed that wears off.

    Args:
        deeds: How many there are.
        rng: For what is tried.
        learns: False: any deed, each as likely as the others.
    """

    def __init__(self, deeds: int, rng: np.random.Generator, *, learns: bool = True) -> None:
        self._rng, self._deeds, self._learns = rng, deeds, learns
        self.values: NDArray[np.float64] = np.full((STATES, deeds), 0.1)
        self._traces = np.zeros_like(self.values)
        self._tried = np.zeros(STATES)

    def choose(self, state: int) -> tuple[int, float]:
        """A deed and its propensity."""
        explore = 1.0 if not self._learns else max(0.05, 0.5 / (1.0 + 0.15 * self._tried[state]))
        best = int(self.values[state].argmax())
        chances = np.full(self._deeds, explore / self._deeds)
        chances[best] += 1.0 - explore
        deed = int(self._rng.choice(self._deeds, p=chances))
        return deed, float(chances[deed])

    def learn(self, state: int, deed: int, reward: float, following: int) -> None:
        """A deed in a state was worth a reward and led on."""
        self._tried[state] += 1.0
        aim = reward + 0.8 * float(self.values[following].max())
        error = aim - self.values[state, deed]
        self._traces *= 0.8 * 0.6
        self._traces[state, deed] = 1.0
        self.values += 0.15 * error * self._traces


class StepAgent:
    """Chooses among the values of one stepped parameter after every step a task reports.

    Args:
        policy: "random", or any other name for learning.
        parameter: What is chosen; its values are the deeds.
        seed: Of the session.
    """

    def __init__(self, policy: str, parameter: Parameter, seed: int) -> None:
        self._parameter = parameter
        deeds = round((parameter.high - parameter.low) / parameter.step) + 1
        self.table = StepValues(deeds, np.random.default_rng([seed, 343]), learns=policy != "random")
        self._last: tuple[int, int] | None = None

    def choose(
        self, state: UserState, result: TrialResult | None, reward: float | None, now_ns: int
    ) -> TaskAction | None:
        """After each step the next deed; a trial that ended is forgotten, what it taught is not."""
        if result is None:
            return None
        if result.outcome != "step":
            self._last = None
            return None
        here = place_of(result.observed)
        if self._last is not None and reward is not None:
            self.table.learn(*self._last, reward, here)
        deed, chance = self.table.choose(here)
        self._last = (here, deed)
        return TaskAction({self._parameter.name: self._parameter.low + deed * self._parameter.step}, None, chance)
