"""The computed sounds of walking, ball and crowd: their spectra, their seams, and that no two steps are alike."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from mimics_app.rendering.audio import synth_crowd, synth_scene
from mimics_app.rendering.audio.bank import SoundBank
from mimics_app.rendering.audio.recipe import Variant, built_in_recipes
from mimics_app.rendering.audio.settings import SoundSpec
from tests.support.recipe_kit import check_recipe

RATE = 48_000


def centroid(samples: np.ndarray) -> float:
    power = np.abs(np.fft.rfft(samples)) ** 2
    return float(np.sum(power * np.fft.rfftfreq(len(samples), 1 / RATE)) / np.sum(power))


def test_surfaces_are_reported_apart_by_their_brightness():
    """Grass rustles, asphalt grits, wood knocks, earth is dull: each at least half as bright again as the next."""
    means = [
        np.mean([centroid(synth_scene.synthesise_step(s, take)) for take in range(4)])
        for s in ("grass", "asphalt", "wood", "earth")
    ]
    assert all(a > 1.4 * b for a, b in pairwise(means)), means


@pytest.mark.parametrize("surface", list(synth_scene.SURFACES))
def test_a_step_is_loud_where_the_ground_is_loaded(surface):
    """At the heel and the sole, within 0.12 s; the foot rolls quietly, and the toe is heard above that."""
    for take in range(synth_scene.STEP_TAKES):
        step = synth_scene.synthesise_step(surface, take).astype(np.float64)
        heel, rolling, toe = (
            np.sqrt(np.mean(step[round(a * RATE) : round(b * RATE)] ** 2))
            for a, b in ((0.0, 0.04), (0.18, 0.26), (0.31, 0.37))
        )
        assert heel > 2.0 * toe and toe > 1.2 * rolling > 0.0, take
        assert np.argmax(np.abs(step)) < 0.12 * RATE, take


@pytest.mark.parametrize("surface", list(synth_scene.SURFACES))
def test_consecutive_steps_are_never_the_same_recording(surface):
    steps = [synth_scene.synthesise_step(surface, take).astype(np.float64) for take in range(synth_scene.STEP_TAKES)]
    for one, other in pairwise(steps):
        cross = np.fft.irfft(np.fft.rfft(one, 2 * len(one)) * np.conj(np.fft.rfft(other, 2 * len(one))))
        assert np.abs(cross).max() / np.sqrt(np.sum(one**2) * np.sum(other**2)) < 0.9


@pytest.mark.seconds
@pytest.mark.parametrize("name", list(built_in_recipes()))
def test_every_built_in_recipe_passes_the_kit(name):
    """Below full scale, without a constant part, the same at each call, loops without a seam."""
    check_recipe(built_in_recipes()[name])


@pytest.mark.parametrize("name", ["cup", "apple", "table", "tap", "stub_wall", "stub_kerb", "stub_box"])
def test_what_is_struck_harder_is_brighter_and_begins_within_a_millisecond(name):
    slow, fast = (built_in_recipes()[name].synthesise(Variant(speed), RATE).astype(np.float64) for speed in (0.04, 1.5))
    assert centroid(fast) > centroid(slow)
    for samples in (slow, fast):
        assert int(np.argmax(np.abs(samples) > 0.1 * np.abs(samples).max())) <= RATE // 1000


@pytest.mark.seconds
def test_a_roused_crowd_is_brighter_and_a_kick_has_slap_and_body():
    calm, roused = (centroid(synth_crowd.synthesise_crowd(RATE, arousal)) for arousal in (0.0, 1.0))
    assert roused > 1.1 * calm
    kick = np.abs(np.fft.rfft(synth_scene.synthesise_kick().astype(np.float64))) ** 2
    frequency = np.fft.rfftfreq(int(0.3 * RATE), 1 / RATE)
    assert kick[frequency > 700].sum() > 0.1 * kick.sum() and kick[frequency < 400].sum() > 0.2 * kick.sum()


@pytest.mark.seconds
def test_a_crowd_claps_the_more_the_more_it_is_roused_and_a_gust_is_brighter():
    def crest(samples: np.ndarray) -> float:
        """Of the band of claps, above the vowels, in the middle quarter of a second, as the whole has waves."""
        spectrum = np.fft.rfft(samples.astype(np.float64))
        spectrum[np.fft.rfftfreq(len(samples), 1 / RATE) < 2000.0] = 0.0
        band = np.fft.irfft(spectrum, len(samples))
        parts = band.reshape(-1, RATE // 4)
        return float(np.median(np.abs(parts).max(axis=1) / parts.std(axis=1)))

    assert crest(synth_crowd.synthesise_crowd(RATE, 0.8)) > 1.2 * crest(synth_crowd.synthesise_crowd(RATE, 0.0))
    wind = synth_scene.synthesise_wind(RATE).reshape(-1, RATE // 4).astype(np.float64)
    by_level = sorted(wind, key=lambda part: float(np.mean(part**2)))
    assert np.mean([centroid(part) for part in by_level[-6:]]) > 1.2 * np.mean(
        [centroid(part) for part in by_level[:6]]
    )


def test_steps_are_taken_in_turn_whatever_the_speed():
    bank = SoundBank({"step": SoundSpec(recipe="step_grass")}, RATE)
    names = [bank.variant("step", 0.1 * k, k) for k in range(9)]
    assert len(set(names[:8])) == 8 and names[8] == names[0]
