"""Three classes of load: trained on people of four families, tested on people of the fifth (cross-validation).

The adaptive discriminant learns after each trial from the person's answer, or without one from the probabilities of the
classes. Every trial is classified before it is learnt. No clinical evidence.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from mimics_app.contracts.arrays import F8, I8
from mimics_app.estimation.load import AdaptiveLda, Lda, LoadModel, train_load
from mimics_app.estimation.load_people import LoadPeople

__all__ = ["RIVALS", "StateScore", "state_study"]


@dataclass(frozen=True, slots=True)
class StateScore:
    """Score of one estimator.

    Attributes:
        hits: Share of each person's trials that were estimated right, shape [p].
        calibration: Expected calibration error; NaN where no probability is stated.
    """

    hits: F8
    calibration: float = float("nan")

    @property
    def share(self) -> float:
        """Share of all trials that were estimated right."""
        return float(self.hits.mean())

    @property
    def half_width(self) -> float:
        """Half width of the 95 % interval of the share over people."""
        return float(1.96 * self.hits.std(ddof=1) / np.sqrt(len(self.hits)))


def _follow(build: Callable[[LoadModel], Lda], columns: slice, *, asked: bool) -> Callable[[LoadPeople], StateScore]:
    """Return the study of a discriminant over some features, trained without the family of the tested person."""

    def estimated(people: LoadPeople) -> StateScore:
        seen = people.features[:, :, columns]
        probable = np.empty((*people.classes.shape, 3))
        for family in np.unique(people.family):
            others = people.family != family
            model = train_load(seen[others], people.classes[others])
            for i in np.flatnonzero(~others):
                lda = build(model)
                for t, label in enumerate(people.classes[i].tolist()):
                    probable[i, t] = lda.probabilities(seen[i, t])
                    lda.learn(seen[i, t], label if asked else None)
        return _scored(probable, people.classes)

    return estimated


def _scored(probable: F8, classes: I8) -> StateScore:
    right = (probable.argmax(axis=2) == classes).astype(float)
    return StateScore(right.mean(axis=1), _calibration(probable.max(axis=2).ravel(), right.ravel()))


def _calibration(stated: F8, right: F8, bins: int = 8) -> float:
    """Return the expected calibration error: mean difference of probability and share right, weighted by frequency."""
    places = np.clip(((stated - 1.0 / 3.0) * 1.5 * bins).astype(int), 0, bins - 1)
    inside = [places == k for k in range(bins)]
    return sum(abs(float(np.sum(stated[each] - right[each]))) for each in inside) / len(stated)


def _by_threshold(people: LoadPeople) -> StateScore:
    """Classify by two thresholds of the heart rate between the class means of the person's first three trials."""
    hits = []
    for heart, classes in zip(np.nan_to_num(people.features[:, :, 0]), people.classes, strict=True):
        means = [heart[:3][classes[:3] == k].mean() for k in range(3)]
        low, high = (means[0] + means[1]) / 2.0, (means[1] + means[2]) / 2.0
        estimated = np.where(heart[3:] < low, 0, np.where(heart[3:] > high, 2, 1))
        hits.append(float(np.mean(estimated == classes[3:])))
    return StateScore(np.array(hits))


def _majority(people: LoadPeople) -> StateScore:
    most = int(np.bincount(people.classes.ravel()).argmax())
    return StateScore((people.classes == most).mean(axis=1))


_ALL, _BODY, _SUCCESS = slice(None), slice(0, -1), slice(-1, None)

RIVALS: dict[str, Callable[[LoadPeople], StateScore]] = {
    "adaptive": _follow(AdaptiveLda, _ALL, asked=True),
    "adaptive, not asked": _follow(AdaptiveLda, _ALL, asked=False),
    "fixed": _follow(Lda, _ALL, asked=False),
    "fusion": lambda people: _scored(people.fusion, people.classes),
    "adaptive, body alone": _follow(AdaptiveLda, _BODY, asked=True),
    "fixed, body alone": _follow(Lda, _BODY, asked=False),
    "adaptive, success alone": _follow(AdaptiveLda, _SUCCESS, asked=True),
    "success alone": _follow(Lda, _SUCCESS, asked=False),
    "threshold per person": _by_threshold,
    "majority": _majority,
}
"""Studies by name: estimators of the product, then baselines."""


def state_study(people: LoadPeople) -> dict[str, StateScore]:
    """Return the score of each rival."""
    return {name: estimated(people) for name, estimated in RIVALS.items()}
