"""Power of the heart-rate variability in a band: ways to it from intervals at the uneven times of the beats.

The intervals follow one sine of known power. Error: root mean square of what LF and HF lose or gain, as a share of that
power, over frequencies of 0.06 to 0.38 Hz at 50 to 110 beats a minute, without and with 5 % of the intervals left out.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, partial
from itertools import product

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.dsp.spectrum import band_power
from mimics_app.lab.probe import shortest_us
from mimics_app.lab.rivals import Probes, Rival, compare

__all__ = ["resampled_power"]

Power = Callable[[F8, F8, float, float], float]
"""Power of intervals [s^2] at the times of their beats [s] between two frequencies [Hz]."""

_RATE_HZ = 4.0
"""Rate of resampling [Hz], the field's usual one."""
_SECONDS = 180.0
"""Window of the spectrum in a session [s]."""
_SWING = 0.04
"""Amplitude of the sine [s]."""
_FREQUENCIES = (0.06, 0.09, 0.12, 0.18, 0.22, 0.26, 0.3, 0.34, 0.38)
_HEARTS = (50.0, 70.0, 90.0, 110.0)
"""[Hz] and [1/min]."""
_LEFT_OUT = (0.0, 0.05)
"""Share of the intervals left out: ectopic beats and artefacts."""
_BANDS = ((0.04, 0.15), (0.15, 0.4))
"""LF and HF [Hz] (Task Force, Circulation 93(5), 1996)."""
_SEED = 3


def _line(times: F8, lengths: F8, at: F8) -> F8:
    return np.interp(at, times, lengths)


def _cubic(times: F8, lengths: F8, at: F8) -> F8:
    from scipy.interpolate import CubicSpline

    return np.asarray(CubicSpline(times, lengths)(at))


def resampled_power(between: Callable[[F8, F8, F8], F8], times: F8, lengths: F8, low: float, high: float) -> float:
    """Return the power by the periodogram, Hann window, of intervals resampled at 4 Hz.

    Args:
        between: Interpolation: values at given times.
        times: Times of the beats that end the intervals [s], shape [n].
        lengths: Their lengths [s], shape [n].
        low: Lower end of the band [Hz].
        high: Upper end [Hz].
    """
    at = np.arange(times[0], times[-1], 1.0 / _RATE_HZ)
    values, window = between(times, lengths, at), np.hanning(len(at))
    density = np.abs(np.fft.rfft(window * (values - values.mean()))) ** 2 * 2.0 / (_RATE_HZ * np.sum(window**2))
    frequency = np.fft.rfftfreq(len(at), 1.0 / _RATE_HZ)
    inside = (frequency >= low) & (frequency <= high)
    return float(density[inside].sum() * _RATE_HZ / len(at))


def _lomb(times: F8, lengths: F8, low: float, high: float) -> float:
    """Return the power by the Lomb-Scargle periodogram, Hann window, without filling what was left out."""
    from scipy.signal import lombscargle

    span = times[-1] - times[0]
    window = np.sin(np.pi * (times - times[0]) / span) ** 2
    step = 0.25 / span
    grid = np.arange(low, high, step)
    found = lombscargle(times, window * (lengths - lengths.mean()), 2.0 * np.pi * grid)
    return float(found.sum() * step * 2.0 * span / np.sum(window**2))


def _waving(heart: float, frequency: float, left_out: float) -> tuple[F8, F8]:
    """Return times and lengths of intervals that follow a sine, some of them left out [s]."""
    times = [0.0]
    while times[-1] < _SECONDS:
        times.append(times[-1] + 60.0 / heart + _SWING * np.sin(2.0 * np.pi * frequency * times[-1]))
    beats = np.array(times)
    keep = np.random.default_rng(_SEED).random(len(beats) - 1) >= left_out
    return beats[1:][keep], np.diff(beats)[keep]


@cache
def _error(power: Power) -> float:
    true, off = 0.5 * _SWING**2, []
    for heart, frequency, left_out in product(_HEARTS, _FREQUENCIES, _LEFT_OUT):
        for low, high in _BANDS:
            found = power(*_waving(heart, frequency, left_out), low, high)
            off.append(found / true - float(low < frequency < high))
    return float(np.sqrt(np.mean(np.square(off))))


def _cost_us(power: Power) -> float:
    """Return the cost of the high band of three minutes at 70 beats a minute [us]."""
    times, lengths = _waving(70.0, 0.25, 0.0)
    return shortest_us(lambda: power(times, lengths, *_BANDS[1]), 1)


compare(
    __name__,
    "LF and HF of intervals that follow a sine, 50 to 110 beats a minute, some left out; error: lost or gained",
    "share of power",
    [
        Rival(
            "line at 4 Hz",
            "intervals resampled by straight lines, periodogram",
            "slow waves of a fast heart",
            probed=(partial(resampled_power, _line),),
        ),
        Rival(
            "cubic at 4 Hz",
            "intervals resampled by a cubic spline, periodogram (Task Force, Circulation 93(5), 1996)",
            "waves slower than a quarter of the heart rate",
            probed=(partial(resampled_power, _cubic),),
        ),
        Rival(
            "Lomb-Scargle",
            "least squares of sines at the times of the beats (Lomb 1976; Scargle 1982)",
            "no intervals left out",
            probed=(_lomb,),
        ),
        Rival(
            "over the beats",
            "Fourier integral over the beats, single ones left out filled in (decision 203)",
            "waves up to half of the heart rate",
            {},
            probed=(band_power,),
        ),
    ],
    Probes(_cost_us, _error),
    default="over the beats",
)
