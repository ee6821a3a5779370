"""EMG: envelope, onsets, fatigue by the median frequency, signal quality."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from typing import ClassVar

import numpy as np

from mimics_app.contracts.messages.feature_names import (
    EMG,
    EMG_ACTIVE,
    EMG_FATIGUE,
    EMG_INTEGRATED,
    EMG_MEDIAN_HZ,
)
from mimics_app.dsp.channel import Channel, Event, FeatureSet
from mimics_app.dsp.filters import Floats, band_pass
from mimics_app.dsp.kernels.emg import EMG_STATE, find_onsets

__all__ = ["CHANNEL", "Emg"]

_BAND = (20.0, 450.0)
"""Band-pass of surface EMG [Hz]."""
_FATIGUE_S = 60.0
"""Seconds of activity over which the slope of the median frequency is taken."""


class Emg(Channel):
    """Envelope, onsets (detected within 100 ms of the muscle's) and median frequency."""

    name: ClassVar[str] = "emg"
    unit: ClassVar[str] = "mV"
    features: ClassVar[Mapping[str, str]] = {
        EMG: "mV",
        EMG_INTEGRATED: "mV·s",
        EMG_ACTIVE: "1",
        EMG_MEDIAN_HZ: "Hz",
        EMG_FATIGUE: "Hz/min",
    }
    latency_s: ClassVar[float] = 0.1
    lowest_rate: ClassVar[float] = 200.0
    phase: ClassVar[float] = 0.4

    def __init__(self, rate: float) -> None:
        super().__init__(rate)
        self._sos = band_pass(2, *_BAND, rate)
        self._z = np.zeros((len(self._sos), 2))
        self._state = np.zeros(1, EMG_STATE)
        self._ring = np.zeros(self._length)
        self._out = np.zeros((16, 3))
        self._envelope = np.zeros(self._length)
        self._medians: deque[float] = deque(maxlen=round(_FATIGUE_S))
        self._before = 0.0

    def _take(self, piece: Floats) -> list[Event]:
        at = self._place
        envelope = self._envelope[at : at + len(piece)]
        count = find_onsets(piece, self._sos, self._z, self._state[0], self._ring, self.rate, self._out, envelope)
        return [
            Event(max(onset, 0.0) / self.rate, (known + 1.0) / self.rate, "emg_onset", size, self.found.quality)
            for onset, known, size in self._out[:count].tolist()
        ]

    def _evaluate(self, raw: Floats) -> FeatureSet:
        quality = self._contact(raw)
        total = float(self._state["total"][0])
        integrated, self._before = total - self._before, total
        if quality == 0.0:
            return FeatureSet({}, 0.0)
        n = int(self._state["n"][0]) % self._length
        features = {
            EMG: float(np.mean(self._envelope)),
            EMG_INTEGRATED: integrated,
            EMG_ACTIVE: float(self._state["active"][0]),
        }
        median = self._median_frequency(np.roll(self._ring, -n))
        if self._state["active"][0] > 0.0 and median > 0.0:
            features[EMG_MEDIAN_HZ] = median
            self._medians.append(median)
            if len(self._medians) >= 10:
                minutes = np.arange(len(self._medians)) / 60.0
                slope = np.polynomial.polynomial.polyfit(minutes, np.array(self._medians), 1)[1]
                features[EMG_FATIGUE] = float(slope)
        return FeatureSet(features, quality)

    def _median_frequency(self, second: Floats) -> float:
        """Return the median frequency of the last second's power spectrum [Hz], 0 without power."""
        power = np.abs(np.fft.rfft(second * np.hanning(len(second)))) ** 2
        summed = np.cumsum(power)
        if summed[-1] <= 0.0:
            return 0.0
        return float(np.searchsorted(summed, 0.5 * summed[-1]) * self.rate / len(second))


CHANNEL = Emg
