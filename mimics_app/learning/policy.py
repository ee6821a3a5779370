"""Protocol of a policy: it chooses the demand of the task, for any number of people, and learns from outcomes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

__all__ = ["LEVELS", "Choice", "Floats", "Outcome", "Policy", "logit"]

Floats = NDArray[np.float64]

LEVELS = np.linspace(0.0, 1.0, 11)
"""Demands among which policies with discrete choices choose."""


@dataclass(frozen=True, slots=True)
class Choice:
    """Chosen demands, 0 easiest to 1 hardest, and their propensities; both of shape [n]."""

    demand: Floats
    propensity: Floats


@dataclass(frozen=True, slots=True)
class Outcome:
    """Outcome of a trial of each person, all of shape [n]; NaN where unknown.

    Attributes:
        demand: Actual demand of the trial, whatever was chosen.
        performance: 0 to 1.
        load: Probability of being over-challenged less that of being under-challenged, from body signals.
        load_variance: Variance of the load.
        reward: Reward by the goal.
    """

    demand: Floats
    performance: Floats
    load: Floats
    load_variance: Floats
    reward: Floats


class Policy(Protocol):
    """A policy."""

    def begin(self, start: Floats, rng: np.random.Generator) -> None:
        """A session of people [n] begins at these demands [n]."""
        ...

    def act(self) -> Choice:
        """Return the demands of the next trial."""
        ...

    def learn(self, outcome: Outcome) -> None:
        """Learn from a trial."""
        ...


def logit(share: Floats, least: float = 0.05) -> Floats:
    """Return ln(p / (1 - p)) of shares limited to [least, 1 - least]."""
    p = np.clip(share, least, 1.0 - least)
    result: Floats = np.log(p / (1.0 - p))
    return result
