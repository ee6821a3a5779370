"""Movement: features of the speed of hand and head, and of the mechanical power of the hand."""

from __future__ import annotations

from collections import deque
from typing import ClassVar

import numpy as np

from mimics_app.dsp.channel import Channel, Event, FeatureSet
from mimics_app.dsp.filters import Floats

__all__ = ["Head", "Power", "Speed"]

_WINDOW_S = 10
"""Window of the features of the speed [s]."""


class _Motion(Channel):
    """Speed of a part of the body: mean and smoothness over the last 10 s.

    Attributes:
        part: First word of the features.
        least: Largest speed below which the part is at rest and has no smoothness, in the unit of the signal.
    """

    latency_s: ClassVar[float] = 1.0
    lowest_rate: ClassVar[float] = 20.0
    part: ClassVar[str]
    least: ClassVar[float]

    def __init__(self, rate: float) -> None:
        super().__init__(rate)
        self._seconds: deque[Floats] = deque(maxlen=_WINDOW_S)

    def _take(self, piece: Floats) -> list[Event]:
        return []

    def _look_back(self, raw: Floats) -> FeatureSet:
        self._seconds.append(raw[np.isfinite(raw)])
        speed = np.concatenate(self._seconds)
        if not len(speed):
            return FeatureSet({}, 0.0)
        peak = float(speed.max())
        features = {f"{self.part}_speed": float(np.mean(speed))}
        if peak > self.least:
            turns = int(np.count_nonzero(np.diff(np.sign(np.diff(speed))) < 0))
            features[f"{self.part}_peaks_per_s"] = turns * self.rate / len(speed)
            features[f"{self.part}_evenness"] = float(np.mean(speed) / peak)
        return FeatureSet(features, float(np.isfinite(raw).mean()))


class Speed(_Motion):
    """Speed of the hand [m/s]."""

    name: ClassVar[str] = "speed"
    part: ClassVar[str] = "hand"
    least: ClassVar[float] = 0.01


class Head(_Motion):
    """Angular speed of the head [rad/s]."""

    name: ClassVar[str] = "head"
    part: ClassVar[str] = "head"
    least: ClassVar[float] = 0.05


class Power(Channel):
    """Mechanical power of the person on the device [W]: its mean over a second."""

    name: ClassVar[str] = "power"
    latency_s: ClassVar[float] = 1.0
    lowest_rate: ClassVar[float] = 1.0

    def _take(self, piece: Floats) -> list[Event]:
        return []

    def _look_back(self, raw: Floats) -> FeatureSet:
        good = raw[np.isfinite(raw)]
        if not len(good):
            return FeatureSet({}, 0.0)
        return FeatureSet({"hand_power": float(np.mean(good))}, len(good) / len(raw))
