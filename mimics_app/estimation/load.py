"""Under-challenged, challenged or over-challenged: linear discriminants, fixed or following the person.

The class means of the fixed one come from a training set; the adaptive one moves them by a Kalman gain with what each
trial says of itself (Koenig et al., IEEE TNSRE 19(4), 2011, without its classes' own covariance).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["AdaptiveLda", "Lda", "LdaModel", "train_lda"]

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class LdaModel:
    """Class means [3, f] and the inverse of the covariance they share [f, f]."""

    means: Floats
    precision: Floats


def train_lda(features: Floats, classes: NDArray[np.int64], shrinkage: float = 0.1) -> LdaModel:
    """Means and pooled covariance of labelled features, shape [n, f]; the covariance is drawn to its diagonal.

    Raises:
        ValueError: A class has no example.
    """
    if set(np.unique(classes)) != {0, 1, 2}:
        raise ValueError("each of the three classes needs examples")
    means = np.array([features[classes == c].mean(axis=0) for c in range(3)])
    spread = features - means[classes]
    covariance = spread.T @ spread / max(len(features) - 3, 1)
    diagonal = np.diag(np.diag(covariance))
    covariance = (1.0 - shrinkage) * covariance + shrinkage * diagonal + 1e-9 * np.eye(len(covariance))
    return LdaModel(means, np.linalg.inv(covariance))


class Lda:
    """A fixed discriminant."""

    def __init__(self, model: LdaModel) -> None:
        self.means = model.means.copy()
        self._precision = model.precision

    def probabilities(self, features: Floats) -> Floats:
        """Of each class, shape [3], of one feature vector [f]; what is NaN is left out of the comparison."""
        known = np.isfinite(features)
        if not known.any():
            return np.full(3, 1.0 / 3.0)
        away = features[known] - self.means[:, known]
        precision = self._precision[np.ix_(known, known)]
        score = -0.5 * np.einsum("cf,fg,cg->c", away, precision, away)
        weights = np.exp(score - score.max())
        result: Floats = weights / weights.sum()
        return result

    def learn(self, features: Floats, label: int | None) -> None:
        """A trial is over: nothing is taken from it."""


class AdaptiveLda(Lda):
    """Follows the person: the mean of the class a trial belonged to moves to its features, and the others with it.

    Args:
        model: To begin with.
        first, drift: Variance of a class mean at the start and its growth per trial, in units of the features' own.
    """

    def __init__(self, model: LdaModel, first: float = 0.6, drift: float = 0.01) -> None:
        super().__init__(model)
        self._common = first
        self._own = np.full(3, 0.3 * first)
        self._drift = drift

    def learn(self, features: Floats, label: int | None) -> None:
        """A trial is over; `label` where it is known (asked, or plain from the result), else the most likely class."""
        weight = 1.0
        if label is None:
            probable = self.probabilities(features)
            label, weight = int(probable.argmax()), float(max(probable.max() - 0.5, 0.0))
        known = np.isfinite(features)
        self._common += self._drift
        self._own += self._drift
        total = self._common + self._own[label] + 1.0 / max(weight, 1e-6)
        away = np.where(known, features - self.means[label], 0.0)
        together, alone = self._common / total, self._own[label] / total
        self.means += together * away
        self.means[label] += alone * away
        self._common *= 1.0 - together
        self._own[label] *= 1.0 - alone
