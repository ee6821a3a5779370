"""Figures of body signals against closed forms: variability, skin conductance, breath, muscle."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from mimics_app.dsp.channels.ecg import Ecg
from mimics_app.dsp.channels.emg import Emg
from mimics_app.dsp.channels.gsr import Gsr
from mimics_app.dsp.channels.resp import Resp
from mimics_app.dsp.rhythm import Rhythm
from mimics_app.dsp.spectrum import band_power
from tests.support.body_signals import f1, feed
from tests.support.heart import WAVES, heart

Floats = NDArray[np.float64]
RATE = 100.0


def waving(rate: float, waves: dict[float, float], seconds: float = 190.0) -> Floats:
    """Times of beats whose intervals follow sines of the time: frequency [Hz] to amplitude [s]."""
    times = [0.0]
    while times[-1] < seconds:
        swing = sum(size * np.sin(2.0 * np.pi * f * times[-1] + 3.0 * f) for f, size in waves.items())
        times.append(times[-1] + 60.0 / rate + swing)
    return np.array(times)


def features_of(times: Floats) -> dict[str, float]:
    rhythm = Rhythm()
    for t in times.tolist():
        rhythm.beat(t)
    return rhythm.features(float(times[-1]))


@pytest.mark.parametrize("rate", [50.0, 60.0, 75.0, 90.0, 110.0])
@pytest.mark.parametrize("frequency", [0.05, 0.1, 0.14, 0.2, 0.25, 0.3, 0.35, 0.4])
def test_a_wave_of_the_heart_has_its_power_at_every_rate(rate: float, frequency: float) -> None:
    """Of intervals that are a sine the power is half its squared amplitude."""
    times = waving(rate, {frequency: 0.04})
    found = band_power(times[1:], np.diff(times), frequency - 0.02, frequency + 0.02)
    assert found == pytest.approx(0.5 * 0.04**2, rel=0.01)


@pytest.mark.parametrize("rate", [50.0, 70.0, 110.0])
@pytest.mark.parametrize("slow", [0.055, 0.1, 0.13])
@pytest.mark.parametrize("fast", [0.165, 0.25, 0.33])
def test_low_and_high_frequencies_are_told_apart(rate: float, slow: float, fast: float) -> None:
    found = features_of(waving(rate, {slow: 0.03, fast: 0.02}))
    assert found["lf"] == pytest.approx(0.5 * 30.0**2, rel=0.03)
    assert found["hf"] == pytest.approx(0.5 * 20.0**2, rel=0.03)
    assert found["lf_hf"] == pytest.approx(2.25, rel=0.03)


@pytest.mark.parametrize(("frequency", "band"), [(0.025, ""), (0.055, "lf"), (0.135, "lf"), (0.165, "hf"), (0.42, "")])
def test_the_bands_end_where_the_task_force_ends_them(frequency: float, band: str) -> None:
    found = features_of(waving(80.0, {frequency: 0.03}))
    for name in ("lf", "hf"):
        assert found[name] == pytest.approx(450.0 if name == band else 0.0, rel=0.03, abs=5.0)


def test_single_beats_that_are_missing_change_little() -> None:
    """One interval in twenty is left out, at random: each ratio of power within a tenth on average."""
    rng, ratios = np.random.default_rng(3), []
    for _ in range(10):
        times = waving(70.0, {0.1: 0.03, 0.27: 0.02})
        lengths, keep = np.diff(times), rng.random(len(times) - 1) >= 0.05
        low, high = (band_power(times[1:][keep], lengths[keep], *band) for band in ((0.04, 0.15), (0.15, 0.4)))
        ratios.append([low / 0.5 / 0.03**2, high / 0.5 / 0.02**2])
    assert np.mean(ratios, axis=0) == pytest.approx([1.0, 1.0], abs=0.1)


def test_the_share_of_long_steps() -> None:
    """Intervals of 800, 800, 860 ms in turn: two of three steps are 60 ms."""
    found = features_of(np.cumsum(np.tile([0.8, 0.8, 0.86], 30)))
    assert found["pnn50"] == pytest.approx(200.0 / 3.0, abs=2.0)
    assert found["rmssd"] == pytest.approx(60.0 * np.sqrt(2.0 / 3.0), rel=0.02)
    assert found["sdnn"] == pytest.approx(60.0 * np.sqrt(2.0) / 3.0, rel=0.03)


@pytest.mark.parametrize("rate", [128.0, 250.0, 500.0, 1000.0])
def test_an_r_peak_is_placed_where_it_is(rate: float) -> None:
    beats = np.arange(0.5, 39.5, 0.83)
    found = np.array([event.t_s for event in feed(Ecg(rate), heart(beats, rate, 40.0), 16)])
    assert len(found) == len(beats)
    assert np.abs(found - beats).max() < 0.008


@pytest.mark.parametrize("apart", [0.09, 0.13, 0.17])
def test_two_peaks_of_one_beat_are_one(apart: float) -> None:
    """A bundle branch block has two R waves: the heart does not beat twice within a fifth of a second."""
    beats = np.arange(0.5, 59.5, 0.83)
    split = (*WAVES, (apart, 0.95, 0.011))
    found = [event.t_s for event in feed(Ecg(250.0), heart(beats, 250.0, 60.0, split), 16)]
    assert f1((beats + 0.5 * apart).tolist(), found, 0.12) > 0.98


def response(t: Floats, size: float, fast: float = 0.75, slow: float = 2.6) -> tuple[Floats, float]:
    """A skin response of an amplitude that begins at 0, and the time of its peak (Bateman function)."""
    peak = float(np.log(slow / fast) * slow * fast / (slow - fast))
    since = np.maximum(t, 0.0)
    top = np.exp(-peak / slow) - np.exp(-peak / fast)
    return size / top * (np.exp(-since / slow) - np.exp(-since / fast)), peak


def test_skin_conductance_of_known_responses() -> None:
    """Six responses a minute of 0.3 uS on 5 uS: their number, sum, size, place, onset, and the level between them."""
    t = np.arange(round(130 * RATE)) / RATE
    onsets = np.arange(12.0, 128.0, 10.0)
    values = 5.0 + sum(response(t - onset, 0.3)[0] for onset in onsets)
    peak = response(t, 0.3)[1]
    channel = Gsr(RATE)
    events = feed(channel, values, 20)
    assert np.array([event.t_s for event in events]) == pytest.approx(onsets[: len(events)] + peak, abs=0.15)
    assert len(events) == len(onsets)
    assert np.array([event.value for event in events]) == pytest.approx(0.3, rel=0.05)
    found = channel.found.features
    assert found["scr_rate"] == pytest.approx(6.0, abs=1.0)
    assert found["scr_sum"] == pytest.approx(0.3 * found["scr_rate"], rel=0.05)
    assert found["scl"] == pytest.approx(5.0, abs=0.05)
    assert abs(found["scl_slope"]) < 0.1


@pytest.mark.parametrize("slope", [-1.0, 0.5])
def test_the_slope_of_a_level(slope: float) -> None:
    channel = Gsr(RATE)
    feed(channel, 8.0 + slope / 60.0 * np.arange(round(90 * RATE)) / RATE, 50)
    assert channel.found.features["scl_slope"] == pytest.approx(slope, rel=0.02)


def breathing(rate: float, seconds: float, inward: float, depth: float = 2.0) -> Floats:
    """Breaths of half cosines, with a share of the time for the in-breath."""
    phase = (np.arange(round(seconds * RATE)) / RATE * rate / 60.0) % 1.0
    rising = -np.cos(np.pi * phase / inward)
    falling = np.cos(np.pi * (phase - inward) / (1.0 - inward))
    return 0.5 * depth * np.where(phase < inward, rising, falling)


@pytest.mark.parametrize("rate", [8.0, 15.0, 24.0, 36.0])
def test_breath_of_known_rate_and_depth(rate: float) -> None:
    channel = Resp(RATE)
    feed(channel, breathing(rate, 120.0, 0.5), 50)
    found = channel.found.features
    assert found["breath_rate"] == pytest.approx(rate, rel=0.01)
    assert found["breath_ratio"] == pytest.approx(1.0, rel=0.1)
    assert found["breath_variability"] < 0.02


@pytest.mark.parametrize("inward", [0.35, 0.6])
def test_ratio_of_in_breath_to_out_breath(inward: float) -> None:
    channel = Resp(RATE)
    feed(channel, breathing(15.0, 120.0, inward), 50)
    assert channel.found.features["breath_ratio"] == pytest.approx(inward / (1.0 - inward), rel=0.25)


@pytest.mark.parametrize("depth", [0.5, 20.0])
def test_depth_follows_the_size_of_the_breath(depth: float) -> None:
    channel = Resp(RATE)
    feed(channel, breathing(15.0, 120.0, 0.5, depth), 50)
    assert channel.found.features["breath_depth"] == pytest.approx(depth, rel=0.1)


@pytest.mark.parametrize("share", [0.1, 0.2, 0.3])
@pytest.mark.parametrize("frequency", [0.55, 0.8, 1.0, 1.3])
@pytest.mark.parametrize("rate", [8.0, 14.0])
def test_ripples_on_a_breath_are_no_breaths(rate: float, frequency: float, share: float) -> None:
    """The heart moves the chest too: here by up to 0.3 of the depth, from the first breath on."""
    t = np.arange(round(120 * RATE)) / RATE
    values = breathing(rate, 120.0, 0.45) + share * np.sin(2.0 * np.pi * frequency * t)
    found = np.array([event.t_s for event in feed(Resp(RATE), values, 50)])
    assert len(found) <= 2.0 * rate
    assert np.diff(found).max() < 1.3 * 60.0 / rate, "none is missed once it has begun"
    assert found[0] < 5.0 + 2.0 * 60.0 / rate


def test_a_shallow_breath_counts() -> None:
    """Half as deep as the others, every fourth one."""
    parts = [breathing(15.0, 4.0, 0.45, 1.0 if i % 4 == 3 else 2.0) for i in range(30)]
    levels = np.concatenate([part - part[0] for part in parts])
    assert len(feed(Resp(RATE), levels, 50)) == pytest.approx(29, abs=2)


def test_a_muscle_of_known_size_and_frequency() -> None:
    """A sine has an RMS of its amplitude over the square root of two, and its frequency is the median one."""
    t = np.arange(20_000) / 1000.0
    noise = 0.002 * np.random.default_rng(1).standard_normal(20_000)
    channel = Emg(1000.0)
    feed(channel, noise + np.where(t > 5.0, 0.5 * np.sin(2.0 * np.pi * 80.0 * t), 0.0), 20)
    found = channel.found.features
    assert found["emg"] == pytest.approx(0.5 / np.sqrt(2.0), rel=0.03)
    assert found["emg_integrated"] == pytest.approx(0.5 / np.sqrt(2.0), rel=0.03)
    assert found["emg_median_hz"] == pytest.approx(80.0, abs=1.0)
    assert found["emg_active"] == 1.0


def test_fatigue_is_the_slope_of_the_median_frequency() -> None:
    """A tone that falls from 120 Hz by 30 Hz a minute."""
    t = np.arange(40_000) / 1000.0
    phase = 2.0 * np.pi * (120.0 * t - 0.25 * t * t)
    channel = Emg(1000.0)
    noise = 0.002 * np.random.default_rng(1).standard_normal(40_000)
    feed(channel, noise + np.where(t > 3.0, 0.5 * np.sin(phase), 0.0), 20)
    assert channel.found.features["emg_fatigue"] == pytest.approx(-30.0, rel=0.05)
