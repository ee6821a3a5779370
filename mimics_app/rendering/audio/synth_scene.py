"""Synthesised sounds of the walking and ball scenes: steps, a kick, a crowd, a goal, wind, struck objects.

A step is a sum of grains (small impacts of soil, grass or grit) whose density follows the two peaks of the
ground-reaction force, heel and toe; each grain is a noise burst in the band of the surface. The heel adds a low thud.
Loops are made in the frequency domain, so that they are periodic by construction. All functions return float32 samples
in [-1, 1], shape [n], one channel.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import F4, F8

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
        grains: Grains per second at full force.
        fall: T60 of a grain [s].
        thud: Heel thud: frequency [Hz], T60 [s], level relative to the grains.
        toe: Second peak of the force relative to the first.
    """

    band: float
    width: float
    grains: float
    fall: float
    thud: tuple[float, float, float]
    toe: float


SURFACES = {
    "asphalt": Surface(1400.0, 1.2, 900.0, 0.012, (130.0, 0.09, 0.5), 0.45),
    "grass": Surface(2300.0, 1.1, 2500.0, 0.020, (85.0, 0.08, 0.15), 0.8),
    "wood": Surface(620.0, 1.0, 350.0, 0.030, (170.0, 0.16, 0.7), 0.35),
    "earth": Surface(280.0, 0.9, 700.0, 0.018, (75.0, 0.10, 0.6), 0.5),
}

_STEP_S = 0.6
_HEEL_S, _TOE_S = 0.05, 0.33  # times of the two force peaks after heel strike

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


def synthesise_step(surface: str, take: int = 0, rate: int = 48_000) -> F4:
    """Synthesise a step on a surface; takes differ in every grain. KeyError: no such surface."""
    ground = SURFACES[surface]
    random = np.random.default_rng([7, list(SURFACES).index(surface), take])
    time = np.arange(int(_STEP_S * rate)) / rate
    force = _reaction(time, ground.toe * random.uniform(0.85, 1.15))
    hits = random.poisson(force * ground.grains / rate) * random.exponential(1.0, len(time))
    hits *= random.choice((-1.0, 1.0), len(time))
    grain = random.standard_normal(int(ground.fall * rate)) * _fall(
        np.arange(int(ground.fall * rate)) / rate, ground.fall
    )
    rustle = _convolve(hits, grain)
    rustle = _banded(rustle, ground.band, ground.width, rate)
    frequency, fall, level = ground.thud
    thud = np.sin(2.0 * np.pi * frequency * random.uniform(0.93, 1.07) * time) * _fall(time, fall)
    thud *= 1.0 - np.exp(-time / 0.002)
    step = rustle / np.abs(rustle).max() + level * thud
    return _finish(step * _ends(len(step), rate))


def _reaction(time: F8, toe: float) -> F8:
    """Return the ground-reaction force relative to its first peak: a sharp peak of the heel, a broad one of the toe."""
    heel = (time / _HEEL_S) * np.exp(1.0 - time / _HEEL_S)
    late = np.exp(-0.5 * ((time - _TOE_S) / 0.07) ** 2)
    return np.asarray(heel**1.5 + toe * late)


def synthesise_kick(rate: int = 48_000) -> F4:
    """Synthesise a kicked ball: the slap of leather, then a resonance of the air inside with falling pitch."""
    time = np.arange(int(0.3 * rate)) / rate
    phase = 2.0 * np.pi * (150.0 * time + 70.0 * 0.03 * (1.0 - np.exp(-time / 0.03)))
    body = np.sin(phase) * _fall(time, 0.14)
    slap = np.random.default_rng(23).standard_normal(len(time)) * _fall(time, 0.02)
    slap = _banded(slap, 1700.0, 1.0, rate)
    return _finish((body + 1.4 * slap / np.abs(slap).max()) * _ends(len(time), rate))


def synthesise_crowd(rate: int = 48_000, arousal: float = 0.6, seconds: float = 4.0) -> F4:
    """Synthesise a loop of a cheering crowd: noise with the formants of an open vowel, brighter with arousal.

    Args:
        rate: Samples per second.
        arousal: 0 to 1.
        seconds: Length of the loop.
    """
    random, count = np.random.default_rng(31), int(seconds * rate)
    frequency = np.fft.rfftfreq(count, 1.0 / rate)
    cheer = np.zeros(count)
    for centre, width, weight in (
        (620.0, 0.5, 1.0),
        (1150.0, 0.45, 0.8 + 0.4 * arousal),
        (2500.0, 0.5, 0.2 + 0.8 * arousal),
    ):
        noise = _periodic_noise(
            np.exp(-0.5 * (np.log2(np.maximum(frequency, 1.0) / centre) / width) ** 2), random, count
        )
        swell = 1.0 + 0.5 * _periodic_noise((frequency > 0.0) & (frequency < 6.0), random, count)
        cheer += weight * noise * swell
    return _finish(cheer)


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
    """Synthesise a loop of wind gusts over a canyon: independently modulated noise bands and a hollow tone."""
    random, count = np.random.default_rng(41), int(seconds * rate)
    frequency = np.fft.rfftfreq(count, 1.0 / rate)
    wind = np.zeros(count)
    for centre, width, weight in ((160.0, 0.9, 0.7), (420.0, 0.7, 1.0), (900.0, 0.6, 0.6), (520.0, 0.06, 0.5)):
        noise = _periodic_noise(
            np.exp(-0.5 * (np.log2(np.maximum(frequency, 1.0) / centre) / width) ** 2), random, count
        )
        gust = _periodic_noise((frequency > 0.0) & (frequency < 0.8), random, count)
        wind += weight * noise * np.exp(0.7 * gust)
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
