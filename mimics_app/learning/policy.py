"""Protocol of a policy: it chooses the demand of the task, for any number of people, and learns from outcomes."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.messages.stage_messages import UserState

__all__ = ["CONTROL", "LEVELS", "REWARDS", "TARGET", "Choice", "Outcome", "Policy", "logit"]

LEVELS = np.linspace(0.0, 1.0, 11)
"""Demands among which policies with discrete choices choose."""
TARGET = 0.7
"""Share of success that counts as a challenge: Metzger et al., JNER 11:154, 2014."""

REWARDS = ("success", "task", "arousal", "valence", "effort")
"""Goals of a policy that learns from rewards, whatever they are for."""
CONTROL = ("success", "task")
"""Goals beside which a control is run, which follows none."""


@dataclass(frozen=True, slots=True)
class Choice:
    """Chosen demands, 0 easiest to 1 hardest, and their propensities; both of shape [n]."""

    demand: F8
    propensity: F8


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

    demand: F8
    performance: F8
    load: F8
    load_variance: F8
    reward: F8

    @staticmethod
    def of_one(demand: float, performance: float, state: UserState, reward: float) -> Outcome:
        """Return the outcome for one person, whose load is known where both load and arousal are."""
        load, variance = np.nan, np.nan
        if state.load is not None and state.arousal is not None:
            load, variance = state.load[2] - state.load[0], state.arousal.variance
        return Outcome(*(np.array([value]) for value in (demand, performance, load, variance, reward)))


class Policy(Protocol):
    """A policy.

    Attributes:
        follows: Goals that it can follow: names of `learning.goals` ("arousal"), or a goal with its numbers
            ("success:0.7"). A run with another goal is refused. Controls, which follow none, name those beside which
            they are run.
        explores: True: beside it, neutral parameters are explored by their rewards. A policy may be without it.
    """

    @property
    def follows(self) -> Collection[str]:
        """Goals that it can follow."""
        ...

    def begin(self, start: F8, rng: np.random.Generator) -> None:
        """A session of people [n] begins at these demands [n]."""
        ...

    def act(self) -> Choice:
        """Return the demands of the next trial."""
        ...

    def learn(self, outcome: Outcome) -> None:
        """Learn from a trial."""
        ...


def logit(share: F8) -> F8:
    """Return ln(p / (1 - p)) of shares limited to [0.05, 0.95]."""
    p = np.clip(share, 0.05, 0.95)
    result: F8 = np.log(p / (1.0 - p))
    return result
