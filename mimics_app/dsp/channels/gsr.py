"""Skin conductance: tonic level (SCL), phasic responses (SCRs), signal quality."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from typing import ClassVar

import numpy as np

from mimics_app.contracts.messages.feature_names import (
    PHASIC,
    SCL,
    SCL_SLOPE,
    SCR_RATE,
    SCR_SUM,
)
from mimics_app.dsp.channel import Channel, Event, FeatureSet
from mimics_app.dsp.filters import Floats, delay_of, low_pass
from mimics_app.dsp.kernels.slow import TURN_STATE, find_responses

__all__ = ["CHANNEL", "Gsr"]

_SMOOTH_HZ = 2.0
"""Corner of the low-pass [Hz]."""
_LEAST = 0.02
"""Smallest response that counts in a clean signal [uS]; 0.01 to 0.05 is the convention (Boucsein 2012)."""
_OVER_STEPS, _OVER_NOISE = 1.5, 6.0
"""... and in steps of the converter, and in standard deviations of the noise."""
_QUIET, _LOUD = 0.002, 0.008
"""Noise in the band of the responses at which the quality begins to fall, and at which it is 0 [uS]."""
_FEW = 8
"""Number of different values in a second up to which the converter is coarse: a still second is then no fault."""
_COARSE = 0.004
"""... and step of the converter from which on it is coarse whatever their number [uS]."""
_STILL_S = 40
"""Time after which an unchanged value is no skin in any case [s]."""
_WINDOW_S = 60.0
"""Window of the response rate, their sum and the slope of the level [s]."""
_COVERED = 0.4
"""Share of the window that must be covered by contact for these."""
_TONIC_S = 10.0
"""Window of the tonic level, and longest loss of contact after which the history remains valid [s]."""
_JUMP = 8.0
"""Change of the median level within a second above which the contact is taken as lost [uS]."""


_BLOCKS = 8
"""Means a second from which the noise is taken; responses have no power worth mention at 4 Hz."""
_BAND_HZ = 2.2
"""Noise bandwidth of the low-pass that responses are found in [Hz]."""
_NOISE_WINDOW_S = 10
"""Window of the noise [s]."""
_STEP_S = 30
"""Window of the smallest step [s]."""
_ROUNDING = 1e-6
"""Difference of two samples that are the same value [uS]."""
_LOW, _OF_LOW = 0.3, 0.3853 * 6.0**0.5
"""Quantile of the absolute second differences that is taken, below most of the responses' own, and its value for white
noise in standard deviations."""


class _SkinNoise:
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
        self._means: deque[Floats] = deque(maxlen=_NOISE_WINDOW_S)
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


class Gsr(Channel):
    """SCRs, detected within half a second of their peak; the tonic level is the 20 % quantile of the last 10 s."""

    name: ClassVar[str] = "gsr"
    unit: ClassVar[str] = "µS"
    features: ClassVar[Mapping[str, str]] = {
        SCL: "µS",
        PHASIC: "µS",
        SCR_RATE: "1/min",
        SCR_SUM: "µS/min",
        SCL_SLOPE: "µS/min",
    }
    latency_s: ClassVar[float] = 0.5
    lowest_rate: ClassVar[float] = 4.0
    phase: ClassVar[float] = 0.2

    def __init__(self, rate: float) -> None:
        super().__init__(rate)
        self._sos = low_pass(2, _SMOOTH_HZ, rate)
        self._delay = delay_of(self._sos, 0.2, rate)
        self._z = np.zeros((len(self._sos), 2))
        self._state = np.zeros(1, TURN_STATE)
        self._out = np.zeros((16, 4))
        self._smooth = np.zeros(self._length)
        self._levels: deque[tuple[float, float]] = deque(maxlen=round(_WINDOW_S))
        self._contact_s = 0.0
        self._noise = _SkinNoise(rate)
        self._least = _LEAST
        self._values, self._still_s = 1, 0
        self._responses: deque[tuple[float, float]] = deque()

    def _take(self, piece: Floats) -> list[Event]:
        at = self._place
        smooth = self._smooth[at : at + len(piece)]
        count = find_responses(piece, self._sos, self._z, self._state[0], self.rate, self._least, self._out, smooth)
        events = []
        for peak, known, size, _ in self._out[:count].tolist():
            t_s = max(peak - self._delay, 0.0) / self.rate
            self._responses.append((t_s, size))
            events.append(Event(t_s, (known + 1.0) / self.rate, "scr", size, self.found.quality))
        return events

    def _evaluate(self, raw: Floats) -> FeatureSet:
        now_s = self.samples / self.rate
        quality = self._quality(raw)
        while self._responses and self._responses[0][0] < now_s - _WINDOW_S:
            self._responses.popleft()
        if quality == 0.0:
            if now_s - self._contact_s > _TONIC_S:
                self._levels.clear()
                self._responses.clear()
            return FeatureSet({}, 0.0)
        self._contact_s = now_s
        self._levels.append((now_s, float(self._smooth[-1])))
        times, levels = np.array(self._levels).T
        tonic = float(np.quantile(levels[-round(_TONIC_S) :], 0.2))
        features = {
            SCL: tonic,
            PHASIC: float(self._smooth[-1]) - tonic,
        }
        covered = min(len(levels), _WINDOW_S)
        if covered >= _COVERED * _WINDOW_S:
            features[SCR_RATE] = 60.0 * len(self._responses) / covered
            features[SCR_SUM] = 60.0 * sum(size for _, size in self._responses) / covered
            features[SCL_SLOPE] = float(np.polynomial.polynomial.polyfit((times - now_s) / 60.0, levels, 1)[1])
        return FeatureSet(features, quality)

    def _quality(self, raw: Floats) -> float:
        """Return the share of samples with contact, less for noise in the band of the responses."""
        good = raw[np.isfinite(raw)]
        if not len(good) or not 0.01 < float(np.median(good)) < 100.0:
            return 0.0
        different = len(np.unique(good))
        self._still_s = self._still_s + 1 if different == 1 else 0
        self._values = different if different > 1 else self._values
        coarse = self._values <= _FEW or self._noise.step > _COARSE
        self._noise.take(raw, coarse=coarse)
        self._least = max(_LEAST, _OVER_STEPS * self._noise.step, _OVER_NOISE * self._noise.sd)
        contact = self._contact(raw, steps=_JUMP)
        if coarse and self._still_s < _STILL_S:
            contact = len(good) / len(raw)
        return contact * float(np.clip((_LOUD - self._noise.sd) / (_LOUD - _QUIET), 0.0, 1.0))


CHANNEL = Gsr
