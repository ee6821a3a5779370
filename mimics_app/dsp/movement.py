"""Movement: features of the speed of the hand and of its mechanical power."""

from __future__ import annotations

from collections import deque
from typing import ClassVar

import numpy as np

from mimics_app.dsp.channel import Channel, Event, Found
from mimics_app.dsp.filters import Floats

__all__ = ["Power", "Speed"]

_WINDOW_S = 10
"""Window of the features of the speed [s]."""


class Speed(Channel):
    """Speed of the hand [m/s]: mean and smoothness over the last 10 s."""

    name: ClassVar[str] = "speed"
    latency_s: ClassVar[float] = 1.0
    lowest_rate: ClassVar[float] = 20.0

    def __init__(self, rate: float) -> None:
        super().__init__(rate)
        self._seconds: deque[Floats] = deque(maxlen=_WINDOW_S)

    def _take(self, piece: Floats) -> list[Event]:
        return []

    def _look_back(self, raw: Floats) -> Found:
        self._seconds.append(raw[np.isfinite(raw)])
        speed = np.concatenate(self._seconds)
        if not len(speed):
            return Found({}, 0.0)
        peak = float(speed.max())
        features = {"hand_speed": float(np.mean(speed))}
        if peak > 0.01:  # a hand at rest has no smoothness
            turns = int(np.count_nonzero(np.diff(np.sign(np.diff(speed))) < 0))
            features["hand_peaks_per_s"] = turns * self.rate / len(speed)
            features["hand_evenness"] = float(np.mean(speed) / peak)
        return Found(features, float(np.isfinite(raw).mean()))


class Power(Channel):
    """Mechanical power of the person on the device [W]: its mean over a second."""

    name: ClassVar[str] = "power"
    latency_s: ClassVar[float] = 1.0
    lowest_rate: ClassVar[float] = 1.0

    def _take(self, piece: Floats) -> list[Event]:
        return []

    def _look_back(self, raw: Floats) -> Found:
        good = raw[np.isfinite(raw)]
        if not len(good):
            return Found({}, 0.0)
        return Found({"hand_power": float(np.mean(good))}, len(good) / len(raw))
