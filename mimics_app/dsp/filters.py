"""Design of the Butterworth filters by scipy; `kernels.sections` runs them sample by sample."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

__all__ = ["Floats", "band_pass", "delay_of", "low_pass"]

Floats = NDArray[np.float64]

_HIGHEST = 0.45
"""Highest corner frequency as a share of the sampling rate."""


@lru_cache(maxsize=64)
def _design(order: int, kind: str, corners: tuple[float, ...], rate: float) -> bytes:
    from scipy.signal import butter  # slow to import: only sessions with body signals need it

    edge = corners[0] if len(corners) == 1 else list(corners)
    sos: Floats = butter(order, edge, kind, fs=rate, output="sos")
    return np.ascontiguousarray(sos).tobytes()


def _sections(order: int, kind: str, corners: tuple[float, ...], rate: float) -> Floats:
    limited = tuple(min(corner, _HIGHEST * rate) for corner in corners)
    return np.frombuffer(_design(order, kind, limited, rate)).reshape(-1, 6).copy()


def band_pass(order: int, low: float, high: float, rate: float) -> Floats:
    """Return a Butterworth band-pass from low to high [Hz] as second order sections, shape [order, 6]."""
    return _sections(order, "bandpass", (min(low, 0.5 * _HIGHEST * rate), high), rate)


def low_pass(order: int, corner: float, rate: float) -> Floats:
    """Return a Butterworth low-pass as second order sections, shape [ceil(order / 2), 6]; `corner` in [Hz]."""
    return _sections(order, "lowpass", (corner,), rate)


def delay_of(sos: Floats, frequency: float, rate: float) -> float:
    """Return the group delay of second order sections at a frequency [Hz] in samples."""

    def phase(f: float) -> float:
        z = np.exp(-2j * np.pi * f / rate)
        response = np.prod([(s[0] + s[1] * z + s[2] * z * z) / (1.0 + s[4] * z + s[5] * z * z) for s in sos])
        return float(np.angle(response))

    step = 0.01 * frequency
    turned = np.angle(np.exp(1j * (phase(frequency + step) - phase(frequency))))
    return float(-turned / (2.0 * np.pi * step) * rate)
