"""Noise and resolution of a skin conductance signal, seen where the skin itself gives nothing: above its band."""

from __future__ import annotations

from collections import deque

import numpy as np

from mimics_app.dsp.filters import Floats

__all__ = ["SkinNoise"]

_BLOCKS = 8
"""Means a second from which the noise is taken; responses have no power worth mention at 4 Hz."""
_BAND_HZ = 2.2
"""Noise bandwidth of the low-pass that responses are found in [Hz]."""
_WINDOW_S = 10
"""Window of the noise [s]."""
_STEP_S = 30
"""Window of the smallest step [s]."""
_ROUNDING = 1e-6
"""Difference of two samples that are the same value [uS]."""
_LOW, _OF_LOW = 0.3, 0.3853 * 6.0**0.5
"""Quantile of the absolute second differences that is taken, below most of the responses' own, and its value for white
noise in standard deviations."""


class SkinNoise:
    """Noise within the band of the responses, from the second differences of means of an eighth of a second.

    Args:
        rate: Sampling rate [Hz].

    Attributes:
        sd: Standard deviation of the noise in the band [uS]; it is assumed to be white.
        step: Smallest step of the converter seen [uS]; 0 before the first.
    """

    def __init__(self, rate: float) -> None:
        self.sd = self.step = 0.0
        self._length = max(round(rate / _BLOCKS), 1)
        self._share = float(np.sqrt(min(_BAND_HZ / (0.5 * rate / self._length), 1.0)))
        self._means: deque[Floats] = deque(maxlen=_WINDOW_S)
        self._steps: deque[float] = deque(maxlen=_STEP_S)

    def take(self, raw: Floats, *, coarse: bool) -> None:
        """Take the samples of one second.

        Args:
            raw: NaN where missing, shape [n].
            coarse: The steps of the converter are seen in the means: they are no noise.
        """
        steps = np.abs(np.diff(raw))
        steps = steps[steps > _ROUNDING]
        if len(steps):
            self._steps.append(float(steps.min()))
            self.step = min(self._steps)
        whole = len(raw) // self._length * self._length
        self._means.append(raw[:whole].reshape(-1, self._length).mean(axis=1))
        means = np.concatenate(self._means)
        bent = np.abs(means[:-2] - 2.0 * means[1:-1] + means[2:])
        bent = bent[np.isfinite(bent)]
        sd = float(np.quantile(bent, _LOW)) / _OF_LOW if len(bent) else 0.0
        flicker = self.step / _OF_LOW if coarse else 0.0
        self.sd = self._share * float(np.sqrt(max(sd * sd - flicker * flicker, 0.0)))
