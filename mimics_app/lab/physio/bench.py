"""`mimics bench physio`: detector, cost, latency, policies on simulated people, guided walk, and peers.

The people of the study of arousal rest, then play through five stretches that are too hard, right or too easy.
Simulation is not clinical evidence.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.errors import DeviceError
from mimics_app.estimation.fusion import FusionEstimation
from mimics_app.inputs.physio.simulated.kinds import KINDS, Kind
from mimics_app.lab.peer_harness import run_harness
from mimics_app.lab.physio.cohort import play_cohort
from mimics_app.lab.physio.detection import (
    NOISE_DB,
    Annotated,
    annotated_records,
    measure_cost,
    mixed_noise,
    score_beats,
)
from mimics_app.lab.physio.load_sessions import draw_load_people
from mimics_app.lab.physio.noise_study import noise_rows
from mimics_app.lab.physio.simulated_task import POWER_W, REST_S, SignalSession
from mimics_app.lab.physio.state_study import state_study
from mimics_app.lab.physio.walk_study import CONTROLS, WalkResult, walk_study
from mimics_app.learning.registry import POLICIES

__all__ = ["arousal_study", "measure_noise", "measure_physio"]

_SIMULATED = "simulated people; a simulation is not clinical evidence"
_NOISY_MINUTES = 5.0
"""Length of a record to which noise is added, from its beginning [min]."""
_AROUSED = range(40, 80)
"""Seeds of the people of the arousal: none of them was looked at when its variance was set."""
_GAPS = (0.08, 0.15, 0.22)
"""Deviation of the demand from the best one in a trial that is too easy or too hard."""


_BASELINE_S = 60.0
"""Length of the calibration [s]."""
_AROUSAL_GAPS, _STRETCH_S = (0.3, 0.0, -0.3, 0.15, 0.3), 66
"""Deviation of the demand from the best one in each stretch, and its length [s]: the features look back a minute."""
_Z = 1.96
"""Standard deviations of the half width of a 95 % interval."""


def measure_physio(folder: Path | None, peers: Path | None) -> dict[str, Any]:
    """Return the object of `mimics bench physio`.

    Args:
        folder: Folder of annotated records; None: simulated ones.
        peers: Folder whose physio/bench_rpeaks.py runs other detectors on the same records; None: not measured.
    """
    clean = [_row(record) for record in annotated_records(folder)]
    heads = list(annotated_records(folder, _NOISY_MINUTES))
    noisy = [
        _row(mixed_noise(head, decibel, seed))
        for decibel in NOISE_DB
        for seed, head in enumerate(heads)
        if not head.name.startswith("nst")
    ]
    return {
        "ecg": [*clean, *noisy],
        "noise": measure_noise(folder),
        "records": str(folder) if folder else _SIMULATED,
        **measure_cost(),
        "policies": {"what": _SIMULATED, "regret": {name: _regret(name) for name in POLICIES}},
        "state": {"what": _SIMULATED, "gaps": {f"{gap:g}": _load(gap) for gap in _GAPS}},
        "arousal": {"what": _SIMULATED, "kinds": _arousal()},
        "guided_walk": list(_walks()),
        "peers": _peers(folder, peers),
    }


@dataclass(frozen=True, slots=True)
class _ArousalScore:
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


def arousal_study(people: Sequence[int]) -> list[_ArousalScore]:
    """Return the scores of simulated people.

    Args:
        people: Seed of each; the kind follows from it in turn.
    """
    return [_score(KINDS[seed % len(KINDS)], np.random.default_rng([seed, 292])) for seed in people]


def _score(kind: Kind, rng: np.random.Generator) -> _ArousalScore:
    mean, variance, truth = _play(kind, rng).T
    covered = np.abs(mean - truth) < _Z * np.sqrt(variance)
    agrees = float(np.corrcoef(mean, truth)[0, 1])
    return _ArousalScore(kind.heart, float(covered.mean()), float(np.sqrt(variance).mean()), agrees)


def _play(kind: Kind, rng: np.random.Generator) -> F8:
    """Return mean, variance and true arousal of each second in which arousal is known, shape [s, 3]."""
    who, body = rng.spawn(2)
    people, rows = kind.people(who), []
    session, estimation = SignalSession(people, kind.signals(body)), FusionEstimation(_BASELINE_S)
    for second in range(REST_S + len(_AROUSAL_GAPS) * _STRETCH_S):
        playing = second >= REST_S
        gap = _AROUSAL_GAPS[(second - REST_S) // _STRETCH_S] if playing else np.nan
        for frame in session.live(1, float(people.best[0]) + gap, POWER_W if playing else 0.0):
            arousal = estimation.update(frame).arousal
            if arousal is not None:
                rows.append((arousal.mean, arousal.variance, float(people.arousal[0])))
    return np.array(rows)


def _arousal() -> dict[str, dict[str, float]]:
    """Return by kind of heart how much of the truth the interval of arousal holds, its deviation and correlation."""
    rows: dict[str, list[tuple[float, float, float]]] = {}
    for score in arousal_study(_AROUSED):
        rows.setdefault(score.heart, []).append((score.covered, score.deviation, score.correlation))
    means = {heart: np.mean(each, axis=0).tolist() for heart, each in rows.items()}
    return {
        heart: dict(zip(("covered", "deviation", "correlation"), each, strict=True)) for heart, each in means.items()
    }


def _walks() -> Iterator[dict[str, Any]]:
    """Yield the guided walk in each condition, and with guides that are permuted or learn nothing."""
    yield _figures(walk_study("random"))
    for condition in ("intimate", "social"):
        for guide in ("taught", *CONTROLS):
            yield _figures(walk_study(condition, guide=guide))


def _figures(walk: WalkResult) -> dict[str, Any]:
    """Return a row without the median that half of the walkers did not reach."""
    return {name: value for name, value in asdict(walk).items() if value != math.inf}


def measure_noise(folder: Path | None) -> list[dict[str, Any]]:
    """Return F1, missed and false beats by kind of record and noise; [] without a folder of records."""
    rows = noise_rows(folder) if folder is not None else ()
    return [{**asdict(row), "f1": row.f1} for row in rows]


def _row(record: Annotated) -> dict[str, Any]:
    score = score_beats(record)
    return {
        "record": score.record,
        "f1": score.f1,
        "sensitivity": score.sensitivity,
        "ppv": score.ppv,
        "latency_ms": score.latency_ms,
    }


def _load(gap: float) -> dict[str, dict[str, float]]:
    """Return the share of trials estimated right, with 95 % interval and calibration, by estimator."""
    scores = state_study(draw_load_people(2, gap)).items()
    return {
        name: {"share": score.share, "half_width": score.half_width, "calibration": score.calibration}
        for name, score in scores
    }


def _regret(name: str) -> dict[str, float]:
    result = play_cohort(POLICIES[name], n=300)
    silent = result.regret[:, ~result.responds]
    return {"mean": result.mean, "non_responders": float(silent.mean()), "reversals": result.reversals()}


def _peers(folder: Path | None, peers: Path | None) -> list[dict[str, Any]] | str:
    """Return what the peers' own harness measures on the same records, or why it does not."""
    harness = None if peers is None else peers / "physio" / "bench_rpeaks.py"
    if folder is None or harness is None or not harness.exists():
        return "not measured"
    try:
        rows = run_harness(harness, str(folder.absolute()), "--out")["summary"]
    except DeviceError as failure:
        return f"not measured: {failure}"
    found = [
        {"name": row["detector"], "f1": row["f1"], "seconds_per_hour": 3.6e6 / row["median_samples_per_s"]}
        for row in rows
        if "f1" in row
    ]
    return found or "not measured: no rival is installed"
