"""Power of the heart-rate variability in a band, from intervals at the uneven times of the beats."""

from __future__ import annotations

import numpy as np

from mimics_app.dsp.filters import Floats

__all__ = ["band_power"]

_LONGEST_FILL = 3
"""Largest number of consecutive intervals left out that are filled in."""


def band_power(times: Floats, lengths: Floats, low: float, high: float) -> float:
    """Return the power of RR intervals between two frequencies, in the squared unit of the intervals.

    The Fourier integral over a Hann window is summed over the beats themselves, each weighted by the time around it:
    unlike resampling by interpolation this takes nothing from the fast waves, at any heart rate. Single intervals that
    were left out are filled by a cubic through their neighbours; a hole would spread power over all frequencies.

    Args:
        times: Times of the beats that end the intervals, ascending [s], shape [n].
        lengths: Shape [n].
        low: Lower end of the band [Hz].
        high: Upper end [Hz].
    """
    times, lengths = _filled(times, lengths)
    span = times[-1] - times[0]
    around = np.gradient(times)
    around = np.minimum(around, 2.0 * np.median(around))
    window = np.sin(np.pi * (times - times[0]) / span) ** 2
    weights = window * around
    rest = lengths - np.sum(lengths * weights) / np.sum(weights)
    since = times - np.sum(times * weights) / np.sum(weights)
    rest -= since * np.sum(rest * since * weights) / np.sum(since * since * weights)
    count = int(np.ceil(2.0 * span * (high - low)))
    step = (high - low) / count
    wave = rest * weights * np.exp(-2j * np.pi * (low + 0.5 * step) * since)
    turn = np.exp(-2j * np.pi * step * since)
    power = 0.0
    for _ in range(count):
        power += abs(wave.sum()) ** 2
        wave *= turn
    return float(2.0 * step * power / np.sum(window * weights))


def _filled(times: Floats, lengths: Floats) -> tuple[Floats, Floats]:
    """Return the intervals with short holes filled, each in equal steps, by a cubic through four neighbours."""
    steps = np.diff(times)
    lacking = np.rint(steps / lengths[1:]).astype(int) - 1
    added: list[float] = []
    values: list[float] = []
    for i in np.flatnonzero((lacking > 0) & (lacking <= _LONGEST_FILL)):
        begin = min(max(int(i) - 1, 0), len(times) - 4)
        four = slice(begin, begin + 4)
        places = times[i] + steps[i] * np.arange(1, lacking[i] + 1) / (lacking[i] + 1)
        added += places.tolist()
        values += np.clip(_cubic(times[four], lengths[four], places), lengths.min(), lengths.max()).tolist()
    order = np.argsort(np.append(times, added), kind="stable")
    return np.append(times, added)[order], np.append(lengths, values)[order]


def _cubic(x: Floats, y: Floats, at: Floats) -> Floats:
    """Return the polynomial through points (Lagrange) at places."""
    result = np.zeros(len(at))
    for k in range(len(x)):
        others = np.delete(x, k)
        result += y[k] * np.prod((at[:, None] - others) / (x[k] - others), axis=1)
    return result
