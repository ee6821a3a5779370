"""Filters: designed by scipy, run by our own kernels, sample by sample, with their state."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

__all__ = ["Floats", "band_pass", "delay_of", "low_pass"]

Floats = NDArray[np.float64]

_HIGHEST = 0.45
"""Corner frequencies stay below this share of the sampling rate."""


@lru_cache(maxsize=64)
def _design(order: int, kind: str, corners: tuple[float, ...], rate: float) -> bytes:
    from scipy.signal import butter  # takes its time to import: only who measures pays for it

    edge = corners[0] if len(corners) == 1 else list(corners)
    sos: Floats = butter(order, edge, kind, fs=rate, output="sos")
    return np.ascontiguousarray(sos).tobytes()


def _sections(order: int, kind: str, corners: tuple[float, ...], rate: float) -> Floats:
    limited = tuple(min(corner, _HIGHEST * rate) for corner in corners)
    return np.frombuffer(_design(order, kind, limited, rate)).reshape(-1, 6).copy()


def band_pass(order: int, low: float, high: float, rate: float) -> Floats:
    """Butterworth band-pass from low to high [Hz] as second order sections, shape [order, 6]."""
    return _sections(order, "bandpass", (min(low, 0.5 * _HIGHEST * rate), high), rate)


def low_pass(order: int, corner: float, rate: float) -> Floats:
    """Butterworth low-pass, shape [ceil(order / 2), 6]."""
    return _sections(order, "lowpass", (corner,), rate)


def delay_of(sos: Floats, frequency: float, rate: float) -> float:
    """Group delay of sections at a frequency [samples]."""

    def phase(f: float) -> float:
        z = np.exp(-2j * np.pi * f / rate)
        response = np.prod([(s[0] + s[1] * z + s[2] * z * z) / (1.0 + s[4] * z + s[5] * z * z) for s in sos])
        return float(np.angle(response))

    step = 0.01 * frequency
    turned = np.angle(np.exp(1j * (phase(frequency + step) - phase(frequency))))
    return float(-turned / (2.0 * np.pi * step) * rate)
