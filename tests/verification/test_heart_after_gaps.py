"""The heart after a pause, a flat electrode or noise, and behind P waves as steep as its beats."""

from __future__ import annotations

import numpy as np
import pytest

from mimics_app.dsp.channels.ecg import Ecg
from tests.support.body_signals import f1
from tests.support.heart import WAVES, heart

RATE, BEFORE, AFTER = 125, 40, 60


def around(gap: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """An ECG of 72 beats a minute with a gap in it, and the beats behind the gap [s]."""
    rng = np.random.default_rng(1)
    beats = np.cumsum(60.0 / 72.0 + 0.02 * rng.standard_normal(round(1.2 * (BEFORE + AFTER))))
    beats = beats[beats < BEFORE + AFTER - 0.4]
    ecg = heart(beats, RATE, BEFORE + AFTER)
    values = np.concatenate([ecg[: BEFORE * RATE], gap, ecg[BEFORE * RATE :]])
    return values, beats[beats > BEFORE] + len(gap) / RATE


def gap_of(kind: str, seconds: int) -> np.ndarray:
    if kind == "noise":
        return 0.004 * np.random.default_rng(3).standard_normal(seconds * RATE)
    return np.full(seconds * RATE, {"missing": np.nan, "flat": 0.0, "held": 0.4}[kind])


@pytest.mark.parametrize("seconds", [5, 60, 300, 900])
@pytest.mark.parametrize("kind", ["missing", "flat", "held", "noise"])
def test_the_heart_rate_after_a_gap_is_right_or_not_known(kind: str, seconds: int) -> None:
    values, truth = around(gap_of(kind, seconds))
    channel, found, told = Ecg(float(RATE)), list[float](), list[tuple[float, float]]()
    for begin in range(0, len(values), RATE):
        found += [event.t_s for event in channel.push(values[begin : begin + RATE])]
        features = channel.found.features
        if begin / RATE >= BEFORE + seconds and "heart_rate" in features:
            told.append((features["heart_rate"], features.get("rmssd", 30.0)))
    end = BEFORE + seconds
    assert f1([t for t in truth.tolist() if t > end + 6], [t for t in found if t > end + 6], 0.05) > 0.97
    assert len(told) > 0.75 * AFTER, "it is known again after some seconds"
    rates, steps = np.array(told).T
    assert np.abs(rates - 72.0).max() < 10.0
    assert steps.max() < 60.0


@pytest.mark.parametrize("kind", ["missing", "flat", "held"])
def test_there_are_no_beats_without_a_heart(kind: str) -> None:
    values, _ = around(gap_of(kind, 120))
    channel = Ecg(float(RATE))
    beats = [event.t_s for begin in range(0, len(values), RATE) for event in channel.push(values[begin : begin + RATE])]
    assert not [t for t in beats if BEFORE + 0.5 < t < BEFORE + 120]


@pytest.mark.parametrize("apart", [0.16, 0.204])
@pytest.mark.parametrize(("p", "r"), [((0.5, 0.018), (0.5, 0.011)), ((0.8, 0.02), (0.6, 0.011))])
def test_a_p_wave_as_steep_as_its_beat_is_no_beat(apart: float, p: tuple[float, float], r: tuple[float, float]) -> None:
    """It hid the beat for as long as it lasted: after some beats the second of two steep waves is taken."""
    beats = np.arange(0.6, 119.0, 0.83)
    waves = ((-apart, *p), *WAVES[1:2], (0.0, *r), *WAVES[3:])
    values = heart(beats, 250.0, 120.0, waves)
    channel = Ecg(250.0)
    found = [event.t_s for begin in range(0, len(values), 250) for event in channel.push(values[begin : begin + 250])]
    late = [t for t in found if t > 20.0]
    assert f1(beats[beats > 20.0].tolist(), late, 0.05) > 0.985
