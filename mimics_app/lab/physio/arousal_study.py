"""How often the stated interval of arousal holds the truth, over simulated people of every kind, from raw signals.

Each rests, then plays through five stretches that are too hard, right or too easy. Simulation is no clinical evidence.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.estimation.fusion import FusionEstimation
from mimics_app.inputs.physio.simulated.kinds import KINDS, Kind
from mimics_app.lab.physio.simulated_task import POWER_W, REST_S, SignalSession

__all__ = ["ArousalScore", "arousal_study"]

_BASELINE_S = 60.0
"""Length of the calibration [s]."""
_GAPS, _STRETCH_S = (0.3, 0.0, -0.3, 0.15, 0.3), 66
"""Deviation of the demand from the best one in each stretch, and its length [s]: the features look back a minute."""
_Z = 1.96
"""Standard deviations of the half width of a 95 % interval."""


@dataclass(frozen=True, slots=True)
class ArousalScore:
    """Score of the estimated arousal of one person.

    Attributes:
        heart: Response of the person's heart, which names the kind.
        covered: Share of the seconds in which the truth lies in the stated 95 % interval.
        deviation: Mean stated standard deviation.
        correlation: Of estimate and truth over the session.
    """

    heart: str
    covered: float
    deviation: float
    correlation: float


def arousal_study(people: Sequence[int]) -> list[ArousalScore]:
    """Return the scores of simulated people.

    Args:
        people: Seed of each; the kind follows from it in turn.
    """
    return [_score(KINDS[seed % len(KINDS)], np.random.default_rng([seed, 292])) for seed in people]


def _score(kind: Kind, rng: np.random.Generator) -> ArousalScore:
    mean, variance, truth = _play(kind, rng).T
    covered = np.abs(mean - truth) < _Z * np.sqrt(variance)
    agrees = float(np.corrcoef(mean, truth)[0, 1])
    return ArousalScore(kind.heart, float(covered.mean()), float(np.sqrt(variance).mean()), agrees)


def _play(kind: Kind, rng: np.random.Generator) -> F8:
    """Return mean, variance and true arousal of each second in which arousal is known, shape [s, 3]."""
    who, body = rng.spawn(2)
    people, rows = kind.people(who), []
    session, estimation = SignalSession(people, kind.signals(body)), FusionEstimation(_BASELINE_S)
    for second in range(REST_S + len(_GAPS) * _STRETCH_S):
        playing = second >= REST_S
        gap = _GAPS[(second - REST_S) // _STRETCH_S] if playing else np.nan
        for frame in session.live(1, float(people.best[0]) + gap, POWER_W if playing else 0.0):
            arousal = estimation.update(frame).arousal
            if arousal is not None:
                rows.append((arousal.mean, arousal.variance, float(people.arousal[0])))
    return np.array(rows)
