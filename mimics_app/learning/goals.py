"""Goals of a learning system, each a reward function: a share of success, a state in a band, the task's own."""

from __future__ import annotations

import math
from collections.abc import Collection
from typing import Literal, get_args

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.messages.stage_messages import TrialResult, UserState
from mimics_app.contracts.ports.stages import Goal
from mimics_app.learning.policy import TARGET

__all__ = ["STATES", "StateBand", "SuccessShare", "TaskGoal", "build_goal", "is_among", "success_reward"]

Quantity = Literal["arousal", "valence", "effort"]
STATES: tuple[str, ...] = get_args(Quantity)
"""Names of the goals that are a band of a state."""

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
        """Return 1 inside the band, less by the distance outside it; while the state is known.

        It comes with every step inside a trial, where the task has steps, and every half minute otherwise.
        """
        estimate = getattr(state, self._quantity)
        if self._next_ns is None:
            self._next_ns = state.t_ns + _EVERY_NS
        step = result is not None and result.outcome == "step"
        if estimate is None or (state.t_ns < self._next_ns and not step):
            return None
        self._next_ns = state.t_ns + _EVERY_NS
        away = max(self._low - estimate.mean, estimate.mean - self._high, 0.0)
        return max(1.0 - away, -1.0)


def build_goal(words: str) -> Goal:
    """Build a goal from its text: "task", "success:0.7", "arousal:-0.2:0.3".

    Raises:
        ValueError: The goal is unknown, or its numbers are out of range.
    """
    name, numbers = _read(words)
    if name == "task":
        return TaskGoal()
    if name == "success":
        return SuccessShare(*numbers)
    return StateBand(name, *numbers)  # type: ignore[arg-type]


def is_among(words: str, goals: Collection[str]) -> bool:
    """Return whether a goal is one of `goals`: names ("success"), or goals with their numbers ("success:0.7").

    Raises:
        ValueError: There is no goal of these words.
    """
    name, numbers = _read(words)
    return any(goal == name or (":" in goal and _read(goal) == (name, numbers)) for goal in goals)


def _read(words: str) -> tuple[str, tuple[float, ...]]:
    """Return name and numbers of a goal.

    Raises:
        ValueError: The goal is unknown, or its numbers are out of range.
    """
    name, *texts = words.split(":")
    try:
        numbers = tuple(float(text) for text in texts)
    except ValueError:
        numbers = (math.nan,)
    if name == "task" and not numbers:
        return name, ()
    if name == "success" and len(numbers) <= 1 and all(0.0 < number < 1.0 for number in numbers):
        return name, numbers or (TARGET,)
    if name in STATES and len(numbers) == 2 and -1.0 <= numbers[0] < numbers[1] <= 1.0:
        return name, numbers
    raise ValueError(f'unknown goal "{words}": task, success:SHARE, or arousal, valence or effort with :LOW:HIGH')
