"""Tabular reinforcement learning over changes of the demand: Q, SARSA(lambda), actor-critic with softmax policy."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.learning.policy import REWARDS, TARGET, Choice, Outcome, Policy

__all__ = ["POLICIES", "ActorCritic", "SarsaLambda", "TabularQ"]

MOVES = np.array([-0.2, -0.07, 0.0, 0.07, 0.2])
"""Actions: changes of the demand."""
_BINS = np.array([0.2, 0.45, 0.62, 0.78, 0.92])
"""Borders of the bins of success."""
_THIRDS = np.array([1.0, 2.0]) / 3.0
"""Borders of the bins of the demand."""
_EVALUATED = (len(_BINS) + 1) * 3
"""Number of states after a trial: bins of success times three of load."""
STATES = _EVALUATED + len(_THIRDS) + 1
"""Number of states: those after a trial, and the bins of the demand where a reward came without a trial."""
_BEST = 2.0
"""Rewards of 1 for ever, discounted by half: first value where no success is known, so that each action is tried."""


class _Table:
    """Base class: table of action values, present demand, last state and action.

    Args:
        rate: Learning rate.
        discount: Discount factor.
    """

    follows = REWARDS
    explores = True

    def __init__(self, rate: float = 0.4, discount: float = 0.5) -> None:
        self._rate, self._discount = rate, discount

    def begin(self, start: F8, rng: np.random.Generator) -> None:
        """Begin a session of people at these demands [n]."""
        n = len(start)
        self._rng = rng
        self._demand = np.array(start, float)
        self._table = np.tile(_first_values(), (n, 1, 1))
        self._rows = np.arange(n)
        self._state = np.full(n, 3 * 3 + 1)
        self._move = np.full(n, 2)
        self._trials = 0

    def act(self) -> Choice:
        """Return the demands of the next trial."""
        chances = self._chances(self._state)
        drawn = self._rng.random(len(self._rows))
        self._move = np.minimum((chances.cumsum(axis=1) < drawn[:, None]).sum(axis=1), len(MOVES) - 1)
        self._demand = np.clip(self._demand + MOVES[self._move], 0.0, 1.0)
        return Choice(self._demand.copy(), chances[self._rows, self._move])

    def _chances(self, state: np.ndarray) -> F8:
        """Return the probability of each action [n, actions]: epsilon-greedy, epsilon decaying, ties at random."""
        explore = max(0.05, 0.3 * (1.0 - self._trials / 15.0))
        values = self._table[self._rows, state]
        chances = np.full(values.shape, explore / len(MOVES))
        best = values == values.max(axis=1, keepdims=True)
        return chances + (1.0 - explore) * best / best.sum(axis=1, keepdims=True)

    def _see(self, outcome: Outcome) -> np.ndarray:
        """Return the state after a trial [n], and set the demand to the actual one."""
        self._trials += 1
        self._demand = np.where(np.isfinite(outcome.demand), outcome.demand, self._demand)
        success = np.searchsorted(_BINS, np.nan_to_num(outcome.performance, nan=TARGET))
        load = np.searchsorted([-0.4, 0.4], np.nan_to_num(outcome.load))
        place = _EVALUATED + np.searchsorted(_THIRDS, self._demand)
        return np.where(np.isfinite(outcome.performance), success * 3 + load, place)


def _first_values() -> F8:
    """Return the initial values [states, actions].

    After a trial they are lower the farther an action is from the proportional rule. A reward without a trial tells
    nothing of the way to go: there all actions have the largest value.
    """
    middle = np.array([0.1, 0.33, 0.53, 0.7, 0.85, 0.96])
    wanted = 0.5 * (middle - TARGET)
    evaluated = np.repeat(-2.0 * np.abs(MOVES[None, :] - wanted[:, None]), 3, axis=0)
    values: F8 = np.concatenate([evaluated, np.full((len(_THIRDS) + 1, len(MOVES)), _BEST)])
    return values


class TabularQ(_Table):
    """Q-learning (Watkins 1989)."""

    def learn(self, outcome: Outcome) -> None:
        """Learn from a trial."""
        following = self._see(outcome)
        best = self._table[self._rows, following].max(axis=1)
        aim = outcome.reward + self._discount * best
        old = self._table[self._rows, self._state, self._move]
        self._table[self._rows, self._state, self._move] = old + self._rate * np.nan_to_num(aim - old)
        self._state = following


class SarsaLambda(_Table):
    """SARSA with eligibility traces (Rummery & Niranjan 1994).

    Args:
        trace: Lambda.
    """

    def __init__(self, trace: float = 0.6) -> None:
        super().__init__()
        self._trace = trace

    def begin(self, start: F8, rng: np.random.Generator) -> None:
        """Begin a session of people at these demands [n]."""
        super().begin(start, rng)
        self._traces = np.zeros_like(self._table)

    def learn(self, outcome: Outcome) -> None:
        """Learn from a trial."""
        following = self._see(outcome)
        expected = (self._chances(following) * self._table[self._rows, following]).sum(axis=1)
        aim = outcome.reward + self._discount * expected
        error = np.nan_to_num(aim - self._table[self._rows, self._state, self._move])
        self._traces *= self._discount * self._trace
        self._traces[self._rows, self._state, self._move] = 1.0
        self._table += self._rate * error[:, None, None] * self._traces
        self._state = following


class ActorCritic(_Table):
    """Actor-critic with tables of action preferences and state values (Sutton & Barto, 13.5)."""

    def begin(self, start: F8, rng: np.random.Generator) -> None:
        """Begin a session of people at these demands [n]."""
        super().begin(start, rng)
        self._table *= 10.0  # preferences: a difference of 0.25 in value is a factor of twelve in probability
        self._values = np.zeros((len(start), STATES))
        self._values[:, _EVALUATED:] = _BEST

    def _chances(self, state: np.ndarray) -> F8:
        preferences = self._table[self._rows, state]
        weights = np.exp(preferences - preferences.max(axis=1, keepdims=True))
        shares: F8 = weights / weights.sum(axis=1, keepdims=True)
        return shares

    def learn(self, outcome: Outcome) -> None:
        """Learn from a trial."""
        before, moved = self._state, self._move
        chances = self._chances(before)
        following = self._see(outcome)
        worth = outcome.reward + self._discount * self._values[self._rows, following]
        error = np.nan_to_num(worth - self._values[self._rows, before])
        self._values[self._rows, before] += self._rate * error
        slope = -chances
        slope[self._rows, moved] += 1.0
        self._table[self._rows, before] += 1.5 * error[:, None] * slope
        self._state = following


POLICIES: dict[str, Callable[[], Policy]] = {"q": TabularQ, "sarsa": SarsaLambda, "actor_critic": ActorCritic}
"""Builders of these policies by name."""
