"""Smoothness of a movement from its speed: the spectral arc length (SPARC)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["RESAMPLE_HZ", "resample_speed", "sparc"]

RESAMPLE_HZ = 60.0
"""Rate [Hz] of the speed profile passed to `sparc`; three times its widest band, and the usual frame rate."""

_CUTOFF_HZ = 10.0
_AMPLITUDE_THRESHOLD = 0.05
_PAD_LEVEL = 4


def sparc(speed: NDArray[np.float64], rate: float) -> float | None:
    """Spectral arc length of a speed profile; closer to 0 is smoother, one minimum-jerk reach gives -1.41.

    The length of the normalised Fourier magnitude up to the last frequency (at most 10 Hz) where it reaches 0.05, with
    the frequency axis scaled to 1; it depends neither on the movement's amplitude nor on its duration. Balasubramanian,
    Melendez-Calderon, Roby-Brami, Burdet (2015), On the analysis of movement smoothness, Journal of NeuroEngineering
    and Rehabilitation 12:112.

    Args:
        speed: Speed [m/s, any unit], shape [n].
        rate: Its sampling rate [Hz], >= 20.

    Returns:
        The arc length [-], or None where there is no movement to judge (fewer than 4 samples, or all zero).
    """
    if speed.shape[0] < 4 or not speed.any():
        return None
    length = 1 << (int(np.ceil(np.log2(speed.shape[0]))) + _PAD_LEVEL)
    magnitude = np.abs(np.fft.rfft(speed, length))
    band = magnitude[: int(np.floor(_CUTOFF_HZ * length / rate)) + 1]
    band = band / band.max()
    last = int(np.flatnonzero(band >= _AMPLITUDE_THRESHOLD)[-1])
    if last == 0:
        return None
    return -float(np.sum(np.hypot(1.0 / last, np.diff(band[: last + 1]))))


def resample_speed(times_s: NDArray[np.float64], speeds: NDArray[np.float64]) -> NDArray[np.float64]:
    """Speeds at `RESAMPLE_HZ` by linear interpolation.

    Args:
        times_s: When the speeds were seen [s], rising, shape [n].
        speeds: [m/s], shape [n].

    Returns:
        Shape [m], from the first time to the last whole period before the end; empty for fewer than two times.
    """
    if times_s.shape[0] < 2:
        return np.zeros(0)
    count = int(np.floor((times_s[-1] - times_s[0]) * RESAMPLE_HZ + 1e-9)) + 1
    return np.interp(times_s[0] + np.arange(count) / RESAMPLE_HZ, times_s, speeds)
