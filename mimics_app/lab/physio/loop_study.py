"""The whole loop on simulated people: raw signals, features, the default estimator, and a policy.

A trial takes a minute and a half; a policy gets the load estimated at its end. The regret is relative to the best
demand, which the policy does not know. Simulation is no clinical evidence.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.clock import SECOND_NS
from mimics_app.contracts.messages import SignalBlock, TrialResult, UserState
from mimics_app.contracts.stages import Estimation
from mimics_app.dsp.stage import PhysioDsp
from mimics_app.estimation.registry import DEFAULT, build_estimation
from mimics_app.inputs.physio.simulated.person import FAMILIES, Family, LatentPeople, draw_traits
from mimics_app.inputs.physio.simulated.signals import SignalGenerator
from mimics_app.learning.policy import Outcome, Policy
from mimics_app.learning.registry import POLICIES

__all__ = ["PEOPLE", "SEEDS", "TRIALS", "LoopScore", "loop_study", "pooled"]


PEOPLE, TRIALS = 20, 14
"""Numbers of people of a group, and of trials of each."""
SEEDS = (1, 2, 3)
"""Seeds of the groups of people: the ratio of two policies differs by a fifth between groups (decision 166)."""

_REST_S, _TRIAL_S, _BASELINE_S = 90, 90, 60.0
_POWER_W = 0.2
"""Mechanical power of a slow arm against a small resistance [W]."""
_BAND = 0.15
"""Deviation of the demand from the best one at which the benefit of a trial is 1/e."""
_REPETITIONS = 10
_SLOPES = (8.0, 16.0)
"""Range of the slope of success over demand [logit per unit]."""
_EASE = (0.085, 0.03)
"""Mean and standard deviation of the demand of 50 % success above the best demand."""


@dataclass(frozen=True, slots=True)
class LoopScore:
    """Score of one policy.

    Attributes:
        regret: 1 less the benefit, by person and trial, shape [n, trials].
    """

    regret: F8

    @property
    def mean(self) -> float:
        """Mean regret of a trial."""
        return float(self.regret.mean())

    @property
    def half_width(self) -> float:
        """Half width of the 95 % interval of the mean over people."""
        each = self.regret.mean(axis=1)
        return float(1.96 * each.std(ddof=1) / np.sqrt(len(each)))


def loop_study(
    policy: str, n: int = PEOPLE, trials: int = TRIALS, seed: int = 1, *, silent: bool = False, blind: bool = False
) -> LoopScore:
    """Let a policy adapt the task of people of every family.

    Args:
        policy: Name in `POLICIES`; signals are simulated only for the one that uses the load.
        n: Number of people.
        trials: Number of trials of each.
        seed: Seed of the simulation; the people are the same for every policy.
        silent: Only people whose skin does not respond.
        blind: Their bodies respond to a random quantity instead of the demand, as a control.
    """
    streams = np.random.default_rng([seed, 166]).spawn(n)
    sees = policy == "kalman"
    return LoopScore(
        np.array(
            [
                _Person(rng, FAMILIES[k % len(FAMILIES)], silent=silent, blind=blind).play(
                    POLICIES[policy](), trials, sees=sees
                )
                for k, rng in enumerate(streams)
            ]
        )
    )


def pooled(scores: Sequence[LoopScore]) -> LoopScore:
    """Return the score of several groups of people together."""
    return LoopScore(np.concatenate([score.regret for score in scores]))


class _Person:
    """Session of one person."""

    def __init__(self, rng: np.random.Generator, family: Family, *, silent: bool, blind: bool) -> None:
        who, self._chance, self._body, self._choice, self._felt = rng.spawn(5)
        traits = draw_traits(who, 1, family)
        while silent and traits.more_responses[0] > 0.0:
            traits = draw_traits(who, 1, family)
        self._latent, self._blind = LatentPeople(traits, family), blind
        self._slope, self._ease = who.uniform(*_SLOPES), who.normal(*_EASE)
        self._generator, self._dsp, self._second = SignalGenerator(self._body), PhysioDsp(), 0

    def play(self, policy: Policy, trials: int, *, sees: bool) -> F8:
        """Return the regret of each trial, shape [trials]; `sees`: signals are simulated and the load is estimated."""
        estimation = build_estimation(DEFAULT, _BASELINE_S) if sees else None
        policy.begin(np.full(1, 0.5), self._choice)
        self._live(_REST_S, np.nan, 0.0, estimation)
        regret = np.empty(trials)
        for t in range(trials):
            demand = float(np.clip(policy.act().demand, 0.0, 1.0)[0])
            gap = demand - float(self._latent.skill[0] - 0.2 * self._latent.fatigue[0])
            regret[t] = 1.0 - np.exp(-((gap / _BAND) ** 2))
            self._live(_TRIAL_S, self._felt.uniform() if self._blind else demand, _POWER_W, estimation)
            share = self._chance.binomial(_REPETITIONS, 1.0 / (1.0 + np.exp(self._slope * (gap - self._ease)))) / 10.0
            load = None if estimation is None else self._judge(estimation, share)
            policy.learn(_outcome(demand, share, load))
        return regret

    def _live(self, seconds: int, felt: float, power: float, estimation: Estimation | None) -> None:
        for _ in range(seconds):
            acting = np.array([float(np.isfinite(felt))])
            self._latent.step(1.0, np.array([felt]), np.array([power]), acting)
            self._second += 1
            if estimation is None:
                continue
            made = self._generator.second(self._latent.drive(np.zeros(1))) | {"power": np.array([power])}
            t_ns, rates = (self._second - 1) * SECOND_NS, {"power": 1.0}
            blocks = [SignalBlock(k, rates.get(k, 1000.0), t_ns, v) for k, v in made.items() if k != "emg"]
            estimation.update(self._dsp.process(blocks, self._second * SECOND_NS))

    def _judge(self, estimation: Estimation, share: float) -> UserState:
        return estimation.judge(TrialResult(0, self._second * SECOND_NS + 1, "finished", share, share, False))


def _outcome(demand: float, share: float, state: UserState | None) -> Outcome:
    """Return the outcome of a trial for the policy, as `Agent` does."""
    load, spread = np.nan, np.nan
    if state is not None and state.load is not None and state.arousal is not None:
        load, spread = state.load[2] - state.load[0], state.arousal.variance
    worth = max(1.0 - abs(share - 0.7) / 0.3, -1.0)
    values = (demand, share, load, spread, worth)
    return Outcome(*(np.array([value]) for value in values))
