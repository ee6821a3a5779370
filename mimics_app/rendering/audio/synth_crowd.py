"""Synthesised sound of a crowd in a stadium: shouts, murmur, chant and applause, in waves.

The bands of the whole are those of voices. For normal effort they are those of ANSI, as printed in M. Crocker, Handbook
of Noise and Vibration Control, for male voices at 1 m: 72.5, 74, 68, 62 and 57 dB in the octaves of 250 to 4000 Hz.
With effort the bands from 1 to 3 kHz grow by half as much again as the whole (Nordenberg & Sundberg, Logoped.
Phoniatr. Vocol. 29, 2004), which is what arousal does here. How a crowd swells: in twelve minutes of a match with 89 dB
on average the level rose to 111 dB (P. Mapp, Sound & Communications, Occupational hazards, part 2).
All functions return float32 samples in [-1, 1], shape [n], one channel.
"""

from __future__ import annotations

import math

import numpy as np

from mimics_app.contracts.arrays import F4, F8
from mimics_app.rendering.audio.sound_shapes import fall, finish, periodic_noise

__all__ = ["OCTAVES", "synthesise_crowd"]

OCTAVES = (63.0, 125.0, 250.0, 500.0, 1000.0, 2000.0, 4000.0, 8000.0, 16000.0)
"""Bands of the whole [Hz]."""
_CALM_DB = (-26.0, -10.0, -1.5, 0.0, -6.0, -12.0, -17.0, -26.0, -40.0)
_EFFORT_DB = (0.0, -2.0, -1.0, 0.0, 5.0, 8.0, 7.0, 4.0, 2.0)
"""Level of each band at rest relative to 500 Hz, and what full arousal adds [dB]."""

_VOWELS = ((700.0, 1150.0, 2600.0, 4800.0), (480.0, 900.0, 2500.0, 4400.0), (560.0, 1750.0, 2550.0, 5200.0))
"""Formants [Hz] of the calls a, o and e, and the breath above them."""
_SHOUTS = 7
"""Voices per vowel that stand out of the murmur."""
_CHANT_HZ, _CHANT = 2.0, 1.8
"""Beats of the chant per second, and its level relative to the other voices at full arousal."""
_TURNS = 4
"""Turns in which the levels of the bands are set."""
_WAVES_HZ, _SWELL = 0.5, 0.4
"""Highest frequency of the waves of the whole, and their standard deviation [Np]."""


def synthesise_crowd(rate: int = 48_000, arousal: float = 0.6, seconds: float = 6.0) -> F4:
    """Synthesise a loop of a cheering crowd.

    With arousal the voices are higher and brighter, shout more sharply, chant louder, and clap more.

    Args:
        rate: Samples per second.
        arousal: 0 to 1.
        seconds: Length of the loop.
    """
    random, count = np.random.default_rng(31), int(seconds * rate)
    frequency = np.fft.rfftfreq(count, 1.0 / rate)
    octaves = np.log2(np.maximum(frequency, 1.0))
    beat = _beat(count, rate)
    cheer = np.zeros(count)
    for vowel in _VOWELS:
        throat = sum((_shout(random, count, rate, arousal) for _ in range(_SHOUTS)), start=np.zeros(count))
        swell = 1.0 + 0.5 * periodic_noise(octaves < math.log2(6.0), random, count)
        murmur = swell * periodic_noise(np.ones(len(octaves)), random, count)
        chant = beat * periodic_noise(np.ones(len(octaves)), random, count)
        source = throat / throat.std() + 0.7 * murmur + arousal * _CHANT * chant
        shape = np.zeros(len(octaves))
        for place, width, level in zip(vowel, (0.3, 0.3, 0.35, 0.5), (1.0, 0.7, 0.5, 0.3), strict=True):
            shape += level * np.exp(-0.5 * ((octaves - math.log2(place)) / width) ** 2)
        cheer += np.fft.irfft(np.fft.rfft(source) * (shape + 0.05), count)
    whole = cheer / cheer.std() + (0.1 + 0.8 * arousal) * _clapping(random, count, rate, arousal)
    wave = periodic_noise((frequency > 0.0) & (frequency < max(_WAVES_HZ, 2.0 / seconds)), random, count)
    return finish(_levelled(whole, octaves, arousal) * np.exp(_SWELL * wave))


def _levelled(samples: F8, octaves: F8, arousal: float) -> F8:
    """Give the bands their levels, by a smooth filter over octaves, in turns because the bands overlap in it."""
    bands = np.log2(OCTAVES)
    spectrum = np.fft.rfft(samples) * (octaves > bands[0] - 0.5)
    wanted = np.array(_CALM_DB) + arousal * np.array(_EFFORT_DB)
    for _ in range(_TURNS):
        power = np.abs(spectrum) ** 2
        present = np.array([10.0 * np.log10(power[np.abs(octaves - band) < 0.5].sum() + 1e-12) for band in bands])
        spectrum = spectrum * 10.0 ** (0.05 * np.interp(octaves, bands, wanted - present))
    return np.asarray(np.fft.irfft(spectrum, len(samples)))


def _beat(count: int, rate: int) -> F8:
    """Return the loudness of a chant: a syllable per beat, with a pause after every third one."""
    beats = max(4, 4 * round(_CHANT_HZ * count / rate / 4.0))
    place = np.arange(count) * beats / count
    syllable = np.sin(np.pi * (place % 1.0)) ** 2
    return np.asarray(syllable * (place % 4.0 < 3.0))


def _shout(random: np.random.Generator, count: int, rate: int, arousal: float) -> F8:
    """Return one voice as a periodic train of pulses, with rising and falling pitch; louder while it shouts."""
    turn = 2.0 * np.pi * np.arange(count) / count
    pitch = random.uniform(150.0, 330.0) * (1.0 + 0.35 * arousal)
    shouts, begin, shake = random.integers(1, 4), random.uniform(0.0, 2.0 * np.pi), round(5.5 * count / rate)
    phase = turn * round(pitch * count / rate) - 0.08 * pitch * count / rate / shouts * np.cos(shouts * turn + begin)
    phase += 0.4 * np.sin(shake * turn + begin)
    loud = np.exp((1.0 + 2.0 * arousal) * (np.sin(shouts * turn + begin) - 1.0))
    half = 0.5 * phase
    width = 2 * int(4500.0 / pitch) + 1
    bottom = np.sin(half)
    safe = np.where(np.abs(bottom) < 1e-6, 1.0, bottom)
    return np.asarray(loud * np.where(np.abs(bottom) < 1e-6, width, np.sin(width * half) / safe))


def _clapping(random: np.random.Generator, count: int, rate: int, arousal: float) -> F8:
    """Return periodic applause: claps at random times, each a short band of noise about its own frequency."""
    frequency = np.maximum(np.fft.rfftfreq(count, 1.0 / rate), 1.0)
    hands = np.zeros(count)
    for centre in (1000.0, 1500.0, 2200.0):
        hits = np.zeros(count)
        claps = round((5.0 + 15.0 * arousal) * count / rate)
        hits[random.integers(0, count, claps)] = random.uniform(0.2, 1.0, claps)
        burst = np.zeros(count)
        length = int(0.012 * rate)
        burst[:length] = random.standard_normal(length) * fall(np.arange(length) / rate, 0.012)
        band = np.exp(-0.5 * (np.log2(frequency / centre) / 0.4) ** 2)
        hands += np.fft.irfft(np.fft.rfft(hits) * np.fft.rfft(burst) * band, count)
    return np.asarray(hands / hands.std())
