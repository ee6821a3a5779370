"""Sounds against a stated profile: levels in octave bands, and how the level changes with time.

The numbers are those of the sources named at each sound's synthesiser, or stated here where no source has one; a sound
that is a tone, a steady noise or a band cut out of one fails them.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache

import numpy as np
import pytest

from mimics_app.contracts.arrays import F8
from mimics_app.rendering.audio import synth, synth_crowd, synth_scene
from mimics_app.rendering.audio.recipe import Variant, built_in_recipes

RATE = 48_000


def octaves(sound: F8) -> dict[int, float]:
    """Levels of the octave bands from 63 Hz to 16 kHz relative to the whole [dB]."""
    power, frequency = np.abs(np.fft.rfft(sound)) ** 2, np.fft.rfftfreq(len(sound), 1.0 / RATE)
    bands = [63, 125, 250, 500, 1000, 2000, 4000, 8000, 16000]
    shares = [power[(frequency >= b / 2**0.5) & (frequency < b * 2**0.5)].sum() / power.sum() for b in bands]
    return {band: 10.0 * np.log10(share + 1e-12) for band, share in zip(bands, shares, strict=True)}


def share(sound: F8, low: float, high: float) -> float:
    """Share of the energy in a band [Hz]."""
    power, frequency = np.abs(np.fft.rfft(sound)) ** 2, np.fft.rfftfreq(len(sound), 1.0 / RATE)
    return float(power[(frequency >= low) & (frequency < high)].sum() / power.sum())


def level(sound: F8, begin: float, end: float) -> float:
    """RMS between two times [dB of full scale]."""
    return float(20.0 * np.log10(np.sqrt(np.mean(sound[round(begin * RATE) : round(end * RATE)] ** 2)) + 1e-12))


@cache
def crowd(arousal: float) -> F8:
    return synth_crowd.synthesise_crowd(RATE, arousal).astype(np.float64)


@pytest.mark.parametrize(
    ("arousal", "profile"),
    [
        (0.0, {125: -10.0, 250: -1.5, 500: 0.0, 1000: -6.0, 2000: -12.0, 4000: -17.0, 8000: -26.0}),
        (1.0, {125: -12.0, 250: -2.5, 500: 0.0, 1000: -1.0, 2000: -4.0, 4000: -10.0, 8000: -22.0}),
    ],
)
def test_a_crowd_has_the_bands_of_voices(arousal: float, profile: Mapping[int, float]) -> None:
    """Calm: the table of ANSI for normal effort. Roused: 1 to 3 kHz grow by half as much again as the rest."""
    found = octaves(crowd(arousal))
    for band, wanted in profile.items():
        assert found[band] - found[500] == pytest.approx(wanted, abs=3.0), band


@pytest.mark.parametrize("arousal", [0.0, 1.0])
def test_a_crowd_swells(arousal: float) -> None:
    """A quarter of a second of a match is often more than 6 dB louder than another, and a chant has its beat."""
    whole = crowd(arousal)
    parts = [level(whole, t, t + 0.25) for t in np.arange(0.0, 6.0, 0.25)]
    assert np.percentile(parts, 95) - np.percentile(parts, 5) > 6.0
    if arousal > 0.5:
        envelope = np.sqrt(np.mean(whole.reshape(-1, RATE // 100) ** 2, axis=1))
        beats = np.abs(np.fft.rfft(envelope / envelope.mean() - 1.0))
        rates = np.fft.rfftfreq(len(envelope), 0.01)
        chant = beats[(rates > 1.9) & (rates < 2.1)].max()
        assert chant > 2.0 * np.median(beats[(rates > 1.0) & (rates < 4.0)])


def test_a_kick_is_a_thump_and_a_slap() -> None:
    """Over within 60 ms, with as much leather as shell in the first thirty, and no tone that rings on."""
    kick = synth_scene.synthesise_kick().astype(np.float64)
    first = kick[: round(0.03 * RATE)]
    slap, body = share(first, 700.0, 2000.0), share(first, 60.0, 400.0)
    assert abs(10.0 * np.log10(slap / body)) < 6.0
    energy = np.cumsum(kick**2) / np.sum(kick**2)
    assert energy[round(0.06 * RATE)] > 0.99
    assert level(kick, 0.08, 0.12) < level(kick, 0.0, 0.01) - 30.0
    assert np.argmax(np.abs(kick)) < 0.01 * RATE, "the largest sample while foot and ball touch"
    rest = kick[round(0.02 * RATE) :]
    power, frequency = np.abs(np.fft.rfft(rest, 48_000)) ** 2, np.fft.rfftfreq(48_000, 1.0 / RATE)
    loudest = frequency[power.argmax()]
    assert share(np.pad(rest, (0, 48_000 - len(rest))), loudest - 25.0, loudest + 25.0) < 0.5
    assert all(share(first, 0.7 * middle, 1.4 * middle) > 0.02 for middle in (125.0, 250.0, 500.0, 1000.0, 2000.0))


@pytest.mark.parametrize("speed", [0.3, 0.6, 1.5])
def test_a_cup_is_china_and_no_chime(speed: float) -> None:
    """Modes in pairs a tenth apart by the handle, none with a third of the energy; the contact itself is heard."""
    cup = built_in_recipes()["cup"].synthesise(Variant(speed), RATE).astype(np.float64)
    power, frequency = np.abs(np.fft.rfft(cup, 48_000)) ** 2, np.fft.rfftfreq(48_000, 1.0 / RATE)
    loudest = frequency[power.argmax()]
    assert share(np.pad(cup, (0, 48_000 - len(cup))), loudest - 40.0, loudest + 40.0) < 0.34
    assert share(cup, 1550.0, 1720.0) > 0.02 and share(cup, 1720.0, 1900.0) > 0.02
    assert 0.1 < share(cup, 4000.0, 20_000.0) < 0.8
    click, ring = cup[: round(0.004 * RATE)], cup[round(0.01 * RATE) : round(0.03 * RATE)]
    assert share(click, 4800.0, 15_000.0) > 2.0 * share(ring, 4800.0, 15_000.0)
    assert level(cup, 0.1, 0.12) < level(cup, 0.0, 0.01) - 40.0


@pytest.mark.parametrize("take", range(synth_scene.STEP_TAKES))
def test_a_step_on_asphalt_is_heel_and_sole_and_not_gravel(take: int) -> None:
    """Heel first, the sole 3 to 16 dB below it about a tenth of a second later, hardly a sound of the rolling foot."""
    step = synth_scene.synthesise_step("asphalt", take).astype(np.float64)
    heel, sole, rolling, toe = (level(step, *part) for part in ((0.0, 0.03), (0.07, 0.13), (0.19, 0.26), (0.31, 0.37)))
    assert 3.0 < heel - sole < 16.0
    assert rolling < heel - 25.0
    assert toe < heel - 12.0
    assert np.argmax(np.abs(step)) < 0.03 * RATE
    found = octaves(step)
    assert found[1000] > -16.0 and found[2000] > -8.0 and found[8000] > -24.0, "of hard ground, up to the grit"


@pytest.mark.parametrize("take", range(synth_scene.STEP_TAKES))
def test_a_step_on_earth_crumbles(take: int) -> None:
    found = octaves(synth_scene.synthesise_step("earth", take).astype(np.float64))
    assert found[125] > -20.0 and found[250] > -12.0
    assert -42.0 < found[4000] < -12.0, "grains, not a cushion; far below those of grass"


def test_a_scrape_is_rough() -> None:
    """Its level in hundredths of a second varies by a third and more of its mean; that of steady noise by a twelfth.

    Its level is -18 dB of full scale, as of steady noise with a peak of 0.5: single collisions do not make it quiet.
    """
    scrape = synth.synthesise_scrape().astype(np.float64)
    assert level(scrape, 0.0, len(scrape) / RATE) == pytest.approx(-18.0, abs=2.0)
    parts = np.sqrt(np.mean(scrape.reshape(-1, RATE // 100) ** 2, axis=1))
    assert 0.33 < parts.std() / parts.mean() < 0.9
    found = octaves(scrape)
    assert max(found, key=lambda band: found[band]) == 500
    assert found[4000] > -24.0 and found[63] < -30.0
