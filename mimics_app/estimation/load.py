"""Under-challenged, challenged or over-challenged: linear discriminants, fixed or following the person.

Both are trained on the trials of many people. The fixed one sees what people differ by as noise. The adaptive one takes
it for what it is: the class means of this person are unknown, distributed as they were among those people, and each
trial says more of them (a Kalman filter over the class means; after the adaptive classifier of Koenig et al., IEEE
TNSRE 19(4), 2011).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["AdaptiveLda", "Lda", "LoadModel", "train_load"]

Floats = NDArray[np.float64]

_CLASSES = 3
_SHRINKAGE = 0.1
"""Share by which covariances are drawn to their diagonals: few people, many features (Ledoit & Wolf, 2004)."""
_DRIFT = 0.01
"""Growth of the variance of the class means per trial, as a share of what people differ by: they tire and get used."""


@dataclass(frozen=True, slots=True)
class LoadModel:
    """What many people's trials say.

    Attributes:
        means: Of the classes [3, f].
        within: Covariance of the trials of one class of one person [f, f].
        between: Covariance of the class means among people [3 f, 3 f], class by class.
    """

    means: Floats
    within: Floats
    between: Floats


def train_load(features: Floats, classes: NDArray[np.int64]) -> LoadModel:
    """Learn from labelled trials.

    Args:
        features: Of each trial of each person, shape [people, trials, f]; NaN: not known, taken as at the mean.
        classes: 0 to 2, shape [people, trials].

    Raises:
        ValueError: A person has no trial of a class, or there are fewer than three people.
    """
    people, _, f = features.shape
    if people < 3 or any(set(one.tolist()) != set(range(_CLASSES)) for one in classes):
        raise ValueError("three people at least, each with trials of all three classes")
    known = np.where(np.isfinite(features), features, np.nanmean(features, axis=(0, 1)))
    own = np.array([[x[c == k].mean(axis=0) for k in range(_CLASSES)] for x, c in zip(known, classes, strict=True)])
    means = own.mean(axis=0)
    left = known - np.take_along_axis(own, classes[:, :, None], axis=1)
    freedom = left.shape[0] * (left.shape[1] - _CLASSES)
    within = _shrunk(np.einsum("ptf,ptg->fg", left, left) / max(freedom, 1))
    away = (own - means).reshape(people, _CLASSES * f)
    noise = np.kron(np.eye(_CLASSES), within) * _CLASSES / features.shape[1]  # of a mean of a few trials
    between = _positive(_shrunk(away.T @ away / (people - 1)) - noise)
    return LoadModel(means, within, between)


def _shrunk(covariance: Floats) -> Floats:
    shrunk: Floats = (1.0 - _SHRINKAGE) * covariance + _SHRINKAGE * np.diag(np.diag(covariance))
    return shrunk + 1e-6 * np.eye(len(covariance))


def _positive(covariance: Floats) -> Floats:
    """The nearest covariance: directions in which people differ by less than nothing are flat."""
    values, vectors = np.linalg.eigh(covariance)
    nearest: Floats = (vectors * np.maximum(values, 1e-4)) @ vectors.T
    return nearest


class Lda:
    """A fixed discriminant."""

    def __init__(self, model: LoadModel) -> None:
        self.means = model.means.copy()
        f = self.means.shape[1]
        self._within = model.within
        self._spread = model.between.reshape(_CLASSES, f, _CLASSES, f)[range(_CLASSES), :, range(_CLASSES), :].copy()
        self._spread[:] = self._spread.mean(axis=0)

    def probabilities(self, features: Floats) -> Floats:
        """Of each class, shape [3], of one feature vector [f]; what is NaN is left out of the comparison."""
        known = np.flatnonzero(np.isfinite(features))
        if not len(known):
            return np.full(_CLASSES, 1.0 / _CLASSES)
        score = np.empty(_CLASSES)
        for k in range(_CLASSES):
            away = features[known] - self.means[k, known]
            covariance = (self._within + self._spread[k])[np.ix_(known, known)]
            score[k] = -0.5 * (away @ np.linalg.solve(covariance, away) + np.linalg.slogdet(covariance)[1])
        weights = np.exp(score - score.max())
        result: Floats = weights / weights.sum()
        return result

    def learn(self, features: Floats, label: int | None) -> None:
        """A trial is over: nothing is taken from it."""


class AdaptiveLda(Lda):
    """Follows the person: after each trial the means of all classes are what a Kalman filter makes of them."""

    def __init__(self, model: LoadModel) -> None:
        super().__init__(model)
        self._covariance = model.between.copy()
        self._drift = _DRIFT * np.diag(np.diag(model.between))
        self._split()

    def learn(self, features: Floats, label: int | None) -> None:
        """A trial is over; `label` where it is known (the person was asked), else each class as far as it is likely."""
        known = np.flatnonzero(np.isfinite(features))
        if not len(known):
            return
        weights = self.probabilities(features) if label is None else np.eye(_CLASSES)[label]
        self._covariance += self._drift
        flat = self.means.ravel()
        updates = [self._updated(flat, features, known, k) for k in range(_CLASSES)]
        mean = sum(w * m for w, (m, _) in zip(weights, updates, strict=True))
        spread = [w * (p + np.outer(m - mean, m - mean)) for w, (m, p) in zip(weights, updates, strict=True)]
        self.means, self._covariance = np.asarray(mean).reshape(self.means.shape), np.sum(spread, axis=0)
        self._split()

    def _updated(self, flat: Floats, features: Floats, known: NDArray[np.int64], k: int) -> tuple[Floats, Floats]:
        """Means and their covariance, had the trial been of class k."""
        places = known + k * self.means.shape[1]
        seen = self._covariance[:, places]
        gain = np.linalg.solve(self._covariance[np.ix_(places, places)] + self._within[np.ix_(known, known)], seen.T).T
        return flat + gain @ (features[known] - flat[places]), self._covariance - gain @ seen.T

    def _split(self) -> None:
        """The variance of each class's own mean, which its trials have beside that within a person."""
        f = self.means.shape[1]
        self._spread = self._covariance.reshape(_CLASSES, f, _CLASSES, f)[range(_CLASSES), :, range(_CLASSES), :]
