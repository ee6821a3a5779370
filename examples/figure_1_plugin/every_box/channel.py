"""DSP channel: how far the chest moves in each second."""

from __future__ import annotations

import numpy as np

from mimics_app.dsp.channel import Channel, FeatureSet


class Stretch(Channel):
    """Range of the stretch within a second [mm]."""

    name, unit, features = "stretch", "mm", {"stretch_range": "mm"}
    latency_s, lowest_rate = 1.0, 10.0

    def _take(self, piece):
        return []

    def _evaluate(self, raw):
        good = raw[np.isfinite(raw)]
        quality = len(good) / len(raw)
        return FeatureSet({"stretch_range": float(np.ptp(good))} if len(good) else {}, quality)
