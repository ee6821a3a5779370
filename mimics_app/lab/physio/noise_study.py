"""R peaks under noise: recorded electrode motion, added to other records, and synthetic noise.

The electrode noise is that of the noise stress test (Moody et al., 1984): two of its excerpts are the same ECG with the
same noise at two amplitudes, and their difference is the noise alone.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.lab.physio.detection import (
    NOISE_DB,
    Annotated,
    annotated_records,
    detect,
    mixed_noise,
    noise_size,
    pooled,
    score_within,
)

__all__ = ["IN_TIME_S", "LagRow", "NoiseRow", "lag_rows", "noise_of", "noise_rows", "noisy_records"]


_EXCERPT = "nst_118e"
_LOUD_DB, _SOFT_DB, _CLEANEST_DB = 0.0, 6.0, 24.0
"""Signal-to-noise ratios of the two excerpts whose difference is the noise, and of the cleanest one [dB]."""
_ELECTRODE_DB = (16.6, 4.6, -1.4, -7.4)
"""Levels by `noise_size` at which noise is as loud as in the stress test at its 24, 12, 6 and 0 dB [dB]."""
_PIECES, _PIECE_S = 4, 120.0
"""Number of parts of each record, and their length [s]."""
_ANEW = 20
"""Number of random shifts of the noise on the ECG that it was recorded with."""
_SYNTHETIC_S = 300.0
"""Length of a record to which synthetic noise is added, from its beginning [s]."""
IN_TIME_S = 0.25
"""Time within which a beat should be known [s]."""
_LAGS_S = (0.1, 0.115, 0.125, 0.14, 0.16, 0.2, IN_TIME_S, 0.35, 0.5, 0.75, 1.0, 1.5, 2.0, 3.0)
"""Times within which a beat is known [s]."""


@dataclass(frozen=True, slots=True)
class NoiseRow:
    """Score over all records of a kind.

    Attributes:
        kind: Kind of records and noise.
        beats: Number of annotated beats.
        missed: Number of these that were not detected.
        invented: Number of false detections.
        worst: F1 of the worst record or part.
        in_time: F1 of the beats known within IN_TIME_S.
        latency_ms: Median and 95th percentile of the time from an R peak to its detection, "p50" and "p95".
    """

    kind: str
    beats: int
    missed: int
    invented: int
    worst: float
    in_time: float
    latency_ms: dict[str, float]

    @property
    def f1(self) -> float:
        """F1 over all beats."""
        return 1.0 - (self.missed + self.invented) / (2.0 * self.beats - self.missed + self.invented)


@dataclass(frozen=True, slots=True)
class LagRow:
    """F1 of the beats of a kind of records that are known within a time [s] after their R peak."""

    kind: str
    lag_s: float
    f1: float


def noise_rows(folder: Path) -> Iterator[NoiseRow]:
    """Yield a row for every kind of record and noise, see `noisy_records`."""
    for kind, records in noisy_records(folder):
        found = [(record, detect(record.values, record.rate)) for record in records]
        scores = [score_within(record, events, np.inf) for record, events in found]
        whole, early = pooled(scores, kind), pooled((score_within(*each, IN_TIME_S) for each in found), kind)
        missed, invented, worst = whole.beats - whole.hits, whole.found - whole.hits, min(s.f1 for s in scores)
        yield NoiseRow(kind, whole.beats, missed, invented, worst, early.f1, whole.latency_ms)


def lag_rows(kinds: Iterable[tuple[str, Iterable[Annotated]]]) -> Iterator[LagRow]:
    """Yield F1 by the time within which a beat must be known, for every kind of records."""
    for kind, records in kinds:
        found = [(record, detect(record.values, record.rate)) for record in records]
        for lag_s in _LAGS_S:
            yield LagRow(kind, lag_s, pooled((score_within(*each, lag_s) for each in found), kind).f1)


def noisy_records(folder: Path) -> Iterator[tuple[str, Iterable[Annotated]]]:
    """Yield every kind of record and noise that the folder has records for, and these.

    Args:
        folder: Folder of annotated records, see `annotated_records`.
    """
    records = {record.name: record for record in annotated_records(folder)}
    hearts = [record for name, record in records.items() if not name.startswith(_EXCERPT)]
    if hearts:
        yield "records as they are", hearts
        for decibel in NOISE_DB:
            heads = (_piece(record, 0.0, _SYNTHETIC_S) for record in hearts)
            noisy = (mixed_noise(record, decibel, seed) for seed, record in enumerate(heads))
            yield f"synthetic noise, {decibel:g} dB", noisy
    excerpts = {name: record for name, record in records.items() if name.startswith(_EXCERPT)}
    for name, record in excerpts.items():
        yield f"noise stress test, {name.removeprefix(_EXCERPT)} dB", [record]
    if excerpts:
        yield "noise stress test, all", excerpts.values()
    loud, soft, clean = (excerpts.get(f"{_EXCERPT}{db:02.0f}") for db in (_LOUD_DB, _SOFT_DB, _CLEANEST_DB))
    if loud is None or soft is None or clean is None:
        return
    noise = noise_of(loud, soft)
    heart = Annotated("118", clean.rate, clean.values - noise * 10.0 ** (-_CLEANEST_DB / 20.0), clean.beats)
    for decibel in _ELECTRODE_DB:
        anew = (_laid(heart, noise, decibel, seed) for seed in range(_ANEW))
        yield f"record 118, electrode noise added again, {decibel:g} dB", anew
        yield f"other records, electrode noise, {decibel:g} dB", _pieces(hearts, noise, decibel)


def noise_of(loud: Annotated, soft: Annotated) -> F8:
    """Return the noise of the excerpt of 0 dB [mV], from that and the one of 6 dB."""
    return (loud.values - soft.values) / (1.0 - 10.0 ** ((_LOUD_DB - _SOFT_DB) / 20.0))


def _pieces(hearts: list[Annotated], noise: F8, decibel: float) -> Iterator[Annotated]:
    """Yield evenly spaced parts of each record with the noise added."""
    for k, heart in enumerate(hearts):
        last = max(len(heart.values) / heart.rate - _PIECE_S, 0.0)
        for n in range(_PIECES):
            piece = _piece(heart, last * n / (_PIECES - 1), _PIECE_S)
            yield _laid(piece, noise, decibel, 100 + _PIECES * k + n)


def _laid(heart: Annotated, noise: F8, decibel: float, seed: int) -> Annotated:
    """Return a part with noise of the same rate, shifted at random, and inverted for odd seeds."""
    n = len(heart.values)
    whole = np.resize(np.roll(noise, np.random.default_rng([seed, 126]).integers(len(noise))), n)
    size = noise_size(heart, decibel) / whole.std() * (-1.0) ** seed
    return Annotated(f"{heart.name}_{decibel:g}dB_{seed}", heart.rate, heart.values + size * whole, heart.beats)


def _piece(record: Annotated, begin_s: float, seconds: float) -> Annotated:
    """Return a part of a record."""
    first = round(begin_s * record.rate)
    values = record.values[first : first + round(seconds * record.rate)]
    beats = record.beats - first / record.rate
    inside = (beats >= 0.0) & (beats < len(values) / record.rate)
    return Annotated(f"{record.name}_{begin_s:.0f}s", record.rate, values, beats[inside])
