"""Contextual bandits over the levels of demand: LinUCB and Thompson sampling with a linear model per person."""

from __future__ import annotations

import numpy as np

from mimics_app.learning.policy import LEVELS, Choice, Floats, Outcome

__all__ = ["LinUcb", "Thompson"]

_FEATURES = 6
_NOISE = 0.15
"""Standard deviation of a reward."""


class _LinearBandit:
    """Rewards as a linear function of level, its square and what the last trial said."""

    def begin(self, start: Floats, rng: np.random.Generator) -> None:
        n = len(start)
        self._rng = rng
        self._precision = np.tile(np.eye(_FEATURES), (n, 1, 1))
        self._sums = np.zeros((n, _FEATURES))
        self._place = np.array(start, float)
        self._seen = np.zeros((n, 2))

    def learn(self, outcome: Outcome) -> None:
        """A trial at a demand was worth its reward."""
        row = _features(outcome.demand[:, None], self._place, self._seen)[:, 0]
        known = np.isfinite(outcome.reward) & np.isfinite(row).all(axis=1)
        row = np.where(known[:, None], row, 0.0)
        self._precision += np.einsum("nf,ng->nfg", row, row)
        self._sums += row * np.nan_to_num(outcome.reward)[:, None]
        self._place = np.where(np.isfinite(outcome.demand), outcome.demand, self._place)
        self._seen = np.stack([np.nan_to_num(outcome.performance - 0.7), np.nan_to_num(outcome.load)], axis=1)

    def _model(self) -> tuple[Floats, Floats, Floats]:
        """Features of every level [n, levels, f], weights [n, f], covariance [n, f, f]."""
        n = len(self._place)
        features = _features(np.tile(LEVELS, (n, 1)), self._place, self._seen)
        covariance: Floats = np.linalg.inv(self._precision)
        return features, np.einsum("nfg,ng->nf", covariance, self._sums), covariance


def _features(demand: Floats, place: Floats, seen: Floats) -> Floats:
    """1, step, step^2 from where the person is, and what the last trial said times the step; shape [n, levels, f]."""
    step = (demand - place[:, None]) / 0.3
    p, load = seen[:, :1] / 0.3, seen[:, 1:]
    return np.stack([np.ones_like(step), step, step**2, p * step, load * step, np.abs(p) * np.abs(step)], axis=2)


class LinUcb(_LinearBandit):
    """The level whose reward may be highest (Li et al., WWW 2010).

    Args:
        width: Standard deviations above the mean.
    """

    def __init__(self, width: float = 0.3) -> None:
        self._width = width

    def act(self) -> Choice:
        features, weights, covariance = self._model()
        mean = np.einsum("nlf,nf->nl", features, weights)
        spread = np.sqrt(np.einsum("nlf,nfg,nlg->nl", features, covariance, features))
        best = np.argmax(mean + self._width * spread, axis=1)
        return Choice(LEVELS[best], np.ones(len(best)))


class Thompson(_LinearBandit):
    """The best level of a model drawn from what is believed; its propensity is counted over further draws.

    Args:
        draws: For the propensity.
    """

    def __init__(self, draws: int = 64) -> None:
        self._draws = draws

    def act(self) -> Choice:
        features, weights, covariance = self._model()
        root = np.linalg.cholesky(covariance)
        noise = _NOISE * self._rng.standard_normal((self._draws + 1, *weights.shape))
        drawn = weights + np.einsum("nfg,dng->dnf", root, noise)
        best = np.argmax(np.einsum("nlf,dnf->dnl", features, drawn), axis=2)
        chosen = best[0]
        share = ((best == chosen).sum(axis=0) + 0.5) / (self._draws + 1.5)
        return Choice(LEVELS[chosen], share)
