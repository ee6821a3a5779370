"""How long the audio process works on a block, counted without keeping every one."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

__all__ = ["WorkTimes"]

_BIN_NS = 10_000
_BINS = 2000
"""Up to 20 ms; what takes longer counts there."""


class WorkTimes:
    """A histogram in steps of 10 us."""

    def __init__(self) -> None:
        self._counts = np.zeros(_BINS, np.int64)
        self._longest_ns = 0

    def count(self, took_ns: int) -> None:
        """One block took so long [ns]."""
        self._counts[min(took_ns // _BIN_NS, _BINS - 1)] += 1
        self._longest_ns = max(self._longest_ns, took_ns)

    def percentiles_us(self) -> Mapping[str, float]:
        """p50 and p99, the upper ends of their bins, and max [us], with their `count`; empty of none."""
        total = int(self._counts.sum())
        if total == 0:
            return {}
        ranks = np.searchsorted(np.cumsum(self._counts), [np.ceil(0.50 * total), np.ceil(0.99 * total)])
        p50, p99 = ((ranks + 1) * _BIN_NS * 1e-3).tolist()
        return {"p50": p50, "p99": p99, "max": self._longest_ns * 1e-3, "count": total}
