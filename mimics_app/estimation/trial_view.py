"""Feature vector of a trial for the discriminants: body signals at its end, and its success."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.messages.feature_names import BREATH_RATE, RMSSD, SCL, SCR_RATE

__all__ = ["FEATURES", "HEART", "TrialView"]

HEART, SUCCESS = "heart", "success"
"""Heart rate without the effect of work, and the success of the trial: no features of a signal."""
FEATURES = (HEART, SCR_RATE, SCL, RMSSD, BREATH_RATE, SUCCESS)
"""Features of a trial in this order; all but the last in standard deviations from rest."""
_SECONDS = 30
"""Averaging time [s]; the features themselves have windows of up to a minute."""
_MOST = 6.0
"""Limit of a feature [standard deviations]."""
_SUCCESS = (3.0, 0.7)
"""Gain and offset of the success, which scale it to the size of the other features."""


class TrialView:
    """History of the features over the averaging time."""

    def __init__(self) -> None:
        self._rows: deque[list[float]] = deque(maxlen=_SECONDS)

    def see(self, seen: Mapping[str, float]) -> None:
        """Take the features of one second by name, see `FusionEstimation.seen`."""
        self._rows.append([float(np.clip(seen.get(name, np.nan), -_MOST, _MOST)) for name in FEATURES[:-1]])

    def features(self, success: float | None = None) -> F8:
        """Return the means over the averaging time and the success of the trial, shape [f]; NaN where unknown."""
        rows = np.array(self._rows, float).reshape(-1, len(FEATURES) - 1)
        counts = np.isfinite(rows).sum(axis=0)
        means = np.where(counts > 0, np.nansum(rows, axis=0) / np.maximum(counts, 1), np.nan)
        gain, middle = _SUCCESS
        return np.append(means, np.nan if success is None else gain * (success - middle))
