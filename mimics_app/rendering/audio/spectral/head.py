"""Head-related impulse responses by direction, measured or computed.

Directions are in the frame of the head: x to the right, y up, -z ahead; unit vectors.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mimics_app.contracts.arrays import F8

__all__ = ["HeadResponses", "delays_between_ears", "directions_from_angles"]


LOW_PASS = 1500.0
"""Frequency above which hearing does not use interaural phase delay [Hz]."""


@dataclass(frozen=True, slots=True, eq=False)
class HeadResponses:
    """Head-related impulse responses.

    Attributes:
        directions: Directions of the source, shape [n, 3].
        responses: Left and right ear, shape [n, 2, taps].
        rate: Samples per second.
        name: Name shown to users.
    """

    directions: F8
    responses: F8
    rate: float
    name: str


def directions_from_angles(azimuth: F8, elevation: F8) -> F8:
    """Return unit vectors, shape [n, 3], from azimuth (clockwise) and elevation (upwards) [rad], shape [n]."""
    level = np.cos(elevation)
    return np.stack((level * np.sin(azimuth), np.sin(elevation), -level * np.cos(azimuth)), axis=-1)


def delays_between_ears(responses: F8, rate: float) -> F8:
    """Return the delay of the left ear behind the right [s], shape [n], of responses, shape [n, 2, taps].

    By cross-correlation below 1.5 kHz, oversampled eight times, with parabolic interpolation of the peak: to 0.1 us.
    """
    count = 1 << int(np.ceil(np.log2(2 * responses.shape[-1])))
    fine = 8
    delays = np.zeros(len(responses))
    for begin in range(0, len(responses), 64):
        spectra = np.fft.rfft(responses[begin : begin + 64], count)
        frequency = np.fft.rfftfreq(count, 1.0 / rate)
        cross = spectra[:, 0] * np.conj(spectra[:, 1]) / (1.0 + (frequency / LOW_PASS) ** 8)
        most = int(1.2e-3 * rate * fine)
        correlation = np.roll(np.fft.irfft(cross, count * fine), most, axis=-1)[:, : 2 * most + 1]
        peak = np.clip(np.argmax(correlation, axis=-1), 1, 2 * most - 1)
        row = np.arange(len(peak))
        before, top, after = (correlation[row, peak + k] for k in (-1, 0, 1))
        bend = before - 2.0 * top + after
        share = np.divide(0.5 * (before - after), bend, out=np.zeros_like(bend), where=bend != 0.0)
        delays[begin : begin + 64] = (peak + share - most) / (rate * fine)
    return delays
