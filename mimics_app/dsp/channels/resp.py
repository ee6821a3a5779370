"""Breathing: rate, depth, ratio of in-breath to out-breath, variability, signal quality."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from typing import ClassVar

import numpy as np

from mimics_app.contracts.messages.feature_names import (
    BREATH_DEPTH,
    BREATH_RATE,
    BREATH_RATIO,
    BREATH_VARIABILITY,
)
from mimics_app.dsp.channel import Channel, Event, FeatureSet
from mimics_app.dsp.filters import Floats, band_pass, delay_of
from mimics_app.dsp.kernels.slow import TURN_STATE, find_breaths

__all__ = ["CHANNEL", "Resp"]

_BAND = (0.05, 1.0)
"""Band-pass [Hz]."""
_WINDOW_S = 60.0
"""Window of the variability [s]."""
_FIRST_S = 20.0
"""Time within which the first breath is known [s]."""
_SHORT_S = 25.0
"""Window of rate, depth and ratio [s]."""


class Resp(Channel):
    """Breaths, each detected within a second of the trough that ends it."""

    name: ClassVar[str] = "resp"
    unit: ClassVar[str] = "1"
    features: ClassVar[Mapping[str, str]] = {
        BREATH_RATE: "1/min",
        BREATH_DEPTH: "1",
        BREATH_RATIO: "1",
        BREATH_VARIABILITY: "1",
    }
    latency_s: ClassVar[float] = 1.0
    lowest_rate: ClassVar[float] = 8.0
    phase: ClassVar[float] = 0.6

    def __init__(self, rate: float) -> None:
        super().__init__(rate)
        self._sos = band_pass(1, *_BAND, rate)
        self._delay = delay_of(self._sos, 0.25, rate)
        self._z = np.zeros((len(self._sos), 2))
        self._state = np.zeros(1, TURN_STATE)
        self._out = np.zeros((8, 5))
        self.breaths: deque[tuple[float, float, float, float]] = deque()

    def _take(self, piece: Floats) -> list[Event]:
        count = find_breaths(piece, self._sos, self._z, self._state[0], self.rate, self._out)
        events = []
        for trough, known, depth, rise, whole in self._out[:count].tolist():
            t_s = max(trough - self._delay, 0.0) / self.rate
            self.breaths.append((t_s, depth, rise / self.rate, whole / self.rate))
            events.append(Event(t_s, (known + 1.0) / self.rate, "breath", depth, self.found.quality))
        return events

    def _evaluate(self, raw: Floats) -> FeatureSet:
        now_s = self.samples / self.rate
        quality = self._contact(raw)
        while self.breaths and self.breaths[0][0] < now_s - _WINDOW_S:
            self.breaths.popleft()
        if not self.breaths and now_s < _FIRST_S:
            return FeatureSet({}, quality)
        if quality == 0.0 or not self.breaths or now_s - self.breaths[-1][0] > 20.0:
            return FeatureSet({}, 0.0)
        rows = np.array(self.breaths)
        recent = rows[rows[:, 0] > now_s - _SHORT_S]
        recent = recent if len(recent) >= 2 else rows[-2:]
        lengths = recent[:, 3]
        features = {BREATH_RATE: 60.0 / float(np.mean(lengths)), BREATH_DEPTH: float(np.mean(recent[:, 1]))}
        features[BREATH_RATIO] = float(np.mean(recent[:, 2] / np.maximum(lengths - recent[:, 2], 1e-3)))
        if len(rows) >= 5:
            spread = float(np.std(rows[:, 3], ddof=1) / np.mean(rows[:, 3]))
            features[BREATH_VARIABILITY] = spread
            quality *= float(np.clip(1.6 - 2.0 * spread, 0.1, 1.0))
        return FeatureSet(features, quality)


CHANNEL = Resp
