"""The task of the studies: simulated people under a demand, with their success, their regret and their body signals.

A trial of a study asks the same of every policy: a demand, whose distance from the best one decides the success in ten
repetitions, the regret, and what the body does. Simulation is not clinical evidence.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.clock import SECOND_NS
from mimics_app.contracts.messages.stage_messages import FeatureFrame, SignalBlock
from mimics_app.dsp.stage import PhysioDsp
from mimics_app.inputs.physio.simulated.person import LatentPeople
from mimics_app.inputs.physio.simulated.signals import SignalGenerator

__all__ = [
    "POWER_W",
    "REST_S",
    "TRIAL_S",
    "SignalSession",
    "Success",
    "draw_slope",
    "draw_success",
    "regret_of",
]


REST_S, TRIAL_S = 90, 90
"""Lengths of rest and trial where body signals are simulated [s]: longer than the windows of the features."""
POWER_W = 0.2
"""Mechanical power of a slow arm against a small resistance [W]."""
_EASE = (0.085, 0.03)
"""Mean and standard deviation of the demand of 50 % success above the best demand. The mean one, with a slope of 10,
gives 70 % success at the best demand."""
_SLOPES = (8.0, 16.0)
"""Range of the slope of success over demand [logit per unit]."""
_REPETITIONS = 10
"""Repetitions of a trial."""
_BAND = 0.15
"""Deviation of the demand from the best one at which the benefit of a trial is 1/e."""


@dataclass(frozen=True, slots=True)
class Success:
    """Success of people by the demand.

    Attributes:
        slope: Slope of success over demand [logit per unit], shape [n].
        ease: Demand of 50 % success above the best demand, shape [n].
    """

    slope: F8
    ease: F8

    def share(self, gap: F8, rng: np.random.Generator) -> F8:
        """Return the share of successful repetitions at a demand `gap` above the best one, shape [n]."""
        repeated = rng.binomial(_REPETITIONS, 1.0 / (1.0 + np.exp(self.slope * (gap - self.ease))))
        return np.asarray(repeated / _REPETITIONS)


def draw_slope(rng: np.random.Generator, n: int) -> F8:
    """Return the slopes of success over demand of n people [logit per unit]."""
    return rng.uniform(*_SLOPES, n)


def draw_success(rng: np.random.Generator, n: int) -> Success:
    """Draw the success of n people."""
    return Success(draw_slope(rng, n), rng.normal(*_EASE, n))


def regret_of(gap: F8) -> F8:
    """Return 1 less the benefit of trials at a demand `gap` above the best one."""
    return np.asarray(1.0 - np.exp(-((gap / _BAND) ** 2)))


class SignalSession:
    """Session of one person from raw signals to features, second by second.

    Args:
        people: The person.
        generator: Their signals.
    """

    def __init__(self, people: LatentPeople, generator: SignalGenerator) -> None:
        self._people, self._generator = people, generator
        self._dsp, self._second = PhysioDsp(), 0

    @property
    def now_ns(self) -> int:
        """Time since the session's start [ns]."""
        return self._second * SECOND_NS

    def live(self, seconds: int, demand: float, power: float) -> Iterator[FeatureFrame]:
        """Yield the features of each second under a demand (NaN: rest) and a mechanical power [W]."""
        acting = np.array([float(np.isfinite(demand))])
        for _ in range(seconds):
            self._people.step(1.0, np.array([demand]), np.array([power]), acting)
            made = self._generator.second(self._people.drive(np.zeros(1)))
            blocks = [SignalBlock(name, 1000.0, self.now_ns, v) for name, v in made.items() if name != "emg"]
            blocks.append(SignalBlock("power", 1.0, self.now_ns, np.array([power])))
            self._second += 1
            yield self._dsp.process(blocks, self.now_ns)
