"""Policies that follow a rule: fixed, random, staircase, proportional, and a Kalman tracker of the skill."""

from __future__ import annotations

from collections.abc import Callable, Collection

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.learning.policy import CONTROL, LEVELS, TARGET, Choice, Outcome, Policy, logit

__all__ = ["POLICIES", "Fixed", "KalmanSkill", "Proportional", "RandomLevel", "Staircase"]

_FIRST_SPREAD, _WALK = 0.2, 0.005
"""Standard deviation of a person's demand of 70 % success before any trial, and of its change in a trial [demand]."""
_VIEW, _EXTREME_VIEW = 0.06, 0.18
"""Standard deviation of that demand as seen by success, and by a success below 10 % or above 90 % [demand]."""
_LOAD_GAIN, _LOAD_VIEW = 0.25, 0.25
"""Demand in excess per unit of load, and standard deviation of the demand as seen by the load [demand]."""
_KEPT = 0.92
"""Share of the correlation of load and success that is left after a trial."""
_LEAST_RECORD = 0.2
"""Correlation of load and success below which the load is not used."""

_TARGET_ONLY = (f"success:{TARGET}",)
"""Goals of a rule whose numbers are made for one share of success."""


class Fixed:
    """Keeps the demand of the session's beginning."""

    follows: Collection[str] = CONTROL
    explores = False

    def begin(self, start: F8, rng: np.random.Generator) -> None:
        """Begin a session of people at these demands [n]."""
        self._demand = np.array(start, float)

    def act(self) -> Choice:
        """Return the demands of the next trial."""
        return Choice(self._demand.copy(), np.ones(len(self._demand)))

    def learn(self, outcome: Outcome) -> None:
        """Do nothing."""


class RandomLevel(Fixed):
    """Draws among the levels with equal probability."""

    explores = True

    def begin(self, start: F8, rng: np.random.Generator) -> None:
        """Begin a session of people at these demands [n]."""
        super().begin(start, rng)
        self._rng = rng

    def act(self) -> Choice:
        """Return the demands of the next trial."""
        n = len(self._demand)
        return Choice(self._rng.choice(LEVELS, n), np.full(n, 1.0 / len(LEVELS)))


class Staircase(Fixed):
    """One step up after at least 80 % success, one step down below 60 %."""

    follows = _TARGET_ONLY

    def __init__(self, step: float = 0.05) -> None:
        self._step = step

    def learn(self, outcome: Outcome) -> None:
        """Learn from a trial."""
        p = outcome.performance
        move = np.where(p >= 0.8, self._step, np.where(p < 0.6, -self._step, 0.0))
        self._demand = np.clip(self._demand + move, 0.0, 1.0)


class Proportional(Fixed):
    """Moves in proportion to the difference between success and 70 %."""

    follows = _TARGET_ONLY

    def __init__(self, gain: float = 0.25) -> None:
        self._gain = gain

    def learn(self, outcome: Outcome) -> None:
        """Learn from a trial."""
        move = self._gain * np.nan_to_num(outcome.performance - TARGET)
        self._demand = np.clip(self._demand + move, 0.0, 1.0)


class KalmanSkill(Fixed):
    """Kalman filter of the demand at which this person succeeds in 70 %, observed by success and by the load.

    Success p at demand d observes that demand at d + (logit p - logit 0.7) / slope. The load is a second observation: a
    person who is over-challenged at d has that demand below d. Its noise depends on its correlation with success so
    far, so that the load of a non-responder, or one unrelated to the demand, loses its weight.

    Args:
        use_load: False: success alone.
        slope: Slope of success over demand [logit per unit].
    """

    follows = _TARGET_ONLY

    def __init__(self, *, use_load: bool = True, slope: float = 10.0) -> None:
        self._use_load = use_load
        self._slope = slope

    def begin(self, start: F8, rng: np.random.Generator) -> None:
        """Begin a session of people at these demands [n]."""
        super().begin(start, rng)
        n = len(self._demand)
        self._variance = np.full(n, _FIRST_SPREAD**2)
        self._weights = np.zeros((n, 3))  # correlation of load and success: products, squares of either

    def learn(self, outcome: Outcome) -> None:
        """Learn from a trial."""
        self._variance += _WALK**2
        p = outcome.performance
        away = (logit(p) - logit(np.array(TARGET))) / self._slope
        wide = np.where(np.abs(p - 0.5) > 0.4, _EXTREME_VIEW, _VIEW)
        known = np.isfinite(p) & np.isfinite(outcome.demand)
        self._update(outcome.demand + away, np.where(known, wide**2, np.inf))
        if self._use_load:
            self._take_load(outcome, away)

    def _take_load(self, outcome: Outcome, away: F8) -> None:
        """Update by the load, with a noise that depends on its correlation with success."""
        load = np.nan_to_num(outcome.load)
        known = np.isfinite(outcome.load) & np.isfinite(outcome.demand)
        both = known & np.isfinite(away)
        products = np.stack([-load * np.nan_to_num(away), load**2, np.nan_to_num(away) ** 2], axis=1)
        self._weights = np.where(both[:, None], _KEPT * self._weights + products, self._weights)
        product, one, other = self._weights.T
        record = np.clip(product / np.sqrt(one * other + 1e-9), 0.0, 1.0)
        variance = (_LOAD_VIEW**2 + 0.09 * np.nan_to_num(outcome.load_variance)) / np.maximum(record, 1e-3) ** 2
        view = outcome.demand - _LOAD_GAIN * np.clip(load, -0.9, 0.9)
        self._update(view, np.where(known & (record > _LEAST_RECORD), variance, np.inf))

    def _update(self, view: F8, noise: F8) -> None:
        gain = np.where(
            np.isfinite(noise), self._variance / (self._variance + np.where(np.isfinite(noise), noise, 1.0)), 0.0
        )
        self._demand = np.clip(self._demand + gain * np.nan_to_num(view - self._demand), 0.0, 1.0)
        self._variance = self._variance * (1.0 - gain)


POLICIES: dict[str, Callable[[], Policy]] = {
    "fixed": Fixed,
    "random": RandomLevel,
    "staircase": Staircase,
    "proportional": Proportional,
    "kalman_performance": lambda: KalmanSkill(use_load=False),
    "kalman": KalmanSkill,
}
"""Builders of these policies by name."""
