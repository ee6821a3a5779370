"""Sessions of simulated people for the study of the load: a rest, then trials that are too easy, right or too hard.

Raw signals pass the processing and calibration of a session. The success at the right demand differs between people:
proposals reach from 0.5 (Atkinson, Psychol Rev 64, 1957) over 0.7 (Metzger et al., JNER 11:154, 2014) to 0.85 (Wilson
et al., Nat Commun 10:4646, 2019). No clinical evidence.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.estimation.fusion import FusionEstimation
from mimics_app.estimation.load_people import LoadPeople
from mimics_app.estimation.trial_view import TrialView
from mimics_app.inputs.physio.simulated.kinds import KINDS, Kind
from mimics_app.lab.physio.simulated_task import POWER_W, REST_S, TRIAL_S, SignalSession, Success, draw_slope
from mimics_app.learning.policy import logit

__all__ = ["SHIPPED_GAP", "draw_load_people", "write_shipped_people"]


SHIPPED_GAP = 0.15
"""Deviation of the demand in a wrong trial of the shipped people: a fixed discriminant is right in nine of ten."""

_ROUNDS = 4
"""Number of rounds of three trials."""
_BASELINE_S = 60.0
"""Length of the calibration [s]."""
_RIGHT = (0.5, 0.9)
"""Range of the success at the right demand."""
_LOAD_S = 30
"""Averaging time of the load by the fusion [s]."""


def draw_load_people(each: int, gap: float, seed: int = 1) -> LoadPeople:
    """Simulate the sessions.

    Args:
        each: Number of people of each kind.
        gap: Deviation of the demand in a trial that is too easy or too hard; small ones are hard to estimate.
        seed: Seed of the simulation.
    """
    places = np.repeat(np.arange(len(KINDS)), each)
    streams = np.random.default_rng([seed, 164]).spawn(len(places))
    played = [_play(rng, KINDS[k], gap) for rng, k in zip(streams, places.tolist(), strict=True)]
    features, classes, fusion = (np.array([one[i] for one in played]) for i in range(3))
    return LoadPeople(places, features, classes.astype(np.int64), fusion)


def write_shipped_people(path: Path) -> None:
    """Simulate and write the people on whom the product's discriminants are trained (assets/load_people.json).

    Raises:
        OSError: The file cannot be written.
    """
    each, gap, seed = 8, SHIPPED_GAP, 1
    what = f"simulated people, {each} of each kind, demand {gap:g} off in a wrong trial, seed {seed}"
    draw_load_people(each, gap, seed).write(path, f"{what}: mimics bench physio --people FILE")


class _Session:
    """Session of one person."""

    def __init__(self, rng: np.random.Generator, kind: Kind) -> None:
        self.people = kind.people(rng)
        self._signals = SignalSession(self.people, kind.signals(rng))
        self._fusion = FusionEstimation(_BASELINE_S)

    def live(self, seconds: int, demand: float, power: float) -> tuple[TrialView, F8]:
        """Advance in time; return the features and the mean load by the fusion at its end."""
        view, loads = TrialView(), []
        for frame in self._signals.live(seconds, demand, power):
            state = self._fusion.update(frame)
            view.see(self._fusion.seen)
            loads.append((1.0 / 3.0,) * 3 if state.load is None else state.load)
        return view, np.mean(loads[-_LOAD_S:], axis=0)


def _play(rng: np.random.Generator, kind: Kind, gap: float) -> tuple[F8, F8, F8]:
    """Simulate a person; return features [t, f], classes [t] and probabilities by the fusion [t, 3] of the trials."""
    session = _Session(rng, kind)
    slope, right = draw_slope(rng, 1), rng.uniform(*_RIGHT)
    success = Success(slope, logit(np.array(right)) / slope)
    order = np.concatenate([rng.permutation(3) for _ in range(_ROUNDS)])
    session.live(REST_S, np.nan, 0.0)
    rows, loads = [], []
    for label in order.tolist():
        off = gap * (label - 1)
        view, load = session.live(TRIAL_S, float(session.people.best[0]) + off, POWER_W)
        rows.append(view.features(float(success.share(np.full(1, off), rng)[0])))
        loads.append(load)
    return np.array(rows), order, np.array(loads)
