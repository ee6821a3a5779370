"""Load of the person, under-challenged, challenged or over-challenged, by a fixed or an adaptive linear discriminant.

Both are trained on the trials of many people. The fixed one treats differences between people as noise. The adaptive
one estimates the class means of this person: their prior is the distribution among those people, and each trial updates
them by a Kalman filter (after the adaptive classifier of Koenig et al., IEEE TNSRE 19(4), 2011).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import F8

__all__ = ["AdaptiveLda", "Lda", "LoadModel", "train_load"]

_CLASSES = 3
_SHRINKAGE = 0.1
"""Shrinkage of covariances to their diagonals: few people, many features (Ledoit & Wolf, 2004)."""
_DRIFT = 0.01
"""Process noise of the class means per trial, as a share of the variance between people: fatigue and habituation."""
_PEOPLE = 0.3
"""Share of the fixed discriminant in the probability while the person has given no answer: bounds wrong certainty."""


@dataclass(frozen=True, slots=True)
class LoadModel:
    """Statistics of the trials of many people.

    Attributes:
        means: Means of the classes [3, f].
        within: Covariance of the trials within a class of a person [f, f].
        between: Covariance of the class means between people [3 f, 3 f], class by class.
    """

    means: F8
    within: F8
    between: F8


def train_load(features: F8, classes: NDArray[np.int64]) -> LoadModel:
    """Train the model on labelled trials.

    Args:
        features: Features of each trial, shape [people, trials, f]; NaN: unknown, replaced by the mean.
        classes: Class of each trial, 0 to 2, shape [people, trials].

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
    noise = np.kron(np.eye(_CLASSES), within) * _CLASSES / features.shape[1]  # variance of the mean of a few trials
    between = _positive(_shrunk(away.T @ away / (people - 1)) - noise)
    return LoadModel(means, within, between)


def _shrunk(covariance: F8) -> F8:
    shrunk: F8 = (1.0 - _SHRINKAGE) * covariance + _SHRINKAGE * np.diag(np.diag(covariance))
    return shrunk + 1e-6 * np.eye(len(covariance))


def _positive(covariance: F8) -> F8:
    """Return the nearest positive definite matrix: negative eigenvalues are set to a small positive one."""
    values, vectors = np.linalg.eigh(covariance)
    nearest: F8 = (vectors * np.maximum(values, 1e-4)) @ vectors.T
    return nearest


class Lda:
    """A fixed linear discriminant."""

    def __init__(self, model: LoadModel) -> None:
        self.means = model.means.copy()
        f = self.means.shape[1]
        self._within = model.within
        self._spread = model.between.reshape(_CLASSES, f, _CLASSES, f)[range(_CLASSES), :, range(_CLASSES), :].copy()
        self._spread[:] = self._spread.mean(axis=0)

    def probabilities(self, features: F8) -> F8:
        """Return the probability of each class, shape [3], for a feature vector [f]; NaN features are left out."""
        known = np.flatnonzero(np.isfinite(features))
        if not len(known):
            return np.full(_CLASSES, 1.0 / _CLASSES)
        score = np.empty(_CLASSES)
        for k in range(_CLASSES):
            away = features[known] - self.means[k, known]
            covariance = (self._within + self._spread[k])[np.ix_(known, known)]
            score[k] = -0.5 * (away @ np.linalg.solve(covariance, away) + np.linalg.slogdet(covariance)[1])
        weights = np.exp(score - score.max())
        result: F8 = weights / weights.sum()
        return result

    def learn(self, features: F8, label: int | None) -> None:
        """Do nothing: this discriminant does not adapt."""


class AdaptiveLda(Lda):
    """A linear discriminant whose class means are tracked by a Kalman filter, updated after each trial.

    Learning from its own guesses alone, it would become certain of a wrong class in a long run of one class. Until the
    person's first answer the probability is therefore a mixture with that of the fixed discriminant.
    """

    def __init__(self, model: LoadModel) -> None:
        super().__init__(model)
        self._people: Lda | None = Lda(model)
        self._covariance = model.between.copy()
        self._drift = _DRIFT * np.diag(np.diag(model.between))
        self._split()

    def probabilities(self, features: F8) -> F8:
        """Return the probability of each class, shape [3], see `Lda.probabilities`."""
        own = super().probabilities(features)
        if self._people is None:
            return own
        return (1.0 - _PEOPLE) * own + _PEOPLE * self._people.probabilities(features)

    def learn(self, features: F8, label: int | None) -> None:
        """Update by a trial: by its class if `label` is given, else by all classes weighted by probability."""
        known = np.flatnonzero(np.isfinite(features))
        if not len(known):
            return
        weights = self.probabilities(features) if label is None else np.eye(_CLASSES)[label]
        if label is not None:
            self._people = None
        self._covariance += self._drift
        flat = self.means.ravel()
        updates = [self._updated(flat, features, known, k) for k in range(_CLASSES)]
        mean = sum(w * m for w, (m, _) in zip(weights, updates, strict=True))
        spread = [w * (p + np.outer(m - mean, m - mean)) for w, (m, p) in zip(weights, updates, strict=True)]
        self.means, self._covariance = np.asarray(mean).reshape(self.means.shape), np.sum(spread, axis=0)
        self._split()

    def _updated(self, flat: F8, features: F8, known: NDArray[np.int64], k: int) -> tuple[F8, F8]:
        """Return the class means and their covariance under the assumption that the trial is of class k."""
        places = known + k * self.means.shape[1]
        seen = self._covariance[:, places]
        gain = np.linalg.solve(self._covariance[np.ix_(places, places)] + self._within[np.ix_(known, known)], seen.T).T
        return flat + gain @ (features[known] - flat[places]), self._covariance - gain @ seen.T

    def _split(self) -> None:
        """Take the covariance of each class mean, which adds to that within the class."""
        f = self.means.shape[1]
        self._spread = self._covariance.reshape(_CLASSES, f, _CLASSES, f)[range(_CLASSES), :, range(_CLASSES), :]
