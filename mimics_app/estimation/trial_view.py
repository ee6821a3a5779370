"""What the body showed towards the end of a trial, and how the trial went, as one feature vector."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

__all__ = ["FEATURES", "TrialView"]

Floats = NDArray[np.float64]

FEATURES = ("heart", "scr_rate", "scl", "rmssd", "breath_rate", "success")
"""Of a trial, in this order; all but the last as standard deviations from rest, at most 6."""
_SECONDS = 30
"""Over which they are averaged: the features themselves look at the minute before."""
_MOST = 6.0
_SUCCESS = (3.0, 0.7)
"""Success is given as three times what it has over 70 %: of the size of the others."""


class TrialView:
    """Keeps the last half minute."""

    def __init__(self) -> None:
        self._rows: deque[list[float]] = deque(maxlen=_SECONDS)

    def see(self, seen: Mapping[str, float]) -> None:
        """A second: features by name, as `FusionEstimation.seen` gives them."""
        self._rows.append([float(np.clip(seen.get(name, np.nan), -_MOST, _MOST)) for name in FEATURES[:-1]])

    def features(self, success: float | None = None) -> Floats:
        """Means of the last half minute and the success of the trial, shape [f]; NaN: not known."""
        rows = np.array(self._rows, float).reshape(-1, len(FEATURES) - 1)
        counts = np.isfinite(rows).sum(axis=0)
        means = np.where(counts > 0, np.nansum(rows, axis=0) / np.maximum(counts, 1), np.nan)
        gain, middle = _SUCCESS
        return np.append(means, np.nan if success is None else gain * (success - middle))
