"""R peaks against annotations, also with added noise; cost and latency of the processing of four signals."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.clock import MonotonicClock
from mimics_app.contracts.messages.stage_messages import SignalBlock
from mimics_app.dsp.channel import Event
from mimics_app.dsp.channels.ecg import Ecg
from mimics_app.dsp.filters import band_pass
from mimics_app.dsp.stage import PhysioDsp
from mimics_app.inputs.physio.simulated.person import LatentPeople, draw_traits
from mimics_app.inputs.physio.simulated.signals import Disturbance, SignalGenerator, Truth

__all__ = [
    "NOISE_DB",
    "Annotated",
    "Score",
    "annotated_records",
    "detect",
    "f1_of",
    "matched",
    "measure_cost",
    "mixed_noise",
    "noise_size",
    "pooled",
    "score_beats",
    "score_within",
]


NOISE_DB = (12.0, 6.0, 0.0)
"""Signal-to-noise ratios of the synthetic noise [dB]; power of a QRS: its peak-to-peak squared over eight."""
_WITHIN_S = 0.15
"""Largest distance of a detected from an annotated beat [s]: ANSI/AAMI EC57."""
_BLOCK_S = 0.02
"""Length of a block of samples [s]."""


@dataclass(frozen=True, slots=True)
class Annotated:
    """An ECG [mV] at a rate [Hz], and the times of its beats [s]."""

    name: str
    rate: float
    values: F8
    beats: F8


@dataclass(frozen=True, slots=True)
class Score:
    """Score of the detector on one record, or pooled over several.

    Attributes:
        record: Name of the record.
        beats: Number of annotated beats.
        found: Number of detected beats.
        hits: Number of detected beats that match an annotated one.
        latency_s: Time from each detected R peak to its detection [s], shape [found].
    """

    record: str
    beats: int
    found: int
    hits: int
    latency_s: F8

    @property
    def f1(self) -> float:
        """Harmonic mean of sensitivity and positive predictive value."""
        return f1_of(self.hits, self.beats, self.found)

    @property
    def sensitivity(self) -> float:
        """Share of the annotated beats that were detected."""
        return self.hits / max(self.beats, 1)

    @property
    def ppv(self) -> float:
        """Share of the detected beats that are annotated."""
        return self.hits / max(self.found, 1)

    @property
    def latency_ms(self) -> dict[str, float]:
        """Median and 95th percentile of the latency [ms], "p50" and "p95"; NaN without a detected beat."""
        known = self.latency_s if self.found else np.array([np.nan])
        return {f"p{p}": 1e3 * float(np.percentile(known, p)) for p in (50, 95)}


def annotated_records(folder: Path | None, minutes: float = 0.0) -> Iterator[Annotated]:
    """Yield every .npz of a folder with ecg_adc, gain_per_mV, fs and beats; without a folder, simulated people.

    Args:
        folder: Folder of records, or None.
        minutes: Length to be read of each record [min]; 0: all of it.
    """
    if folder is None:
        for seed, ectopic in ((1, 0.0), (2, 0.05)):
            values, truth = _simulated(300, seed, ectopic)
            yield Annotated(f"simulated_{round(100 * ectopic)}_ectopic", 1000.0, values, np.array(truth.beats))
        return
    for path in sorted(folder.glob("*.npz")):
        with np.load(path) as data:
            if not {"ecg_adc", "gain_per_mV", "fs", "beats"} <= set(data.files):
                continue
            rate = float(data["fs"])
            n = round(60.0 * minutes * rate) or len(data["ecg_adc"])
            beats = data["beats"] / rate
            values = data["ecg_adc"][:n] / float(data["gain_per_mV"])
            yield Annotated(path.stem, rate, values, beats[beats < n / rate])


def mixed_noise(record: Annotated, decibel: float, seed: int) -> Annotated:
    """Return a record with muscle noise (20-90 Hz), wander (0.05-0.5 Hz) and bursts of motion (0.5-10 Hz)."""
    rng, n, rate = np.random.default_rng([seed, len(record.values)]), len(record.values), record.rate

    def band(low: float, high: float) -> F8:
        from scipy.signal import sosfilt

        return _unit(sosfilt(band_pass(2, low, high, rate), rng.standard_normal(n)))

    muscle, wander, motion = band(20.0, 90.0), band(0.05, 0.5), band(0.5, 10.0)
    slow = np.convolve(rng.standard_normal(n // 100 + 50), np.ones(50), "valid").repeat(100)[:n] > 0.0
    noise = _unit(muscle + wander + motion * slow)
    values = record.values + noise_size(record, decibel) * noise
    return Annotated(f"{record.name}_{decibel:g}dB", rate, values, record.beats)


def noise_size(record: Annotated, decibel: float) -> float:
    """Return the standard deviation of noise at a signal-to-noise ratio, see `NOISE_DB` [mV]."""
    w = round(0.05 * record.rate)
    places = np.round(record.beats * record.rate).astype(int)
    peaks = [np.ptp(record.values[max(0, at - w) : at + w]) for at in places if at + w > 1]
    return float(np.sqrt(np.median(peaks) ** 2 / 8.0 / 10.0 ** (decibel / 10.0)))


def score_beats(record: Annotated) -> Score:
    """Score the product's detector over a whole record including its beginning."""
    return score_within(record, detect(record.values, record.rate), np.inf)


def score_within(record: Annotated, events: list[Event], lag_s: float) -> Score:
    """Score R peaks; those known later than `lag_s` after the peak count as not detected."""
    early = [event for event in events if event.known_s - event.t_s <= lag_s]
    found, known = (np.array([getattr(event, name) for event in early]) for name in ("t_s", "known_s"))
    return Score(record.name, len(record.beats), len(found), matched(record.beats, found), known - found)


def pooled(scores: Iterable[Score], name: str) -> Score:
    """Return the score over all beats of several records."""
    each = list(scores)
    beats, found, hits = (sum(getattr(score, what) for score in each) for what in ("beats", "found", "hits"))
    return Score(name, beats, found, hits, np.concatenate([score.latency_s for score in each]))


def detect(values: F8, rate: float) -> list[Event]:
    """Return the R peaks that the product's detector finds in an ECG [mV], fed in blocks of 20 ms."""
    channel, block = Ecg(rate), max(1, round(_BLOCK_S * rate))
    return [event for i in range(0, len(values), block) for event in channel.push(values[i : i + block])]


def f1_of(hits: int, beats: int, found: int) -> float:
    """Return F1, the harmonic mean of sensitivity and positive predictive value; 0 without a beat."""
    return 2.0 * hits / max(beats + found, 1)


def matched(truth: F8, found: F8) -> int:
    """Return the number of pairs within the tolerance, one to one in order of time, the nearer of two candidates."""
    i = j = hits = 0
    while i < len(truth) and j < len(found):
        away = found[j] - truth[i]
        if abs(away) <= _WITHIN_S:
            if j + 1 < len(found) and abs(found[j + 1] - truth[i]) < abs(away):
                j += 1
                continue
            hits, i, j = hits + 1, i + 1, j + 1
        elif away < 0.0:
            j += 1
        else:
            i += 1
    return hits


def measure_cost(seconds: int = 120) -> dict[str, Any]:
    """Measure the stage with four signals at 1 kHz in blocks of 20 ms: seconds per hour, longest push, latencies."""
    signals, truth = _all_signals(seconds)
    events: list[tuple[str, Event]] = []
    dsp, clock = PhysioDsp(lambda name, event: events.append((name, event))), MonotonicClock()
    block, spent, longest = round(1000 * _BLOCK_S), 0, 0
    for i in range(0, 1000 * seconds, block):
        t_ns = i * 1_000_000
        pieces = [SignalBlock(name, 1000.0, t_ns, values[i : i + block]) for name, values in signals.items()]
        begun = clock.now_ns()
        dsp.process(pieces, t_ns)
        took = clock.now_ns() - begun
        if i >= 20_000:  # compiled, and past the first seconds
            spent, longest = spent + took, max(longest, took)
    hour = 3600.0 / (seconds - 20.0)
    return {
        "seconds_per_hour": spent * 1e-9 * hour,
        "push_ms_max": longest * 1e-6,
        "latency_ms": {kind: _latency(events, kind) for kind in ("r_peak", "scr", "emg_onset", "breath")},
        "responses": {"true": len(truth.responses), "found": sum(e.kind == "scr" for _, e in events)},
    }


def _latency(events: list[tuple[str, Event]], kind: str) -> dict[str, float]:
    late = 1e3 * np.array([e.known_s - e.t_s for _, e in events if e.kind == kind and e.t_s > 5.0])
    return {"p50": float(np.median(late)), "p95": float(np.quantile(late, 0.95))} if len(late) else {}


def _simulated(seconds: int, seed: int, ectopic: float) -> tuple[F8, Truth]:
    signals, truth = _all_signals(seconds, seed, ectopic)
    return signals["ecg"], truth


def _all_signals(seconds: int, seed: int = 1, ectopic: float = 0.0) -> tuple[dict[str, F8], Truth]:
    """Return signals of a person, first at rest, then with a task and bouts of work."""
    rng = np.random.default_rng([seed, 77])
    people, generator = LatentPeople(draw_traits(rng, 1)), SignalGenerator(rng, Disturbance(ectopic=ectopic))
    made: list[dict[str, F8]] = []
    for second in range(seconds):
        works = float(second > 30 and second // 10 % 2)
        people.step(1.0, np.array([0.7]), np.array([3.0 * works]), np.array([works]))
        made.append(generator.second(people.drive(np.array([0.05 * works]))))
    return {name: np.concatenate([each[name] for each in made]) for name in made[0]}, generator.truth


def _unit(values: F8) -> F8:
    return values / values.std()
