"""Speed of a part of the body: its mean, and how smooth it is."""

from __future__ import annotations

from collections import deque
from typing import ClassVar

import numpy as np

from mimics_app.dsp.channel import Channel, Event, FeatureSet
from mimics_app.dsp.filters import Floats

__all__ = ["Motion", "motion_features"]

_WINDOW_S = 10
"""Window of the features of the speed [s]."""


class Motion(Channel):
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

    def _evaluate(self, raw: Floats) -> FeatureSet:
        self._seconds.append(raw[np.isfinite(raw)])
        speed = np.concatenate(self._seconds)
        if not len(speed):
            return FeatureSet({}, 0.0)
        peak = float(speed.max())
        mean, turns_of, evenness = motion_features(self.part)
        features = {mean: float(np.mean(speed))}
        if peak > self.least:
            turns = int(np.count_nonzero(np.diff(np.sign(np.diff(speed))) < 0))
            features[turns_of] = turns * self.rate / len(speed)
            features[evenness] = float(np.mean(speed) / peak)
        return FeatureSet(features, float(np.isfinite(raw).mean()))


def motion_features(part: str) -> tuple[str, str, str]:
    """Return the names of the features of a part of the body: mean speed, peaks per second, evenness."""
    return f"{part}_speed", f"{part}_peaks_per_s", f"{part}_evenness"
