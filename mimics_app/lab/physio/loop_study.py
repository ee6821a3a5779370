"""The whole loop on simulated people: raw signals, features, the default estimator, and a policy.

A trial takes a minute and a half; a policy gets the load estimated at its end. The regret is relative to the best
demand, which the policy does not know. Simulation is not clinical evidence.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.messages.stage_messages import TrialResult, UserState
from mimics_app.contracts.ports.stages import Estimation
from mimics_app.estimation.registry import DEFAULT, build_estimation
from mimics_app.inputs.physio.simulated.kinds import KINDS, Kind
from mimics_app.lab.physio.simulated_task import POWER_W, REST_S, TRIAL_S, SignalSession, draw_success, regret_of
from mimics_app.learning.goals import success_reward
from mimics_app.learning.policy import Outcome, Policy
from mimics_app.learning.registry import POLICIES

__all__ = ["PEOPLE", "SEEDS", "TRIALS", "LoopScore", "loop_study", "pooled"]


PEOPLE, TRIALS = 20, 14
"""Numbers of people of a group, and of trials of each."""
SEEDS = (1, 2, 3)
"""Seeds of the groups of people: the ratio of two policies differs by a fifth between groups (decision 125)."""

_BASELINE_S = 60.0
"""Length of the estimator's calibration [s]."""


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
    """Let a policy adapt the task of people of every kind.

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
                _Person(rng, KINDS[k % len(KINDS)], silent=silent, blind=blind).play(
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

    def __init__(self, rng: np.random.Generator, kind: Kind, *, silent: bool, blind: bool) -> None:
        who, self._success_rng, body, self._choice_rng, self._blind_rng = rng.spawn(5)
        self._latent, self._blind = kind.people(who), blind
        while silent and self._latent.traits.more_responses[0] > 0.0:
            self._latent = kind.people(who)
        self._success, self._session = draw_success(who, 1), SignalSession(self._latent, kind.signals(body))

    def play(self, policy: Policy, trials: int, *, sees: bool) -> F8:
        """Return the regret of each trial, shape [trials]; `sees`: signals are simulated and the load is estimated."""
        estimation = build_estimation(DEFAULT, _BASELINE_S) if sees else None
        policy.begin(np.full(1, 0.5), self._choice_rng)
        self._live(REST_S, np.nan, 0.0, estimation)
        regret = np.empty(trials)
        for t in range(trials):
            demand = np.clip(policy.act().demand, 0.0, 1.0)
            gap = self._latent.gap(demand)
            regret[t] = regret_of(gap)[0]
            self._live(TRIAL_S, self._blind_rng.uniform() if self._blind else float(demand[0]), POWER_W, estimation)
            share = float(self._success.share(gap, self._success_rng)[0])
            state = UserState(-1) if estimation is None else self._state_after(estimation, share)
            policy.learn(Outcome.of_one(float(demand[0]), share, state, float(success_reward(share))))
        return regret

    def _live(self, seconds: int, demand: float, power: float, estimation: Estimation | None) -> None:
        if estimation is not None:
            for frame in self._session.live(seconds, demand, power):
                estimation.update(frame)
            return
        for _ in range(seconds):
            self._latent.step(1.0, np.array([demand]), np.array([power]), np.isfinite([demand]).astype(float))

    def _state_after(self, estimation: Estimation, share: float) -> UserState:
        return estimation.update_from_result(TrialResult(0, self._session.now_ns + 1, "finished", share, share, False))
