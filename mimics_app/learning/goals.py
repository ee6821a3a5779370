"""Goals of a learning system, each a reward function: a share of success, a state in a band, the task's own."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.messages import TrialResult, UserState
from mimics_app.contracts.stages import Goal
from mimics_app.learning.policy import TARGET

__all__ = ["StateBand", "SuccessShare", "TaskGoal", "build_goal", "success_reward"]

Quantity = Literal["arousal", "valence", "effort"]

_EVERY_NS = 30_000_000_000
"""Period of the rewards of a state: body signals are slow [ns]."""


def success_reward(success: float | F8, share: float = TARGET) -> F8:
    """Return 1 at the wanted share of success, falling linearly to 0 at the nearer end of the scale, at least -1."""
    return np.asarray(np.maximum(1.0 - np.abs(success - share) / min(share, 1.0 - share), -1.0))


class TaskGoal:
    """The task's own reward."""

    def reward(self, state: UserState, result: TrialResult | None) -> float | None:
        """Return the reward of a trial that ended; None after practice."""
        return None if result is None or result.practice else result.reward


class SuccessShare:
    """A challenge: success in a given share of the trials, neither more nor less.

    Args:
        share: Share of success, 0 to 1.
    """

    def __init__(self, share: float = TARGET) -> None:
        self._share = share

    def reward(self, state: UserState, result: TrialResult | None) -> float | None:
        """Return `success_reward` of a trial; None after practice or a step, which do not count."""
        if result is None or result.practice or result.outcome == "step":
            return None
        return float(success_reward(result.performance, self._share))


class StateBand:
    """A state of the person kept in a band, independent of the task.

    Args:
        quantity: Which estimate of the state.
        low, high: Limits of the band, in [-1, 1].
    """

    def __init__(self, quantity: Quantity, low: float, high: float) -> None:
        self._quantity, self._low, self._high = quantity, low, high
        self._next_ns: int | None = None

    def reward(self, state: UserState, result: TrialResult | None) -> float | None:
        """Return 1 inside the band, less by the distance outside it; every half minute while the state is known."""
        estimate = getattr(state, self._quantity)
        if self._next_ns is None:
            self._next_ns = state.t_ns + _EVERY_NS
        if estimate is None or state.t_ns < self._next_ns:
            return None
        self._next_ns = state.t_ns + _EVERY_NS
        away = max(self._low - estimate.mean, estimate.mean - self._high, 0.0)
        return max(1.0 - away, -1.0)


def build_goal(words: str) -> Goal:
    """Build a goal from its text: "task", "success:0.7", "arousal:-0.2:0.3".

    Raises:
        ValueError: There is no such goal, or its numbers are out of range.
    """
    name, *numbers = words.split(":")
    try:
        values = [float(number) for number in numbers]
    except ValueError:
        values = [math.nan]
    if name == "task" and not values:
        return TaskGoal()
    if name == "success" and len(values) <= 1 and all(0.0 < value < 1.0 for value in values):
        return SuccessShare(*values)
    if name in ("arousal", "valence", "effort") and len(values) == 2 and -1.0 <= values[0] < values[1] <= 1.0:
        return StateBand(name, *values)  # type: ignore[arg-type]
    raise ValueError(f'"{words}" is no goal: task, success:SHARE, or arousal, valence or effort with :LOW:HIGH')
