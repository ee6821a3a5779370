"""The synthesised sounds measured: attack, brightness, level, offset, peak and loop seam."""

from __future__ import annotations

import numpy as np
import pytest

from mimics_app.rendering.audio import synth
from mimics_app.rendering.audio.bank import SoundBank
from mimics_app.rendering.audio.recipe import built_in_recipes
from mimics_app.rendering.audio.settings import SoundSpec

RATE = 48_000
FULL_SCALE_MINUS_1_DB = 10 ** (-1 / 20)
CONTACT_TAKES = built_in_recipes()["contact"].takes
CASES = [(speed, take) for speed in synth.CONTACT_SPEEDS for take in range(CONTACT_TAKES)]


def centroid_hz(samples: np.ndarray) -> float:
    power = np.abs(np.fft.rfft(samples, 1 << 16)) ** 2
    return float(np.sum(np.fft.rfftfreq(1 << 16, 1 / RATE) * power) / np.sum(power))


def attack_ms(samples: np.ndarray) -> float:
    """From 10 % to 90 % of the peak, on the rising edge."""
    level = np.abs(samples) / np.abs(samples).max()
    return float(np.argmax(level > 0.9) - np.argmax(level > 0.1)) / RATE * 1e3


@pytest.mark.parametrize(("speed", "take"), CASES)
def test_contact_attack_is_shorter_than_a_millisecond(speed, take):
    samples = synth.synthesise_contact(speed, take)
    assert attack_ms(samples) <= 1.0
    assert np.argmax(np.abs(samples) > 1e-5 * np.abs(samples).max()) == 0, "a contact must sound from its first sample"


@pytest.mark.parametrize("take", range(CONTACT_TAKES))
def test_contact_is_brighter_the_harder_it_hits(take):
    centroids = [centroid_hz(synth.synthesise_contact(speed, take)) for speed in synth.CONTACT_SPEEDS]
    assert np.all(np.diff(centroids) > 0.0)
    assert centroids[-1] > 1.4 * centroids[0], "half an octave of brightness, or nobody hears the difference"


@pytest.mark.parametrize(("speed", "take"), CASES)
def test_contacts_have_one_loudness_and_no_offset(speed, take):
    samples = synth.synthesise_contact(speed, take)
    assert np.sqrt(np.mean(samples[: RATE // 20] ** 2)) == pytest.approx(synth.CONTACT_RMS, rel=1e-3)
    assert np.abs(samples).max() <= FULL_SCALE_MINUS_1_DB
    # sum over the spectrum's zero line, against the largest line: -60 dB is far below hearing at 0 Hz
    assert abs(samples.sum()) < 1e-3 * np.abs(np.fft.rfft(samples)).max()


def test_neighbouring_takes_are_different_recordings():
    first, second = (synth.synthesise_contact(0.3, take).astype(float) for take in (0, 1))
    assert np.dot(first, second) < 0.995 * np.linalg.norm(first) * np.linalg.norm(second)
    assert not np.array_equal(first, second)


@pytest.mark.parametrize("recipe", ["goal", "start", "trial_end", "tick", "scrape", "grip", "slip", "knock"])
def test_recipe_is_finite_below_full_scale_and_without_offset(recipe):
    samples = SoundBank({"it": SoundSpec(recipe=recipe)}, RATE)["it"].samples
    assert samples.dtype == np.float32
    assert np.isfinite(samples).all()
    assert 0.1 < np.abs(samples).max() <= FULL_SCALE_MINUS_1_DB
    assert abs(samples.sum()) < 1e-3 * np.abs(np.fft.rfft(samples)).max()


@pytest.mark.parametrize("recipe", ["goal", "start", "trial_end", "tick"])
def test_one_shot_ends_in_silence(recipe):
    samples = SoundBank({"it": SoundSpec(recipe=recipe)}, RATE)["it"].samples
    assert abs(samples[-1]) < 1e-3 * np.abs(samples).max()


def test_scrape_has_no_seam():
    samples = synth.synthesise_scrape().astype(float)
    steps = np.abs(np.diff(samples))
    assert abs(samples[0] - samples[-1]) <= steps.max(), "the step over the seam is one of the loop's own steps"
    curve = np.abs(np.diff(np.tile(samples, 2), 2))
    assert curve[len(samples) - 2 : len(samples)].max() <= curve[: len(samples) - 2].max()


def test_goal_holds_its_chord():
    spectrum = np.abs(np.fft.rfft(SoundBank({"goal": SoundSpec(recipe="goal")}, RATE)["goal"].samples, RATE))
    for note in (523, 659, 784, 1046):
        assert spectrum[note - 3 : note + 4].max() > 0.2 * spectrum.max()


def test_pitch_raises_a_recipe():
    low, high = (SoundBank({"t": SoundSpec(recipe="tick", pitch=p)}, RATE)["t"].samples for p in (1.0, 2.0))
    assert centroid_hz(high) == pytest.approx(2.0 * centroid_hz(low), rel=0.05)


def test_variant_follows_speed_and_never_repeats_a_take_at_once():
    bank = SoundBank({"hit": SoundSpec(recipe="contact"), "bell": SoundSpec(recipe="goal")}, RATE)
    names = [bank.variant("hit", speed, 0) for speed in (0.0, 0.02, 0.3, 9.0)]
    assert names == ["hit:0:0", "hit:0:0", "hit:4:0", "hit:7:0"]
    assert bank.variant("hit", 0.3, 1) != bank.variant("hit", 0.3, 2)
    assert all(bank.variant("hit", 0.3, turn) in bank for turn in range(7))
    assert bank.variant("bell", 0.3, 1) == "bell"
