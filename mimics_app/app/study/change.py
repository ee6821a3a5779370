"""Means with intervals: of one sample, of a change against a baseline, and of paired differences.

Intervals are of Student's t: for two samples of unequal variance with the degrees of freedom of B. L. Welch, "The
generalization of 'Student's' problem when several different population variances are involved", Biometrika 34 (1947)
28-35.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from statistics import fmean, variance

__all__ = ["CONFIDENCE", "Interval", "change_of", "mean_of", "paired_difference"]

CONFIDENCE = 0.95
"""Share of repetitions in which an interval holds the value it estimates."""


@dataclass(frozen=True, slots=True)
class Interval:
    """A mean with its interval.

    Attributes:
        mean: The mean.
        low, high: The interval; None where too few values give none.
        n: Number of values, or of pairs.
    """

    mean: float
    low: float | None
    high: float | None
    n: int


def mean_of(values: Sequence[float]) -> Interval:
    """Return the mean of values, at least one, with its interval."""
    n = len(values)
    if n < 2:
        return Interval(fmean(values), None, None, n)
    return _around(fmean(values), math.sqrt(variance(values) / n), n - 1, n)


def paired_difference(pairs: Sequence[tuple[float, float]]) -> Interval:
    """Return the mean of second less first, of at least one pair, with its interval."""
    return mean_of([second - first for first, second in pairs])


def change_of(baseline: Sequence[float], values: Sequence[float]) -> Interval:
    """Return the mean of values less that of a baseline, each of at least one value, with its interval by Welch."""
    mean, n = fmean(values) - fmean(baseline), len(values)
    if min(len(baseline), n) < 2:
        return Interval(mean, None, None, n)
    parts = [variance(sample) / len(sample) for sample in (baseline, values)]
    if sum(parts) == 0.0:
        return Interval(mean, mean, mean, n)
    below = sum(part**2 / (len(sample) - 1) for part, sample in zip(parts, (baseline, values), strict=True))
    return _around(mean, math.sqrt(sum(parts)), sum(parts) ** 2 / below, n)


def _around(mean: float, error: float, freedom: float, n: int) -> Interval:
    from scipy.special import stdtrit

    half = float(stdtrit(freedom, 0.5 + CONFIDENCE / 2)) * error
    return Interval(mean, mean - half, mean + half, n)
