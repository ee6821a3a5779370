"""Synthesised sounds of the walking and ball scenes: steps, a kick, a crowd, a goal, wind, struck objects.

A step is loudest where the ground is loaded, not where the force is largest: at heel strike and when the sole comes
down, with a quiet scuff of the toe. There the modes of the ground are struck, and grains (small impacts of soil, grass
or grit), noise bursts in the band of the surface, are set free. Loops are made in the frequency domain, so that they
are periodic by construction. All functions return float32 samples in [-1, 1], shape [n], one channel.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import F4, F8
from mimics_app.rendering.audio.synth import synthesise_struck

__all__ = [
    "MATERIALS",
    "STEP_TAKES",
    "SURFACES",
    "synthesise_crowd",
    "synthesise_kick",
    "synthesise_score",
    "synthesise_step",
    "synthesise_tone",
    "synthesise_wind",
]


PEAK = 0.7
"""Peak of every sound of this module, -3 dBFS."""

STEP_TAKES = 8
"""Variants of a step per surface; they alternate."""


@dataclass(frozen=True, slots=True)
class Surface:
    """A ground surface.

    Attributes:
        band: Centre frequency of its grains [Hz].
        width: Bandwidth to either side [octaves].
        grains: Grains per second at heel strike.
        fall: T60 of a grain [s].
        knock: Level of the struck modes relative to the grains.
        speed: Impact speed of the heel, which sets the length of its pulse [m/s]: a soft ground makes it slow.
        modes: Frequency [Hz], T60 [s] and weight of each mode of the ground.
        toe: Level of the toe relative to the heel.
    """

    band: float
    width: float
    grains: float
    fall: float
    knock: float
    speed: float
    modes: tuple[tuple[float, float, float], ...]
    toe: float


_GRIT = ((130.0, 0.06, 0.35), (460.0, 0.024, 0.7), (1050.0, 0.016, 1.0), (2150.0, 0.010, 0.9), (3900.0, 0.007, 0.5))
_BOARDS = ((92.0, 0.15, 0.4), (176.0, 0.18, 1.0), (322.0, 0.13, 0.9), (545.0, 0.09, 0.7), (920.0, 0.05, 0.5))
_SOD = ((85.0, 0.07, 1.0), (150.0, 0.05, 0.6))
_SOIL = ((75.0, 0.09, 1.0), (140.0, 0.06, 0.7), (260.0, 0.03, 0.3))

SURFACES = {
    "asphalt": Surface(1500.0, 1.0, 2500.0, 0.008, 1.0, 0.6, _GRIT, 0.10),
    "grass": Surface(2700.0, 0.9, 6000.0, 0.014, 0.15, 0.02, _SOD, 0.25),
    "wood": Surface(760.0, 0.9, 900.0, 0.020, 2.5, 0.15, _BOARDS, 0.06),
    "earth": Surface(300.0, 0.8, 1500.0, 0.016, 0.8, 0.02, _SOIL, 0.12),
}

_VOWELS = ((700.0, 1150.0, 2600.0, 4800.0), (480.0, 900.0, 2500.0, 4400.0), (560.0, 1750.0, 2550.0, 5200.0))
"""Formants [Hz] of the calls a, o and e, and the breath above them."""

_SHOUTS = 7
"""Voices per vowel that stand out of the murmur."""

_STEP_S = 0.6
_HEEL_S, _SOLE_S, _TOE_S = 0.008, 0.075, 0.34
"""Rise of the load at heel strike, and times of sole and toe after it [s] (Ekimov & Sabatier, J. Acoust. Soc. Am. 120,
2006: an impact below 0.1 s, then the friction of the rolling foot)."""

_SOLE, _ROLL = 0.4, 0.04
"""Level of the sole coming down, and of the rolling foot, relative to the heel."""

# Frequency [Hz], T60 [s] and weight of each mode.
MATERIALS = {
    "cup": ((1730.0, 0.16, 0.7), (2890.0, 0.12, 1.0), (4310.0, 0.09, 0.9), (6120.0, 0.06, 0.7), (8350.0, 0.04, 0.4)),
    "apple": ((310.0, 0.035, 1.0), (540.0, 0.026, 0.9), (910.0, 0.018, 0.6), (1450.0, 0.012, 0.3)),
    "table": ((148.0, 0.10, 0.6), (322.0, 0.12, 1.0), (561.0, 0.09, 0.9), (934.0, 0.06, 0.7), (1720.0, 0.035, 0.4)),
    "wall": ((95.0, 0.05, 0.8), (210.0, 0.05, 1.0), (420.0, 0.035, 0.7), (860.0, 0.02, 0.4)),
    "kerb": ((260.0, 0.03, 0.8), (640.0, 0.025, 1.0), (1480.0, 0.018, 0.9), (3050.0, 0.012, 0.6)),
    "box": ((118.0, 0.12, 1.0), (243.0, 0.11, 0.9), (395.0, 0.08, 0.7), (702.0, 0.05, 0.5)),
    "tap": ((720.0, 0.020, 0.8), (1650.0, 0.014, 1.0), (3400.0, 0.010, 0.8)),
}
"""Modes of struck objects, among them the obstacles for the feet (D2.1 4.3)."""


_WIND = (
    (180.0, 0.8, 0.6, 0.35),
    (420.0, 0.7, 1.0, 0.5),
    (950.0, 0.6, 0.5, 0.75),
    (2100.0, 0.6, 0.18, 1.0),
    (520.0, 0.05, 0.4, 0.6),
)
"""Bands of the wind: centre [Hz], width [octaves], weight, and growth with a gust [Np]; the last one is the tone."""


def synthesise_step(surface: str, take: int = 0, rate: int = 48_000) -> F4:
    """Synthesise a step on a surface; takes differ in every grain. KeyError: no such surface."""
    ground = SURFACES[surface]
    random = np.random.default_rng([7, list(SURFACES).index(surface), take])
    time = np.arange(int(_STEP_S * rate)) / rate
    sole = _SOLE_S * random.uniform(0.85, 1.15)
    hits = random.poisson(ground.grains / rate, len(time)) * random.exponential(1.0, len(time))
    hits *= random.choice((-1.0, 1.0), len(time)) * _loading(time, sole, ground.toe * random.uniform(0.8, 1.2))
    count = int(ground.fall * rate)
    grain = random.standard_normal(count) * _fall(np.arange(count) / rate, ground.fall)
    rustle = _banded(_convolve(hits, grain), ground.band, ground.width, rate)
    step = rustle / np.abs(rustle).max()
    for begin, level in ((0, 1.0), (round(sole * rate), _SOLE)):
        knock = synthesise_struck(ground.modes, ground.speed, take, rate)
        step[begin : begin + len(knock)] += ground.knock * level * knock / np.abs(knock).max()
    return _finish(step * _ends(len(step), rate))


def _loading(time: F8, sole: float, toe: float) -> F8:
    """Return the activity of the ground relative to heel strike: heel, sole, the rolling foot, and the toe's scuff."""
    heel = _burst(time, _HEEL_S) + _SOLE * _burst(time - sole, 1.5 * _HEEL_S)
    rolling = _ROLL * (1.0 - np.exp(-time / 0.05)) * (time < _TOE_S)
    return np.asarray(heel + rolling + toe * np.exp(-0.5 * ((time - _TOE_S) / 0.035) ** 2))


def _burst(time: F8, rise: float) -> F8:
    """Return a burst that rises to 1 within `rise` [s] after 0 and then decays."""
    after = np.maximum(time, 0.0) / rise
    return np.asarray(after * np.exp(1.0 - after))


def synthesise_kick(rate: int = 48_000) -> F4:
    """Synthesise a kicked ball: the slap of leather, then a resonance of the air inside with falling pitch."""
    time = np.arange(int(0.3 * rate)) / rate
    phase = 2.0 * np.pi * (150.0 * time + 70.0 * 0.03 * (1.0 - np.exp(-time / 0.03)))
    body = np.sin(phase) * _fall(time, 0.14)
    slap = np.random.default_rng(23).standard_normal(len(time)) * _fall(time, 0.02)
    slap = _banded(slap, 1700.0, 1.0, rate)
    return _finish((body + 1.4 * slap / np.abs(slap).max()) * _ends(len(time), rate))


def synthesise_crowd(rate: int = 48_000, arousal: float = 0.6, seconds: float = 4.0) -> F4:
    """Synthesise a loop of a cheering crowd: shouting voices and murmur through the formants of vowels, and applause.

    With arousal the voices are higher and brighter, shout more sharply, and clap more.

    Args:
        rate: Samples per second.
        arousal: 0 to 1.
        seconds: Length of the loop.
    """
    random, count = np.random.default_rng(31), int(seconds * rate)
    octaves = np.log2(np.maximum(np.fft.rfftfreq(count, 1.0 / rate), 1.0))
    levels = (1.0, 0.6 + 0.4 * arousal, 0.2 + 0.5 * arousal, 0.05 + 0.25 * arousal)
    cheer = np.zeros(count)
    for vowel in _VOWELS:
        throat = sum((_shout(random, count, rate, arousal) for _ in range(_SHOUTS)), start=np.zeros(count))
        swell = 1.0 + 0.5 * _periodic_noise(octaves < math.log2(6.0), random, count)
        source = throat / throat.std() + 0.7 * swell * _periodic_noise(np.ones(len(octaves)), random, count)
        shape = np.zeros(len(octaves))
        for place, width, level in zip(vowel, (0.3, 0.3, 0.35, 0.5), levels, strict=True):
            shape += level * np.exp(-0.5 * ((octaves - math.log2(place)) / width) ** 2)
        cheer += np.fft.irfft(np.fft.rfft(source) * shape, count)
    return _finish(cheer / cheer.std() + (0.2 + 0.5 * arousal) * _clapping(random, count, rate, arousal))


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
        burst[:length] = random.standard_normal(length) * _fall(np.arange(length) / rate, 0.012)
        band = np.exp(-0.5 * (np.log2(frequency / centre) / 0.4) ** 2)
        hands += np.fft.irfft(np.fft.rfft(hits) * np.fft.rfft(burst) * band, count)
    return np.asarray(hands / hands.std())


def synthesise_score(rate: int = 48_000) -> F4:
    """Synthesise a scored goal: three rising notes of a horn over the crowd."""
    count = int(1.8 * rate)
    sound = 0.35 * synthesise_crowd(rate, 1.0, 1.8).astype(np.float64)
    for k, note in enumerate((392.0, 523.25, 659.26)):
        time = np.arange(count - int(0.16 * k * rate)) / rate
        tone = sum(np.sin(2.0 * np.pi * note * n * time) / n for n in range(1, 7))
        sound[-len(time) :] += 0.25 * tone * _fall(time, 1.4) * (1.0 - np.exp(-time / 0.01))
    return _finish(sound * _ends(count, rate))


def synthesise_wind(rate: int = 48_000, seconds: float = 6.0) -> F4:
    """Synthesise a loop of wind gusts over a canyon: noise bands and a hollow tone; a stronger gust is brighter."""
    random, count = np.random.default_rng(41), int(seconds * rate)
    frequency = np.fft.rfftfreq(count, 1.0 / rate)
    gust = _periodic_noise((frequency > 0.0) & (frequency < 0.8), random, count)
    wind = np.zeros(count)
    for centre, width, weight, rise in _WIND:
        noise = _periodic_noise(
            np.exp(-0.5 * (np.log2(np.maximum(frequency, 1.0) / centre) / width) ** 2), random, count
        )
        own = _periodic_noise((frequency > 0.0) & (frequency < 3.0), random, count)
        wind += weight * noise * np.exp(rise * gust + 0.2 * own)
    return _finish(wind)


def synthesise_tone(notes_hz: tuple[float, ...], rate: int = 48_000) -> F4:
    """Synthesise a user-interface tone: notes of 90 ms each."""
    parts = []
    for note in notes_hz:
        time = np.arange(int(0.09 * rate)) / rate
        parts.append(np.sin(2.0 * np.pi * note * time) * np.sin(np.pi * time / 0.09) ** 2)
    return _finish(np.concatenate(parts))


def _periodic_noise(shape: F8 | NDArray[np.bool_], random: np.random.Generator, count: int) -> F8:
    """Return periodic noise with a magnitude spectrum, shape [count // 2 + 1]; standard deviation 1."""
    phase = random.uniform(0.0, 2.0 * np.pi, len(shape))
    spectrum = np.asarray(shape, np.float64) * np.exp(1j * phase)
    spectrum[0] = 0.0
    noise = np.fft.irfft(spectrum, count)
    return np.asarray(noise / noise.std())


def _banded(samples: F8, centre: float, octaves: float, rate: int) -> F8:
    """Apply a band-pass, Gaussian over octaves."""
    count = 2 * len(samples)
    frequency = np.fft.rfftfreq(count, 1.0 / rate)
    bell = np.exp(-0.5 * (np.log2(np.maximum(frequency, 1.0) / centre) / octaves) ** 2)
    bell[0] = 0.0
    return np.asarray(np.fft.irfft(np.fft.rfft(samples, count) * bell, count)[: len(samples)])


def _convolve(samples: F8, response: F8) -> F8:
    """Return the convolution, as long as `samples`."""
    count = len(samples) + len(response)
    return np.asarray(np.fft.irfft(np.fft.rfft(samples, count) * np.fft.rfft(response, count), count)[: len(samples)])


def _fall(time: F8, seconds: float) -> F8:
    """Return an exponential decay with this T60 [s]."""
    return np.asarray(np.exp(-3.0 * np.log(10.0) / seconds * time))


def _ends(count: int, rate: int) -> F8:
    """Return a window with an attack of 0.5 ms and a fade-out of 30 ms."""
    shape = np.ones(count)
    rise, fade = int(0.0005 * rate), int(0.03 * rate)
    shape[:rise] = np.arange(rise) / rise
    shape[-fade:] = 0.5 + 0.5 * np.cos(np.pi * (np.arange(fade) + 1.0) / fade)
    return shape


def _finish(samples: F8) -> F4:
    samples = samples - samples.mean()
    return np.ascontiguousarray(samples * (PEAK / np.abs(samples).max()), np.float32)
