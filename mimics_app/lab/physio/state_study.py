"""Three classes of load from raw signals: trained on one family of simulated people, tested on people of others.

A session is a rest, then trials of 45 s that are too easy, right or too hard, in shuffled order. Signals go through the
very processing a session uses. After each trial the person is asked, which is all that the adaptive discriminant learns
from. No clinical evidence.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.messages import SignalBlock
from mimics_app.dsp.stage import PhysioDsp
from mimics_app.estimation.baseline import Baseline
from mimics_app.estimation.load import AdaptiveLda, Lda, train_lda
from mimics_app.inputs.physio.simulated.person import FAMILIES, Family, LatentPeople, draw_traits
from mimics_app.inputs.physio.simulated.signals import SignalGenerator

__all__ = ["FEATURES", "StateScore", "state_study"]

Floats = NDArray[np.float64]

FEATURES = ("heart_rate", "scr_rate", "scl", "rmssd", "breath_rate")
_REST_S, _TRIAL_S, _ROUNDS = 75, 45, 4
_RIVALS = ("fixed", "adaptive", "body_fixed", "body_adaptive", "performance", "threshold")
_SUCCESS_SLOPE, _SUCCESS_EASE = 12.0, 0.085


@dataclass(frozen=True, slots=True)
class StateScore:
    """Shares of trials that were told right, on people of unseen families.

    Attributes:
        fixed, adaptive: Of the discriminants over body signals and success.
        body_fixed, body_adaptive: Of those over body signals alone.
        performance: Of a discriminant over success alone.
        majority: Of the most frequent class.
        threshold: Of two borders of the heart rate over rest, set for each person from their first round.
        calibration: Expected calibration error of the adaptive one.
    """

    fixed: float
    adaptive: float
    body_fixed: float
    body_adaptive: float
    performance: float
    majority: float
    threshold: float
    calibration: float


def state_study(people: int = 10, gap: float = 0.18, seed: int = 1) -> StateScore:
    """Train on `people` of the linear family, test on as many of the four others.

    Args:
        people: Of either.
        gap: Demand off the best in a trial that is too easy or too hard: the smaller, the harder for an estimator.
        seed: Of all chance.
    """
    rng = np.random.default_rng([seed, 164])
    train = [_session(rng, "linear", gap) for _ in range(people)]
    test = [_session(rng, FAMILIES[1 + i % (len(FAMILIES) - 1)], gap) for i in range(people)]
    features, labels = (np.concatenate([each[k] for each in train]) for k in (0, 1))
    filled = np.nan_to_num(features)
    model = train_lda(filled, labels.astype(np.int64))
    body = train_lda(filled[:, :-1], labels.astype(np.int64))
    alone = train_lda(filled[:, -1:], labels.astype(np.int64))
    hits: dict[str, list[float]] = {name: [] for name in _RIVALS}
    sure: list[tuple[float, float]] = []
    for seen, truth in test:
        _follow(seen, truth.astype(int), Lda(model), hits["fixed"], None)
        _follow(seen, truth.astype(int), AdaptiveLda(model), hits["adaptive"], sure)
        _follow(seen[:, :-1], truth.astype(int), Lda(body), hits["body_fixed"], None)
        _follow(seen[:, :-1], truth.astype(int), AdaptiveLda(body), hits["body_adaptive"], None)
        _follow(seen[:, -1:], truth.astype(int), Lda(alone), hits["performance"], None)
        hits["threshold"] += _by_threshold(seen[:, 0], truth)
    scores = {name: float(np.mean(values)) for name, values in hits.items()}
    return StateScore(**scores, majority=1.0 / 3.0, calibration=_calibration(np.array(sure)))


def _follow(
    seen: Floats, truth: NDArray[np.int64], lda: Lda, hits: list[float], sure: list[tuple[float, float]] | None
) -> None:
    for features, label in zip(seen, truth.tolist(), strict=True):
        probable = lda.probabilities(features)
        right = float(probable.argmax() == label)
        hits.append(right)
        if sure is not None:
            sure.append((float(probable.max()), right))
        lda.learn(features, label)


def _by_threshold(heart: Floats, truth: Floats) -> list[float]:
    """Borders between the classes' means of the first round, applied to the rest."""
    first, known = 3, np.nan_to_num(heart)
    order = np.array(
        [known[:first][truth[:first] == c].mean() if (truth[:first] == c).any() else 0.0 for c in range(3)]
    )
    low, high = (order[0] + order[1]) / 2.0, (order[1] + order[2]) / 2.0
    told = np.where(known[first:] < low, 0, np.where(known[first:] > high, 2, 1))
    return (told == truth[first:]).astype(float).tolist()


def _calibration(sure: Floats, bins: int = 8) -> float:
    """Mean distance of stated probability and share right, weighted by how often it was stated."""
    edges = np.linspace(1.0 / 3.0, 1.0 + 1e-9, bins + 1)
    places = np.clip(np.digitize(sure[:, 0], edges) - 1, 0, bins - 1)
    total = 0.0
    for k in range(bins):
        inside = sure[places == k]
        total += len(inside) * abs(float(np.mean(inside[:, 0] - inside[:, 1]))) if len(inside) else 0.0
    return total / len(sure)


def _session(rng: np.random.Generator, family: Family, gap: float) -> tuple[Floats, Floats]:
    """One person: features of each trial [trials, f], the last of them success; its class [trials]."""
    people, generator = LatentPeople(draw_traits(rng, 1, family), family), SignalGenerator(rng)
    dsp, baseline, second = PhysioDsp(), Baseline(_REST_S - 15), 0
    order = np.concatenate([rng.permutation(3) for _ in range(_ROUNDS)])
    rows: list[list[float]] = []
    for label in (-1, *order.tolist()):
        off = gap * (label - 1)
        demand = np.nan if label < 0 else float(people.skill[0]) + off
        taken: list[list[float]] = []
        for _ in range(_REST_S if label < 0 else _TRIAL_S):
            people.step(1.0, np.array([demand]), np.array([0.2 * (label >= 0)]), np.array([float(label >= 0)]))
            made = generator.second(people.drive(np.zeros(1)))
            blocks = [SignalBlock(name, 1000.0, second * 10**9, values) for name, values in made.items()]
            second += 1
            frame = dsp.process(blocks, second * 10**9)
            if label < 0 and second > 15:
                baseline.add(frame.values)
            zs = [baseline.z(name, frame.values) for name in FEATURES]
            taken.append([np.nan if z is None else float(np.clip(z, -6.0, 6.0)) for z in zs])
        if label >= 0:
            share = rng.binomial(10, 1.0 / (1.0 + np.exp(_SUCCESS_SLOPE * (off - _SUCCESS_EASE)))) / 10.0
            half = np.array(taken[-_TRIAL_S // 2 :])
            known = np.isfinite(half).any(axis=0)
            means = np.where(known, np.nanmean(np.where(known, half, 0.0), axis=0), np.nan)
            rows.append([*means.tolist(), 3.0 * (share - 0.7)])
    return np.array(rows), order.astype(float)
