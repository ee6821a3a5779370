"""An ECG with beats at known times, of Gaussian waves."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Waves = tuple[tuple[float, float, float], ...]

WAVES: Waves = ((-0.17, 0.12, 0.025), (-0.03, -0.12, 0.010), (0.0, 1.0, 0.011), (0.03, -0.2, 0.011), (0.26, 0.28, 0.05))
"""P, Q, R, S, T: time from the R peak [s], height [mV], width [s]."""


def heart(beats: Floats, rate: float, seconds: float, waves: Waves = WAVES) -> Floats:
    """An ECG with beats at given times [s], and a little noise."""
    values = 0.005 * np.random.default_rng(2).standard_normal(round(seconds * rate))
    for place, height, width in waves:
        for at in (beats + place).tolist():
            begin, end = max(round((at - 6.0 * width) * rate), 0), round((at + 6.0 * width) * rate)
            t = np.arange(begin, min(end, len(values))) / rate
            values[begin : begin + len(t)] += height * np.exp(-0.5 * ((t - at) / width) ** 2)
    return values
