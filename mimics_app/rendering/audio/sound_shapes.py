"""Shapes that synthesised sounds are made of: periodic noise, bands, decays, ends."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import F4, F8

__all__ = ["PEAK", "banded", "convolve", "ends", "fall", "finish", "periodic_noise"]

PEAK = 0.7
"""Peak of every finished sound, -3 dBFS."""


def periodic_noise(shape: F8 | NDArray[np.bool_], random: np.random.Generator, count: int) -> F8:
    """Return periodic noise with a magnitude spectrum, shape [count // 2 + 1]; standard deviation 1."""
    phase = random.uniform(0.0, 2.0 * np.pi, len(shape))
    spectrum = np.asarray(shape, np.float64) * np.exp(1j * phase)
    spectrum[0] = 0.0
    noise = np.fft.irfft(spectrum, count)
    return np.asarray(noise / noise.std())


def banded(samples: F8, centre: float, octaves: float, rate: int) -> F8:
    """Apply a band-pass, Gaussian over octaves."""
    count = 2 * len(samples)
    frequency = np.fft.rfftfreq(count, 1.0 / rate)
    bell = np.exp(-0.5 * (np.log2(np.maximum(frequency, 1.0) / centre) / octaves) ** 2)
    bell[0] = 0.0
    return np.asarray(np.fft.irfft(np.fft.rfft(samples, count) * bell, count)[: len(samples)])


def convolve(samples: F8, response: F8) -> F8:
    """Return the convolution, as long as `samples`."""
    count = len(samples) + len(response)
    return np.asarray(np.fft.irfft(np.fft.rfft(samples, count) * np.fft.rfft(response, count), count)[: len(samples)])


def fall(time: F8, seconds: float) -> F8:
    """Return an exponential decay with this T60 [s]."""
    return np.asarray(np.exp(-3.0 * np.log(10.0) / seconds * time))


def ends(count: int, rate: int) -> F8:
    """Return a window with an attack of 0.5 ms and a fade-out of 30 ms."""
    shape = np.ones(count)
    rise, fade = int(0.0005 * rate), int(0.03 * rate)
    shape[:rise] = np.arange(rise) / rise
    shape[-fade:] = 0.5 + 0.5 * np.cos(np.pi * (np.arange(fade) + 1.0) / fade)
    return shape


def finish(samples: F8) -> F4:
    """Return samples without their mean, with the largest at PEAK."""
    samples = samples - samples.mean()
    return np.ascontiguousarray(samples * (PEAK / np.abs(samples).max()), np.float32)
