"""Synthesised sounds of contact and task: knocks, chords, a scrape.

A struck object is a bank of damped modes driven by a pulse of contact force. The sound is the acceleration of the
surface, so each mode responds with the derivative of its damped sine. That derivative begins at its maximum and
integrates to zero: the attack is as short as the pulse, and no sound has a DC offset.
All functions return float32 samples in [-1, 1], shape [n], one channel.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import F4

__all__ = [
    "CONTACT_RMS",
    "CONTACT_SPEEDS",
    "TAKE_SPREAD",
    "synthesise_chord",
    "synthesise_contact",
    "synthesise_grip",
    "synthesise_knock",
    "synthesise_scrape",
    "synthesise_slip",
    "synthesise_struck",
    "synthesise_tick",
]


CONTACT_SPEEDS = (0.02, 0.04, 0.08, 0.15, 0.3, 0.6, 1.0, 1.5)
"""Speed steps for which contacts are synthesised [m/s], ascending."""

CONTACT_RMS = 0.1
"""RMS of every contact over its first 50 ms; the variant with the largest crest factor stays below -1 dBFS."""

TAKE_SPREAD = 0.15
"""Relative variation of mode weights between strike points."""

# Modes of a padded tube: frequency [Hz], T60 [s], weight; inharmonic and short, so that nothing rings like a bell.
_TUBE_MODES = (
    (236.0, 0.130, 0.55),
    (395.0, 0.110, 0.95),
    (643.0, 0.085, 1.00),
    (1021.0, 0.060, 0.90),
    (1570.0, 0.042, 0.80),
    (2390.0, 0.030, 0.70),
    (3610.0, 0.022, 0.60),
    (5400.0, 0.015, 0.50),
)

# Modes of a table board: lower and drier, with a little click.
_WOOD_MODES = (
    (142.0, 0.090, 0.70),
    (287.0, 0.110, 1.00),
    (468.0, 0.095, 0.90),
    (742.0, 0.070, 0.85),
    (1180.0, 0.048, 0.75),
    (1935.0, 0.030, 0.55),
    (3120.0, 0.018, 0.35),
)

# Skin on skin: a few low modes with a short decay.
_PAT_MODES = ((170.0, 0.045, 1.0), (310.0, 0.035, 0.8), (560.0, 0.024, 0.45), (940.0, 0.016, 0.25))

_ASPERITIES, _STROKE_HZ, _RUSH, _GIVES = 240.0, 6.0, 0.5, 3.0
"""Collisions per second, highest frequency at which their number varies [Hz], the rush relative to them, and the RMS
values near which the wall gives way, so that rare collisions do not set the level of all."""

# A felt-like pad stiffens under compression: force ~ compression^p with p about 2.2, so the pulse shortens as
# speed^-((p - 1) / (p + 1)) (Hertz's sphere is the case p = 3/2, exponent -1/5).
_PULSE_AT_ONE = 0.00026
_PULSE_EXPONENT = 0.37
_LOUDNESS_WINDOW_S = 0.05  # begin of a sound, whose root mean square is set [s]
_HIGHEST = 0.88  # peak, -1.1 dBFS: very short sounds would exceed full scale at CONTACT_RMS


def synthesise_contact(speed: float, take: int = 0, rate: int = 48_000) -> F4:
    """Synthesise a soft knock at an impact speed [m/s]: the faster, the shorter the pulse and the brighter the sound.

    Every variant has the same energy in its first 50 ms; the contact law sets the gain. A take is a strike point.
    """
    return _strike(_TUBE_MODES, speed, take, rate)


def synthesise_knock(speed: float, take: int = 0, rate: int = 48_000) -> F4:
    """Synthesise an object put down or dropped on a board; arguments as of `synthesise_contact`."""
    return _strike(_WOOD_MODES, speed, take, rate)


def synthesise_struck(
    modes: tuple[tuple[float, float, float], ...], speed: float, take: int = 0, rate: int = 48_000, pulse: float = 1.0
) -> F4:
    """Synthesise a struck object from its modes: frequency [Hz], T60 [s], weight; a hard one by a shorter pulse."""
    return _strike(modes, speed, take, rate, pulse)


def synthesise_grip(rate: int = 48_000) -> F4:
    """Synthesise a grasp: two soft pats in short succession."""
    length, later = int(0.16 * rate), int(0.034 * rate)
    pat = np.asarray(_strike(_PAT_MODES, 0.05, 0, rate), np.float64)[:length]
    both = np.zeros(length)
    both[: len(pat)] += 0.7 * pat
    both[later:] += pat[: length - later]
    return _finish(both * _fade_out(length, int(0.03 * rate)), peak=0.4)


def synthesise_slip(rate: int = 48_000) -> F4:
    """Synthesise an object slipping out of the fingers: a short scrape with falling pitch."""
    length = int(0.22 * rate)
    time = np.arange(length) / rate
    noise = np.random.default_rng(17).standard_normal(length)
    spectrum = np.fft.rfft(noise)
    frequency = np.fft.rfftfreq(length, 1.0 / rate)
    spectrum *= frequency**2 / (frequency**2 + 300.0**2) / (1.0 + (frequency / 1400.0) ** 2)
    spectrum[0] = 0.0
    friction = np.fft.irfft(spectrum, length)
    friction /= np.abs(friction).max()
    tone = np.sin(2.0 * np.pi * (520.0 * time - 900.0 * time * time))
    shape = np.sin(np.pi * np.minimum(time / 0.22, 1.0)) ** 1.5
    sound = (0.7 * friction + 0.35 * tone) * shape
    return _finish(sound - sound.mean() * shape / shape.mean(), peak=0.4)


def _strike(
    modes: tuple[tuple[float, float, float], ...], speed: float, take: int, rate: int, pulse: float = 1.0
) -> F4:
    """Synthesise modes struck at a speed by a pulse of a relative length, normalised to CONTACT_RMS."""
    force = _force_pulse(speed, rate, pulse)
    length = int(0.25 * rate)
    knock = np.convolve(_response(modes, take, length, rate), force)[:length]
    knock *= _fade_out(length, int(0.02 * rate))
    window = int(_LOUDNESS_WINDOW_S * rate)
    knock *= CONTACT_RMS / np.sqrt(np.mean(knock[:window] ** 2))
    return _finish(knock * min(1.0, _HIGHEST / np.abs(knock).max()), peak=None)


def synthesise_chord(
    notes_hz: tuple[float, ...], spacing_s: float, fall_s: float, rate: int = 48_000, peak: float = 0.5
) -> F4:
    """Synthesise notes in succession on a soft bell, each with its octave and twelfth."""
    length = int((spacing_s * (len(notes_hz) - 1) + fall_s) * rate)
    chord = np.zeros(length)
    for k, note in enumerate(notes_hz):
        begin = int(k * spacing_s * rate)
        time = np.arange(length - begin) / rate
        attack = 0.5 - 0.5 * np.cos(np.pi * np.minimum(time / 0.004, 1.0))
        for partial, weight, share in ((1.0, 1.0, 1.0), (2.0, 0.35, 0.6), (3.0, 0.14, 0.4)):
            chord[begin:] += weight * attack * np.sin(2 * np.pi * note * partial * time) * _fall(time, fall_s * share)
    chord *= _fade_out(length, int(0.05 * rate))
    return _finish(chord, peak)


def synthesise_tick(rate: int = 48_000, frequency: float = 1500.0) -> F4:
    """Synthesise a short dry tick whose first sample has half its peak, so that its onset is easy to detect."""
    length = int(0.03 * rate)
    time = np.arange(length) / rate
    return _finish(_mode_acceleration(time, frequency, 0.02) * _fade_out(length, length // 4), peak=0.6)


def synthesise_scrape(rate: int = 48_000, seconds: float = 4.0, seed: int = 5) -> F4:
    """Synthesise a seamless loop of rubbing along a rough wall: asperities that are met one by one, over a soft rush.

    What slides sounds as single collisions whose number and size vary, where noise of the same bands sounds like wind
    or water (K. van den Doel et al., FoleyAutomatic, 2001: a needle in a surface of random height). The loop is made in
    the frequency domain, periodic by construction.
    """
    length, random = int(seconds * rate), np.random.default_rng(seed)
    frequency = np.fft.rfftfreq(length, 1.0 / rate)
    rise = 1.0 / (1.0 + (180.0 / np.maximum(frequency, 1.0)) ** 4)
    shape = rise / (1.0 + (frequency / 900.0) ** 2)
    shape[0] = 0.0
    wander = np.fft.irfft(np.fft.rfft(random.standard_normal(length)) * (frequency < _STROKE_HZ), length)
    density = _ASPERITIES / rate * np.exp(0.8 * wander / wander.std())
    hits = random.poisson(density) * random.exponential(1.0, length) * random.choice((-1.0, 1.0), length)
    rough = np.fft.irfft(np.fft.rfft(hits) * shape, length)
    rush = np.fft.irfft(shape * np.exp(1j * random.uniform(0.0, 2.0 * np.pi, len(frequency))), length)
    friction = rough / rough.std() + _RUSH * rush / rush.std()
    bounded = np.fft.rfft(np.tanh(friction / (_GIVES * friction.std()))) * rise
    bounded[0] = 0.0
    return _finish(np.fft.irfft(bounded, length), peak=0.65)


def _force_pulse(speed: float, rate: int, relative: float) -> NDArray[np.float64]:
    """Return a half sine to the power 3/2 (Hertz) of unit sum; sampled at half-integers, so that none is zero."""
    duration = relative * _PULSE_AT_ONE * speed**-_PULSE_EXPONENT
    count = max(3, round(duration * rate))
    pulse = np.sin(np.pi * (np.arange(count) + 0.5) / count) ** 1.5
    return np.asarray(pulse / pulse.sum())


@lru_cache(maxsize=8)
def _response(modes: tuple[tuple[float, float, float], ...], take: int, length: int, rate: int) -> NDArray[np.float64]:
    """Return the first `length` samples of modes struck at the point of a take; cached for all speeds."""
    strike = np.random.default_rng(1000 + take).uniform(1.0 - TAKE_SPREAD, 1.0 + TAKE_SPREAD, len(modes))
    response = np.zeros(length)
    for (frequency, fall, weight), shape in zip(modes, strike, strict=True):
        response += weight * shape * _ringing(length, rate, frequency, fall)
    return response


@lru_cache(maxsize=32)
def _ringing(length: int, rate: int, frequency: float, fall_s: float) -> NDArray[np.float64]:
    """`_mode_acceleration` of the first `length` samples, cached for all takes of an object."""
    return _mode_acceleration(np.arange(length) / rate, frequency, fall_s)


def _mode_acceleration(time: NDArray[np.float64], frequency: float, fall_s: float) -> NDArray[np.float64]:
    """Return the derivative of a damped sine, scaled to begin at 1; `fall_s` is its T60."""
    omega = 2.0 * np.pi * frequency
    damping = 3.0 * np.log(10.0) / fall_s
    mode: NDArray[np.float64] = np.exp(-damping * time) * (
        np.cos(omega * time) - damping / omega * np.sin(omega * time)
    )
    mode[0] *= 0.5  # half of the initial jump, so that the samples sum to zero as the integral does
    return mode


def _fall(time: NDArray[np.float64], fall_s: float) -> NDArray[np.float64]:
    return np.asarray(np.exp(-3.0 * np.log(10.0) / fall_s * time))


def _fade_out(length: int, tail: int) -> NDArray[np.float64]:
    window = np.ones(length)
    window[length - tail :] = 0.5 + 0.5 * np.cos(np.pi * (np.arange(tail) + 1) / tail)
    return window


def _finish(samples: NDArray[np.float64], peak: float | None) -> F4:
    if peak is not None:
        samples = samples * (peak / np.abs(samples).max())
    return np.ascontiguousarray(samples, dtype=np.float32)
