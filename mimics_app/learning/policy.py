"""What a policy is: it chooses how hard the task is to be, for any number of people, and learns from outcomes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

__all__ = ["LEVELS", "Choice", "Floats", "Outcome", "Policy", "logit"]

Floats = NDArray[np.float64]

LEVELS = np.linspace(0.0, 1.0, 11)
"""Demands among which policies choose that know no others."""


@dataclass(frozen=True, slots=True)
class Choice:
    """Demands, 0 easiest to 1 hardest, and with which probability each was chosen; both of shape [n]."""

    demand: Floats
    propensity: Floats


@dataclass(frozen=True, slots=True)
class Outcome:
    """What a trial of each person came to, all of shape [n]; NaN where it is not known.

    Attributes:
        demand: Of the trial as it was, whatever was chosen.
        performance: 0 to 1.
        load: Probability of being over-challenged less that of being under-challenged, from body signals.
        load_variance: Of that.
        reward: What the goal finds it worth.
    """

    demand: Floats
    performance: Floats
    load: Floats
    load_variance: Floats
    reward: Floats


class Policy(Protocol):
    """A method to choose."""

    def begin(self, start: Floats, rng: np.random.Generator) -> None:
        """A session of people [n] begins at these demands [n]."""
        ...

    def act(self) -> Choice:
        """The demands of the next trial."""
        ...

    def learn(self, outcome: Outcome) -> None:
        """A trial is over."""
        ...


def logit(share: Floats, least: float = 0.05) -> Floats:
    """ln(p / (1 - p)) of shares kept `least` away from 0 and 1."""
    p = np.clip(share, least, 1.0 - least)
    result: Floats = np.log(p / (1.0 - p))
    return result
