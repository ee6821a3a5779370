"""Synthesised sounds of the walking and ball scenes: steps, a kick, a goal, wind, struck objects.

A step is loudest where the ground is loaded, not where the force is largest: at heel strike and when the sole comes
down, with a quiet scuff of the toe. There the modes of the ground are struck, and grains (small impacts of soil, grass
or grit), noise bursts in the band of the surface, are set free. Loops are made in the frequency domain, so that they
are periodic by construction. All functions return float32 samples in [-1, 1], shape [n], one channel.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mimics_app.contracts.arrays import F4, F8
from mimics_app.rendering.audio.sound_shapes import banded, convolve, ends, fall, finish, periodic_noise
from mimics_app.rendering.audio.synth import synthesise_struck
from mimics_app.rendering.audio.synth_crowd import synthesise_crowd

__all__ = [
    "CUP_PULSE",
    "MATERIALS",
    "STEP_TAKES",
    "SURFACES",
    "synthesise_kick",
    "synthesise_score",
    "synthesise_step",
    "synthesise_tone",
    "synthesise_wind",
]


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
        roll: Level of the rolling foot relative to the heel: high where the ground moves under it.
    """

    band: float
    width: float
    grains: float
    fall: float
    knock: float
    speed: float
    modes: tuple[tuple[float, float, float], ...]
    toe: float
    roll: float


_GRIT = ((130.0, 0.06, 0.35), (460.0, 0.024, 0.7), (1050.0, 0.016, 1.0), (2150.0, 0.010, 0.9), (3900.0, 0.007, 0.5))
_BOARDS = ((92.0, 0.15, 0.4), (176.0, 0.18, 1.0), (322.0, 0.13, 0.9), (545.0, 0.09, 0.7), (920.0, 0.05, 0.5))
_SOD = ((85.0, 0.07, 1.0), (150.0, 0.05, 0.6))
_SOIL = ((75.0, 0.09, 1.0), (140.0, 0.06, 0.7), (260.0, 0.03, 0.3))

SURFACES = {
    "asphalt": Surface(1900.0, 1.1, 2500.0, 0.005, 1.1, 0.6, _GRIT, 0.07, 0.006),
    "grass": Surface(2700.0, 0.9, 6000.0, 0.014, 0.15, 0.02, _SOD, 0.20, 0.03),
    "wood": Surface(760.0, 0.9, 900.0, 0.020, 2.5, 0.15, _BOARDS, 0.06, 0.02),
    "earth": Surface(420.0, 1.15, 1500.0, 0.012, 2.4, 0.04, _SOIL, 0.12, 0.03),
}

_STEP_S = 0.6
_HEEL_S, _SOLE_S, _TOE_S = 0.006, 0.09, 0.34
"""Rise of the load at heel strike, and times of sole and toe after it [s] (Ekimov & Sabatier, J. Acoust. Soc. Am. 120,
2006: an impact, and the friction of the rolling foot above 500 Hz; 129, 2011: 0.12 s and more to the shift)."""

_HEEL_END_S, _ALWAYS = 0.04, 0.1
"""End of the heel's part [s], and size of the grains that every heel sets free."""

_SOLE = 0.28
"""Level of the sole coming down relative to the heel."""

_CONTACT_S, _MEETS_S = 0.009, 0.0012
"""Time of contact of foot and ball, and in which the leather meets [s]."""
_SHELL = ((128.0, 0.09, 0.7), (196.0, 0.08, 0.9), (287.0, 0.07, 1.0), (411.0, 0.06, 0.8), (560.0, 0.045, 0.6))
"""Damped modes of ball and air: frequency [Hz], T60 [s], weight."""
_SLAP = ((1150.0, 0.55, 0.0006, 0.08, 1.3), (3400.0, 0.7, 0.0003, 0.02, 0.9))
"""Noise of leather on leather: centre [Hz], octaves, rise and T60 [s], level."""

# Frequency [Hz], T60 [s] and weight of each mode.
_CUP = (
    *((1640.0, 0.11, 0.45), (1790.0, 0.10, 0.40), (2570.0, 0.085, 0.65), (2790.0, 0.08, 0.60)),
    *((4310.0, 0.065, 0.60), (4620.0, 0.06, 0.55), (6120.0, 0.045, 0.65), (8350.0, 0.03, 0.65)),
    *((5230.0, 0.010, 0.5), (7350.0, 0.008, 0.6), (9900.0, 0.007, 0.7), (12400.0, 0.006, 0.6)),
)
"""A china cup: each bending mode twice, with and without the handle, whose mass makes it lower (J. Dooley, The Citizen
Scientist, 3 December 2004); and the dense, short modes of its hard rim, which are heard as the noise of contact."""

CUP_PULSE = 0.4
"""Length of the contact of a cup, which is hard, relative to that of the other materials."""

MATERIALS = {
    "cup": _CUP,
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
    hits *= random.choice((-1.0, 1.0), len(time))
    hits[: int(_HEEL_S * rate)] += random.choice((-1.0, 1.0), int(_HEEL_S * rate)) * _ALWAYS  # no heel is silent
    hits *= _loading(time, sole, ground.toe * random.uniform(0.8, 1.2), ground.roll)
    count = int(ground.fall * rate)
    grain = random.standard_normal(count) * fall(np.arange(count) / rate, ground.fall)
    rustle = banded(convolve(hits, grain), ground.band, ground.width, rate)
    step = rustle / np.abs(rustle[: round(_HEEL_END_S * rate)]).max()
    for begin, level in ((0, 1.0), (round(sole * rate), _SOLE)):
        knock = synthesise_struck(ground.modes, ground.speed, take, rate)
        step[begin : begin + len(knock)] += ground.knock * level * knock / np.abs(knock).max()
    return finish(step * ends(len(step), rate))


def _loading(time: F8, sole: float, toe: float, roll: float) -> F8:
    """Return the activity of the ground relative to heel strike: heel, sole, the rolling foot, and the toe's scuff."""
    heel = _burst(time, _HEEL_S) + _SOLE * _burst(time - sole, 1.5 * _HEEL_S)
    rolling = roll * (1.0 - np.exp(-time / 0.05)) * (time < _TOE_S)
    return np.asarray(heel + rolling + toe * np.exp(-0.5 * ((time - _TOE_S) / 0.035) ** 2))


def _burst(time: F8, rise: float) -> F8:
    """Return a burst that rises to 1 within `rise` [s] after 0 and then decays."""
    after = np.maximum(time, 0.0) / rise
    return np.asarray(after * np.exp(1.0 - after))


def synthesise_kick(rate: int = 48_000) -> F4:
    """Synthesise a kicked ball: the thump of its shell in contact with the foot, and the slap of leather.

    The force on the foot is like a half sine (J. Tol et al., 2002, as T. Iga et al. report in Basic mechanical analysis
    of soccer ball impact), here of 9 ms; the thump is as short as the contact (J. Katz, Eur. J. Phys. 31, 2010).
    """
    time, random = np.arange(int(0.3 * rate)) / rate, np.random.default_rng(23)
    force = np.where(time < _CONTACT_S, np.abs(np.sin(np.pi * time / _CONTACT_S)) ** 1.5, 0.0)
    thump = np.gradient(force)
    shell = np.zeros(len(time))
    for frequency, seconds, weight in _SHELL:
        omega, damping = 2.0 * np.pi * frequency, 3.0 * np.log(10.0) / seconds
        ringing = np.exp(-damping * time) * (np.cos(omega * time) - damping / omega * np.sin(omega * time))
        shell += weight * ringing * (1.0 - np.exp(-time / _MEETS_S))
    parts = [(thump, 0.6), (shell, 1.0)]
    for centre, octaves, rise, seconds, level in _SLAP:
        burst = random.standard_normal(len(time)) * fall(time, seconds) * (1.0 - np.exp(-time / rise))
        parts.append((banded(burst, centre, octaves, rate), level))
    kick = sum((level * part / np.abs(part).max() for part, level in parts), start=np.zeros(len(time)))
    return finish(kick * ends(len(time), rate))


def synthesise_score(rate: int = 48_000) -> F4:
    """Synthesise a scored goal: three rising notes of a horn over the crowd."""
    count = int(1.8 * rate)
    sound = 0.35 * synthesise_crowd(rate, 1.0, 1.8).astype(np.float64)
    for k, note in enumerate((392.0, 523.25, 659.26)):
        time = np.arange(count - int(0.16 * k * rate)) / rate
        tone = sum(np.sin(2.0 * np.pi * note * n * time) / n for n in range(1, 7))
        sound[-len(time) :] += 0.25 * tone * fall(time, 1.4) * (1.0 - np.exp(-time / 0.01))
    return finish(sound * ends(count, rate))


def synthesise_wind(rate: int = 48_000, seconds: float = 6.0) -> F4:
    """Synthesise a loop of wind gusts over a canyon: noise bands and a hollow tone; a stronger gust is brighter."""
    random, count = np.random.default_rng(41), int(seconds * rate)
    frequency = np.fft.rfftfreq(count, 1.0 / rate)
    gust = periodic_noise((frequency > 0.0) & (frequency < 0.8), random, count)
    wind = np.zeros(count)
    for centre, width, weight, rise in _WIND:
        noise = periodic_noise(
            np.exp(-0.5 * (np.log2(np.maximum(frequency, 1.0) / centre) / width) ** 2), random, count
        )
        own = periodic_noise((frequency > 0.0) & (frequency < 3.0), random, count)
        wind += weight * noise * np.exp(rise * gust + 0.2 * own)
    return finish(wind)


def synthesise_tone(notes_hz: tuple[float, ...], rate: int = 48_000) -> F4:
    """Synthesise a user-interface tone: notes of 90 ms each."""
    parts = []
    for note in notes_hz:
        time = np.arange(int(0.09 * rate)) / rate
        parts.append(np.sin(2.0 * np.pi * note * time) * np.sin(np.pi * time / 0.09) ** 2)
    return finish(np.concatenate(parts))
