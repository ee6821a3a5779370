"""The agent of a session: a policy whose actions respect limits, dwell times and costs of the parameters."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np

from mimics_app.contracts.messages.action_space import ActionSpace, Parameter
from mimics_app.contracts.messages.stage_messages import TaskAction, TrialResult, UserState
from mimics_app.learning.goals import STATES
from mimics_app.learning.policy import Outcome, Policy
from mimics_app.learning.registry import build_policy

__all__ = ["Agent"]

_LOOKS = 3
"""Number of values to explore of a neutral parameter without steps."""
_MOST_ARMS = 12
"""Largest number of values to explore of a neutral parameter."""
_SPREAD = 0.4
"""Standard deviation of an arm's mean reward before any trial."""
_DRAWS = 65
"""Draws from which an arm and its propensity are taken."""


class Agent:
    """Learning stage that chooses the demand after each trial, and after each reward without a trial.

    With an exploring policy it also chooses the values of neutral parameters (appearance, sound, place of an avatar),
    which make nothing harder, each by its own rewards.

    Args:
        policy: Name of a policy, or one itself, which chooses no neutral parameters.
        space: Parameters to choose, without those the therapist has vetoed.
        seed: Seed of the session.
    """

    def __init__(self, policy: str | Policy, space: ActionSpace, seed: int) -> None:
        self._rng = np.random.default_rng([seed, 1604])
        self._space = space
        self._policy: Policy = build_policy(policy) if isinstance(policy, str) else policy
        start = space.demand(space.defaults())
        self._demand = 0.5 if start is None else start
        self._policy.begin(np.array([self._demand]), self._rng)
        explores = isinstance(policy, str) and getattr(self._policy, "explores", False)
        neutral = [p for p in space if p.harder == 0 and p.high > p.low] if explores else []
        self._arms = [_Arms(p, self._rng) for p in neutral]
        self._waits = not set(STATES).isdisjoint(self._policy.follows)
        self._values = space.defaults()
        self._held = dict(self._values)
        self._changed_ns: dict[str, int] = {}

    def choose(
        self, state: UserState, result: TrialResult | None, reward: float | None, now_ns: int
    ) -> TaskAction | None:
        """Return the action after a trial, with all values chosen so far, or after a reward; None without any.

        A policy that follows rewards keeps its choice until one comes, however many trials that takes.
        """
        if result is None and reward is None:
            return None
        propensity = 1.0
        values: dict[str, float] = {}
        if reward is not None or not self._waits:
            self._learn(state, result, reward)
            propensity, values = self._act(now_ns)
            self._changed_ns |= dict.fromkeys(values, now_ns)
            self._values |= values
        self._hold(values, ended=result is not None)
        if result is not None:  # a choice that stays is repeated: the trial list would set its own value again
            values = {name: self._values[name] for name in self._changed_ns}
        if not values:
            return None
        return TaskAction(values, None if result is None else result.trial + 1, propensity)

    def _learn(self, state: UserState, result: TrialResult | None, reward: float | None) -> None:
        held = self._held if result is None else result.values
        self._policy.learn(self._outcome(state, result, reward, held))
        for arms in self._arms:
            cost = _cost([self._space[arms.name]], held)
            arms.learn(None if reward is None else reward - cost, held.get(arms.name))

    def _act(self, now_ns: int) -> tuple[float, dict[str, float]]:
        """Return the propensity of a new choice, and those of its values that change and may change now."""
        choice = self._policy.act()
        values, propensity = self._wanted(float(choice.demand[0])), float(choice.propensity[0])
        for arms in self._arms:
            if self._is_free(arms.name, now_ns):
                value, probability = arms.act()
                values[arms.name], propensity = value, propensity * probability
        changed = {n: value for n, value in values.items() if value != self._values[n] and self._is_free(n, now_ns)}
        return propensity, changed

    def _hold(self, values: Mapping[str, float], *, ended: bool) -> None:
        """Note what holds from now on: inside a trial only what has a rate changes, the others with the next trial."""
        if ended:
            self._held = dict(self._values)
        else:
            self._held |= {name: value for name, value in values.items() if self._space[name].rate > 0.0}

    def _outcome(
        self, state: UserState, result: TrialResult | None, reward: float | None, held: Mapping[str, float]
    ) -> Outcome:
        """Return the outcome of the values that held, less what those of the demand cost."""
        demand = self._space.demand(held)
        return Outcome.of_one(
            np.nan if demand is None else demand,
            np.nan if result is None else result.performance,
            state,
            np.nan if reward is None else reward - _cost((p for p in self._space if p.harder != 0), held),
        )

    def _wanted(self, demand: float) -> dict[str, float]:
        return {p.name: p.at_demand(demand) for p in self._space if p.harder != 0}

    def _is_free(self, name: str, now_ns: int) -> bool:
        """Whether the dwell time of a parameter is over."""
        since = (now_ns - self._changed_ns[name]) / 1e9 if name in self._changed_ns else np.inf
        return since >= self._space[name].dwell_s


def _cost(parameters: Iterable[Parameter], held: Mapping[str, float]) -> float:
    """Return what it costs that these parameters deviate from their defaults."""
    changed = ((p, held[p.name]) for p in parameters if p.name in held and p.high > p.low)
    return sum(p.cost * abs(value - p.default) / (p.high - p.low) for p, value in changed)


class _Arms:
    """The values of one neutral parameter as a bandit with Thompson sampling."""

    def __init__(self, parameter: Parameter, rng: np.random.Generator) -> None:
        self.name = parameter.name
        count = round((parameter.high - parameter.low) / parameter.step) + 1 if parameter.step > 0.0 else _LOOKS
        grid = np.linspace(parameter.low, parameter.high, min(count, _MOST_ARMS))
        self._values = [parameter.clip(float(value)) for value in grid]
        self._rng = rng
        self._counts = np.zeros(len(self._values))
        self._means = np.zeros(len(self._values))

    def learn(self, reward: float | None, value: float | None) -> None:
        """Update the arm of the value that held in a trial by its reward; other values are ignored."""
        if reward is None or value not in self._values:
            return
        arm = self._values.index(value)
        self._counts[arm] += 1.0
        self._means[arm] += (reward - self._means[arm]) / self._counts[arm]

    def act(self) -> tuple[float, float]:
        """Return a value and its propensity."""
        spread = _SPREAD / np.sqrt(self._counts + 1.0)
        drawn = (self._means + spread * self._rng.standard_normal((_DRAWS, len(self._values)))).argmax(axis=1)
        share = (np.count_nonzero(drawn == drawn[0]) + 0.5) / (_DRAWS + 0.5)
        return self._values[int(drawn[0])], float(share)
