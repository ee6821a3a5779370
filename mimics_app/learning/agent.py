"""A policy at work in one session: from results and states to actions inside their limits, dwell times and costs."""

from __future__ import annotations

import numpy as np

from mimics_app.contracts.action_space import ActionSpace, Parameter
from mimics_app.contracts.messages import TaskAction, TrialResult, UserState
from mimics_app.learning.policy import Floats, Outcome, Policy
from mimics_app.learning.registry import EXPLORERS, build_policy

__all__ = ["Agent"]

_LOOKS = 3
"""Values of a parameter that makes nothing harder, among which an exploring policy chooses where it has no steps."""


class Agent:
    """Chooses after each trial how hard the next one is; and where a reward comes without one, from then on.

    A policy that explores also chooses among the values of parameters that make nothing harder (what is seen, heard,
    where an avatar is), each by what the rewards said of it.

    Args:
        policy: Name of a policy.
        space: What may be chosen; what the therapist has vetoed is not in it.
        seed: Of the session.
    """

    def __init__(self, policy: str, space: ActionSpace, seed: int) -> None:
        self._rng = np.random.default_rng([seed, 1604])
        self._space = space
        self._policy: Policy = build_policy(policy)
        start = space.demand(space.defaults())
        self._demand = 0.5 if start is None else start
        self._policy.begin(np.array([self._demand]), self._rng)
        neutral = [p for p in space if p.harder == 0 and p.high > p.low] if policy in EXPLORERS else []
        self._arms = [_Arms(p, self._rng) for p in neutral]
        self._values = space.defaults()
        self._changed_ns: dict[str, int] = {}

    def choose(
        self, state: UserState, result: TrialResult | None, reward: float | None, now_ns: int
    ) -> TaskAction | None:
        """After a trial, or a reward without one: what comes next; None where nothing is to change."""
        if result is None and reward is None:
            return None
        self._policy.learn(self._outcome(state, result, reward))
        for arms in self._arms:
            arms.learn(reward)
        choice = self._policy.act()
        values, propensity = self._wanted(float(choice.demand[0])), float(choice.propensity[0])
        for arms in self._arms:
            value, chance = arms.act()
            values[arms.name], propensity = value, propensity * chance
        values = {name: value for name, value in values.items() if self._may_change(name, value, now_ns)}
        for name in values:
            self._changed_ns[name] = now_ns
        self._values |= values
        if not values:
            return None
        return TaskAction(values, None if result is None else result.trial + 1, propensity)

    def _outcome(self, state: UserState, result: TrialResult | None, reward: float | None) -> Outcome:
        demand = self._space.demand(self._values if result is None else result.values)
        load, spread = np.nan, np.nan
        if state.load is not None and state.arousal is not None:
            load, spread = state.load[2] - state.load[0], state.arousal.variance
        worth = np.nan if reward is None else reward - self._cost(result)
        return Outcome(
            _one(np.nan if demand is None else demand),
            _one(np.nan if result is None else result.performance),
            _one(load),
            _one(spread),
            _one(worth),
        )

    def _cost(self, result: TrialResult | None) -> float:
        """What the change before this trial cost."""
        if result is None:
            return 0.0
        changed = ((p, result.values[p.name]) for p in self._space if p.name in result.values and p.high > p.low)
        return sum(p.cost * abs(value - p.default) / (p.high - p.low) for p, value in changed)

    def _wanted(self, demand: float) -> dict[str, float]:
        return {p.name: p.at_demand(demand) for p in self._space if p.harder != 0}

    def _may_change(self, name: str, value: float, now_ns: int) -> bool:
        if value == self._values[name]:
            return False
        since = (now_ns - self._changed_ns[name]) / 1e9 if name in self._changed_ns else np.inf
        return since >= self._space[name].dwell_s


class _Arms:
    """One neutral parameter: values drawn by Thompson sampling from the rewards each of them had."""

    def __init__(self, parameter: Parameter, rng: np.random.Generator) -> None:
        self.name = parameter.name
        count = round((parameter.high - parameter.low) / parameter.step) + 1 if parameter.step > 0.0 else _LOOKS
        grid = np.linspace(parameter.low, parameter.high, min(count, 12))
        self._values = [parameter.clip(float(value)) for value in grid]
        self._rng = rng
        self._counts = np.zeros(len(self._values))
        self._means = np.zeros(len(self._values))
        self._chosen: int | None = None

    def learn(self, reward: float | None) -> None:
        """What followed the value chosen last was worth this."""
        if reward is None or self._chosen is None:
            return
        self._counts[self._chosen] += 1.0
        self._means[self._chosen] += (reward - self._means[self._chosen]) / self._counts[self._chosen]

    def act(self) -> tuple[float, float]:
        """A value and its propensity."""
        spread = 0.4 / np.sqrt(self._counts + 1.0)
        drawn = (self._means + spread * self._rng.standard_normal((65, len(self._values)))).argmax(axis=1)
        self._chosen = int(drawn[0])
        return self._values[self._chosen], float((np.count_nonzero(drawn == drawn[0]) + 0.5) / 65.5)


def _one(value: float) -> Floats:
    return np.array([value])
