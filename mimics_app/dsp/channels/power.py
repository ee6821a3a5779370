"""Mechanical power of the hand."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

import numpy as np

from mimics_app.contracts.messages.feature_names import HAND_POWER
from mimics_app.dsp.channel import Channel, Event, FeatureSet
from mimics_app.dsp.filters import Floats

__all__ = ["CHANNEL", "Power"]


class Power(Channel):
    """Mechanical power of the person on the device [W]: its mean over a second."""

    name: ClassVar[str] = "power"
    unit: ClassVar[str] = "W"
    features: ClassVar[Mapping[str, str]] = {HAND_POWER: "W"}
    latency_s: ClassVar[float] = 1.0
    lowest_rate: ClassVar[float] = 1.0

    def _take(self, piece: Floats) -> list[Event]:
        return []

    def _evaluate(self, raw: Floats) -> FeatureSet:
        good = raw[np.isfinite(raw)]
        if not len(good):
            return FeatureSet({}, 0.0)
        return FeatureSet(dict.fromkeys(self.features, float(np.mean(good))), len(good) / len(raw))


CHANNEL = Power
