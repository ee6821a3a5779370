"""Off-policy evaluation: the reward of a policy from the log of another one that recorded its propensities."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mimics_app.contracts.arrays import F8

__all__ = ["Evaluation", "evaluate"]

_LARGEST_WEIGHT = 20.0
"""Upper limit of an importance weight: some bias for a smaller variance."""


@dataclass(frozen=True, slots=True)
class Evaluation:
    """Evaluation of a policy on a log.

    Attributes:
        mean: Self-normalised inverse propensity estimate of its reward.
        low, high: 95 % confidence interval of the mean.
        effective: Effective sample size of the log for this policy.
    """

    mean: float
    low: float
    high: float
    effective: float


def evaluate(reward: F8, propensity: F8, wanted: F8) -> Evaluation:
    """Evaluate a policy by weighting each reward with the ratio of the propensities.

    Args:
        reward: Reward of each choice, shape [n].
        propensity: Propensity of the choice under the logging policy, shape [n].
        wanted: Propensity of the same choice under the policy to be evaluated, shape [n].

    Raises:
        ValueError: A propensity is not above 0, or the log is empty.
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
