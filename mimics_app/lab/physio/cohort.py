"""Policies on cohorts of simulated people; regret against the best demand, which the policies do not know.

A policy gets the same data as in a session: success in ten repetitions, and a load from heart rate and skin conductance
with noise and drift, which in some people do not respond. Simulation is not clinical evidence.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import F8
from mimics_app.estimation.fusion import load_of
from mimics_app.inputs.physio.simulated.person import Family, LatentPeople, draw_traits
from mimics_app.lab.physio.simulated_task import draw_success, regret_of
from mimics_app.learning.goals import success_reward
from mimics_app.learning.policy import Outcome, Policy

__all__ = ["CohortResult", "play_cohort"]


_TRIAL_S = 20.0
_STEP_S = 5.0
"""Length of a trial, and step of the latent state [s]."""
_POWER_W = 0.3
"""Mechanical power of the arm [W]."""
_HEART_NOISE, _SKIN_NOISE = 2.5, 1.5
"""Noise of a trial's mean [1/min, 1/min]."""
_DRIFT = 0.05
"""Standard deviation of the linear drift of both [1/min per trial]."""
_AROUSAL_VARIANCE = 0.15
"""Variance of the arousal of a trial, as given to the policy."""


@dataclass(frozen=True, slots=True)
class CohortResult:
    """Result of one policy.

    Attributes:
        regret: 1 less the benefit, by trial and person, shape [trials, n].
        demand: Chosen demand, shape [trials, n].
        responds: Whether a person's skin responds to arousal, shape [n].
    """

    regret: F8
    demand: F8
    responds: NDArray[np.bool_]

    @property
    def mean(self) -> float:
        """Mean regret of a trial."""
        return float(self.regret.mean())

    def reversals(self, last: int = 10) -> float:
        """Return the number of changes of direction of the demand in the last trials, per person."""
        moves = np.sign(np.round(np.diff(self.demand[-last - 1 :], axis=0), 3))
        return float((moves[1:] * moves[:-1] < 0.0).sum(axis=0).mean())


def play_cohort(
    build: Callable[[], Policy],
    n: int = 500,
    trials: int = 40,
    seed: int = 1,
    family: Family = "linear",
    *,
    blind: bool = False,
) -> CohortResult:
    """Let a policy adapt the task of n people.

    Args:
        build: Builds the policy.
        n: Number of people.
        trials: Number of trials of each.
        seed: Seed of people, trials and policy.
        family: Family of the people.
        blind: Their bodies respond to a random quantity instead of the demand, as a control.
    """
    people_rng, noise, choice_rng = np.random.default_rng([seed, 160]).spawn(3)
    traits = draw_traits(people_rng, n, family)
    people, policy = LatentPeople(traits, family), build()
    success = draw_success(people_rng, n)
    drift = people_rng.normal(0.0, _DRIFT, (2, n))
    policy.begin(np.full(n, 0.5), choice_rng)
    regret, demands = np.empty((trials, n)), np.empty((trials, n))
    for t in range(trials):
        demand = np.clip(policy.act().demand, 0.0, 1.0)
        gap = people.gap(demand)
        regret[t], demands[t] = regret_of(gap), demand
        shown = noise.uniform(0.0, 1.0, n) if blind else demand
        for _ in range(round(_TRIAL_S / _STEP_S)):
            people.step(_STEP_S, shown, np.full(n, _POWER_W), np.ones(n))
        share = success.share(gap, noise)
        arousal = _read(people, noise, drift, t)
        load = np.array([sum(np.array(load_of(mean, _AROUSAL_VARIANCE)) * (-1.0, 0.0, 1.0)) for mean in arousal])
        policy.learn(Outcome(demand, share, load, np.full(n, _AROUSAL_VARIANCE), success_reward(share)))
    return CohortResult(regret, demands, traits.more_responses > 0.0)


def _read(people: LatentPeople, noise: np.random.Generator, drift: F8, t: int) -> F8:
    """Return the arousal that heart and skin indicate relative to rest, shape [n]."""
    traits, n = people.traits, len(people.skill)
    drive = people.drive(np.zeros(n))
    heart = drive.heart_rate - traits.heart_rest - traits.heart_effort * people.effort
    heart += drift[0] * t + _HEART_NOISE * noise.standard_normal(n)
    skin = drive.responses - traits.responses + drift[1] * t + _SKIN_NOISE * noise.standard_normal(n)
    views = np.clip([heart / 10.0, skin / 7.0], -1.2, 1.2)
    result: F8 = 0.8 * views.mean(axis=0)
    return result
