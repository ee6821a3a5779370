"""Step-by-step learning inside a trial: tabular Q(lambda) or SARSA(lambda) over a few states, within one session."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.messages.action_space import Parameter
from mimics_app.contracts.messages.stage_messages import TaskAction, TrialResult, UserState
from mimics_app.learning.goals import STATES as STATES_OF_PEOPLE

__all__ = ["GAPS", "SECTORS", "STATES", "STEP_POLICIES", "StepAgent", "StepMethod", "StepValues", "place_of"]

GAPS = (0.5, 0.9, 1.4)
"""Borders of the bins of the distance between guide and person [m], within Hall's zones."""
SECTORS = 6
"""Number of sectors of the guide's bearing; the first has the direction of the place in its middle."""
STATES = SECTORS * (len(GAPS) + 1)
"""Number of states: sectors of the bearing, each with the bins of the distance."""

StepMethod = Literal["q", "sarsa", "random", "fixed"]
_FOLLOWED = ("task", *STATES_OF_PEOPLE)
STEP_POLICIES: dict[StepMethod, tuple[str, ...]] = {
    "q": _FOLLOWED,
    "sarsa": _FOLLOWED,
    "random": ("task",),
    "fixed": ("task",),
}
"""Policies that choose step by step, with the goals of each: a share of success is none of steps."""

_FIRST_VALUE = 0.2
"""Value of every action before it was tried: above what a step earns, so that each is tried."""
_RATE, _DISCOUNT, _TRACE = 0.3, 0.8, 0.6
"""Learning rate, discount factor per step, and lambda."""
_EXPLORES, _FADES, _LEAST = 0.2, 0.3, 0.05
"""Probability of a random action in a new state, its decay per visit, and its lower limit."""


def place_of(observed: Mapping[str, float]) -> int:
    """Return the state of a step: `gap` from person to guide [m], `bearing` of the guide from the place [rad]."""
    sector = round(observed.get("bearing", 0.0) * SECTORS / (2.0 * math.pi)) % SECTORS
    return sector * (len(GAPS) + 1) + int(np.searchsorted(GAPS, observed.get("gap", 0.0)))


class StepValues:
    """Action values by state with an exploration rate that decays per state; equal values are drawn among.

    Args:
        deeds: Number of actions.
        rng: Source of the exploration.
        method: "q": Q(lambda); "sarsa": SARSA(lambda) with the expected following value; "random": all actions with
            equal probability; "fixed": always `default`. The last two learn nothing.
        default: Action of "fixed".
    """

    def __init__(self, deeds: int, rng: np.random.Generator, method: StepMethod = "q", default: int = 0) -> None:
        self._rng, self._deeds, self._method, self._default = rng, deeds, method, default
        self.values: NDArray[np.float64] = np.full((STATES, deeds), _FIRST_VALUE)
        self._traces = np.zeros_like(self.values)
        self._tried = np.zeros(STATES)

    def choose(self, state: int) -> tuple[int, float]:
        """Return an action and its propensity."""
        chances = self._chances(state)
        deed = min(int(np.searchsorted(chances.cumsum(), self._rng.random(), "right")), self._deeds - 1)
        return deed, float(chances[deed])

    def learn(self, state: int, deed: int, reward: float, following: int) -> None:
        """Update the values with the reward of an action in a state and the state that followed."""
        if self._method not in ("q", "sarsa"):
            return
        self._tried[state] += 1.0
        values = self.values[following]
        ahead = float(values.max() if self._method == "q" else self._chances(following) @ values)
        error = reward + _DISCOUNT * ahead - self.values[state, deed]
        self._traces *= _DISCOUNT * _TRACE
        self._traces[state, deed] = 1.0
        self.values += _RATE * error * self._traces

    def end(self) -> None:
        """End a sequence: what follows is no consequence of its actions."""
        self._traces[:] = 0.0

    def _chances(self, state: int) -> NDArray[np.float64]:
        if self._method == "fixed":
            return np.eye(self._deeds)[self._default]
        if self._method == "random":
            return np.full(self._deeds, 1.0 / self._deeds)
        explore = max(_LEAST, _EXPLORES / (1.0 + _FADES * self._tried[state]))
        best = self.values[state] == self.values[state].max()
        chances: NDArray[np.float64] = explore / self._deeds + (1.0 - explore) * best / best.sum()
        return chances


class StepAgent:
    """Learning stage that chooses a value of one stepped parameter after every step of a task.

    A reward that comes between two steps is kept until the next one, the mean of several.

    Args:
        policy: One of `STEP_POLICIES`.
        parameter: The parameter; its values are the actions.
        seed: Seed of the session.
        lost: What is taken off each reward, so that no action earns more than one that was not tried.
    """

    def __init__(self, policy: StepMethod, parameter: Parameter, seed: int, lost: float = 0.0) -> None:
        self._parameter, self._lost = parameter, lost
        deeds = round((parameter.high - parameter.low) / parameter.step) + 1
        default = round((parameter.default - parameter.low) / parameter.step)
        self.table = StepValues(deeds, np.random.default_rng([seed, 343]), policy, default)
        self._last: tuple[int, int] | None = None
        self._rewards: list[float] = []

    def choose(
        self, state: UserState, result: TrialResult | None, reward: float | None, now_ns: int
    ) -> TaskAction | None:
        """Return the next action after each step; the end of a trial ends the sequence, the values remain."""
        if reward is not None:
            self._rewards.append(reward - self._lost)
        if result is None:
            return None
        if result.outcome != "step":
            self._last = None
            self.table.end()
            return None
        here = place_of(result.observed)
        if self._last is not None and self._rewards:
            self.table.learn(*self._last, sum(self._rewards) / len(self._rewards), here)
        self._rewards.clear()
        deed, probability = self.table.choose(here)
        self._last = (here, deed)
        return TaskAction({self._parameter.name: self._parameter.low + deed * self._parameter.step}, None, probability)
