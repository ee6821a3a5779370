"""Histogram of the working time per block of the audio process."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

__all__ = ["WorkTimes"]

_BIN_NS = 10_000
_BINS = 2000
"""Number of bins, up to 20 ms; the last one also counts longer times."""


class WorkTimes:
    """A histogram with bins of 10 us."""

    def __init__(self) -> None:
        self._counts = np.zeros(_BINS, np.int64)
        self._longest_ns = 0

    def count(self, took_ns: int) -> None:
        """Count the working time of one block [ns]."""
        self._counts[min(took_ns // _BIN_NS, _BINS - 1)] += 1
        self._longest_ns = max(self._longest_ns, took_ns)

    def percentiles_us(self) -> Mapping[str, float]:
        """Return p50 and p99 (upper ends of their bins), max [us] and `count`; empty without counts."""
        total = int(self._counts.sum())
        if total == 0:
            return {}
        ranks = np.searchsorted(np.cumsum(self._counts), [np.ceil(0.50 * total), np.ceil(0.99 * total)])
        p50, p99 = ((ranks + 1) * _BIN_NS * 1e-3).tolist()
        return {"p50": p50, "p99": p99, "max": self._longest_ns * 1e-3, "count": total}
