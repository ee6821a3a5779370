"""Contextual bandits over the levels of demand: LinUCB and Thompson sampling with a linear model per person."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.learning.policy import LEVELS, REWARDS, TARGET, Choice, Outcome, Policy

__all__ = ["POLICIES", "LinUcb", "Thompson"]

_CENTRES = np.linspace(0.0, 1.0, 9)
"""Centres of the radial basis functions over the demand, nearer than their width: no demand lies between them."""
_WIDTH = 0.16
"""Width of a radial basis function [demand]: rewards farther apart are nearly independent."""
_FEATURES = len(_CENTRES) + 1
_NOISE = 0.3
"""Standard deviation of a reward; the prior variance of each weight is 1."""
_HOME = 0.35
"""Scale of the quadratic prior: distance from the first demand at which the expected reward is 1 lower [demand]."""


_FIRST = 0.3
"""Prior mean reward of the first demand: below what a good one earns, so that a found one is kept."""
_LOAD = 0.3
"""Success that full over-challenge by the body outweighs; it is noisier than success is."""
_STEP, _ASKED = 0.2, 4.0
"""Distance at which a step is a whole one [demand], and slope of what asks for it: success beyond the target by 1/4."""


class _LinearBandit:
    """Linear reward model: radial basis functions over the demand, and the step indicated by the last trial."""

    follows = REWARDS
    explores = True

    def begin(self, start: F8, rng: np.random.Generator) -> None:
        """Begin a session of people at these demands [n]."""
        n = len(start)
        self._rng = rng
        self._precision = np.tile(np.eye(_FEATURES), (n, 1, 1))
        self._sums = np.zeros((n, _FEATURES))
        self._place = np.array(start, float)
        self._home = self._place.copy()
        self._asked = np.zeros(n)

    def learn(self, outcome: Outcome) -> None:
        """Update the model with the reward of a trial."""
        row = self._features(outcome.demand[:, None])[:, 0]
        known = np.isfinite(outcome.reward) & np.isfinite(row).all(axis=1)
        row = np.where(known[:, None], row, 0.0)
        self._precision += np.einsum("nf,ng->nfg", row, row) / _NOISE**2
        left = outcome.reward - self._prior(outcome.demand[:, None])[:, 0]
        self._sums += row * np.where(known, left, 0.0)[:, None] / _NOISE**2
        self._place = np.where(np.isfinite(outcome.demand), outcome.demand, self._place)
        load = _LOAD * np.nan_to_num(outcome.load)
        self._asked = np.nan_to_num(outcome.performance - TARGET) - load

    def _features(self, demand: F8) -> F8:
        """Return the features of demands [n, levels], shape [n, levels, f]."""
        bumps = np.exp(-0.5 * ((demand[:, :, None] - _CENTRES) / _WIDTH) ** 2)
        step = np.tanh((demand - self._place[:, None]) / _STEP) * np.tanh(_ASKED * self._asked)[:, None]
        return np.concatenate([bumps, step[:, :, None]], axis=2)

    def _prior(self, demand: F8) -> F8:
        """Return the prior mean reward of demands [n, levels]."""
        return _FIRST - (demand - self._home[:, None]) ** 2 / _HOME**2

    def _model(self) -> tuple[F8, F8, F8]:
        """Return features of all levels [n, levels, f], mean rewards [n, levels], weight covariance [n, f, f]."""
        levels = np.tile(LEVELS, (len(self._place), 1))
        features = self._features(levels)
        covariance: F8 = np.asarray(np.linalg.inv(self._precision), np.float64)
        weights = np.einsum("nfg,ng->nf", covariance, self._sums)
        return features, self._prior(levels) + np.einsum("nlf,nf->nl", features, weights), covariance


class LinUcb(_LinearBandit):
    """LinUCB: the level with the largest upper confidence bound of the reward (Li et al., WWW 2010).

    Args:
        width: Confidence bound in standard deviations above the mean; tens of trials leave no time for more.
    """

    def __init__(self, width: float = 0.3) -> None:
        self._width = width

    def act(self) -> Choice:
        """Return the demands of the next trial."""
        features, mean, covariance = self._model()
        spread = np.sqrt(np.einsum("nlf,nfg,nlg->nl", features, covariance, features))
        best = np.argmax(mean + self._width * spread, axis=1)
        return Choice(LEVELS[best], np.ones(len(best)))


class Thompson(_LinearBandit):
    """Thompson sampling: the best level of a model drawn from the posterior; propensity from further draws.

    Args:
        draws: Number of draws for the propensity, which is then known to 6 % at most.
        width: Factor on the standard deviation of the posterior; below 1 less is tried, as with `LinUcb`.
    """

    def __init__(self, draws: int = 64, width: float = 0.3) -> None:
        self._draws, self._width = draws, width

    def act(self) -> Choice:
        """Return the demands of the next trial."""
        features, mean, covariance = self._model()
        root = np.linalg.cholesky(covariance)
        noise = self._width * self._rng.standard_normal((self._draws + 1, len(mean), _FEATURES))
        drawn = np.einsum("nfg,dng->dnf", root, noise)
        best = np.argmax(mean + np.einsum("nlf,dnf->dnl", features, drawn), axis=2)
        chosen = best[0]
        share = ((best == chosen).sum(axis=0) + 0.5) / (self._draws + 1.5)
        return Choice(LEVELS[chosen], share)


POLICIES: dict[str, Callable[[], Policy]] = {"linucb": LinUcb, "thompson": Thompson}
"""Builders of these policies by name."""
