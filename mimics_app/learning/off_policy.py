"""What another policy would have been worth, from the log of one that says how likely each of its choices was."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mimics_app.learning.policy import Floats

__all__ = ["Evaluation", "evaluate"]

_LARGEST_WEIGHT = 20.0
"""Weights beyond this are cut: a biased answer that is still good for something."""


@dataclass(frozen=True, slots=True)
class Evaluation:
    """Of a policy by a log.

    Attributes:
        mean: Self-normalised inverse propensity estimate of its reward.
        low, high: 95 % interval of it.
        effective: How many independent choices the log is worth for it.
    """

    mean: float
    low: float
    high: float
    effective: float


def evaluate(reward: Floats, propensity: Floats, wanted: Floats) -> Evaluation:
    """Weigh each reward by how much likelier the other policy would have made that choice.

    Args:
        reward: Of each choice, shape [n].
        propensity: With which the logging policy made it, shape [n].
        wanted: With which the policy to be judged would have made the same choice, shape [n].

    Raises:
        ValueError: A propensity is not above 0, or nothing was logged.
    """
    if not len(reward) or not (np.asarray(propensity) > 0.0).all():
        raise ValueError("a log needs choices, each with a propensity above 0")
    weight = np.minimum(wanted / propensity, _LARGEST_WEIGHT)
    total = float(weight.sum())
    if total <= 0.0:
        return Evaluation(float("nan"), float("-inf"), float("inf"), 0.0)
    mean = float((weight * reward).sum() / total)
    deviation = float(np.sqrt(((weight * (reward - mean)) ** 2).sum())) / total
    return Evaluation(mean, mean - 1.96 * deviation, mean + 1.96 * deviation, total**2 / float((weight**2).sum()))
