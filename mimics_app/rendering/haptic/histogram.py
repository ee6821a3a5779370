"""Histograms of lateness and duration: fixed memory, 1.6 % resolution from 1 ns to minutes.

Log-linear bins: 64 of 1 ns below 64 ns, then 64 equal bins for every doubling.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import I8

__all__ = ["LatenessReport", "LinkReport", "count", "edges_ns", "percentile_us"]


_BINS_PER_OCTAVE = 64


@kernel
def count(bins: I8, value_ns: int) -> None:
    """Add one value [ns] to the histogram; negative values count as 0, values beyond the range in the last bin."""
    value = max(value_ns, 0)
    octave = 0
    while value >= 2 * _BINS_PER_OCTAVE:
        value >>= 1
        octave += 1
    index = octave * _BINS_PER_OCTAVE + value
    bins[min(index, bins.shape[0] - 1)] += 1


def edges_ns(bins: int) -> NDArray[np.int64]:
    """Return the lower edge of each bin and the upper edge of the last [ns], shape [bins + 1]."""
    index = np.arange(bins + 1, dtype=np.int64)
    octave = np.maximum(index // _BINS_PER_OCTAVE - 1, 0)
    return (index - octave * _BINS_PER_OCTAVE) << octave


def percentile_us(bins: I8, share: float) -> float:
    """Return the `share` quantile (0-1) of the counts [us], as the centre of its bin; 0 when empty."""
    total = int(bins.sum())
    if total == 0:
        return 0.0
    index = int(np.searchsorted(np.cumsum(bins), max(1.0, share * total)))
    edges = edges_ns(bins.shape[0])
    return float(edges[index] + edges[index + 1] - 1) / 2e3


@dataclass(frozen=True, slots=True)
class LatenessReport:
    """Punctuality of the loop. Lateness, durations and misses are counted after the first second.

    Attributes:
        p50, p99, p99_9, max: Percentiles of the wake-up lateness [us].
        duration_p50, duration_p99: Percentiles of the duration of a tick [us].
        missed: Ticks that ended more than one period after their release.
        held: Late ticks: output held, or more.
        stale: Ticks with stale device data.
        stops: Latched stops.
        holds: Times the force was ramped down for late ticks and returned on its own.
        ticks: Total number of ticks.
        recipe: Scheduler recipe of the thread.
    """

    p50: float
    p99: float
    p99_9: float
    max: float
    duration_p50: float
    duration_p99: float
    missed: int
    held: int
    stale: int
    stops: int
    holds: int
    ticks: int
    recipe: str

    @property
    def missed_share(self) -> float:
        """Missed ticks as a share of all ticks."""
        return self.missed / self.ticks if self.ticks else 0.0

    def as_dict(self) -> dict[str, Any]:
        """Return plain values for the header of a report."""
        return {name: getattr(self, name) for name in self.__slots__} | {"missed_share": self.missed_share}


@dataclass(frozen=True, slots=True)
class LinkReport:
    """Quality of the link to a device, after the first second.

    Attributes:
        fresh_share: Share of the ticks that got new data.
        worst_gap_ms: Largest age of the data that a tick used [ms].
        jitter_us: 99th percentile of that age less its median [us].
    """

    fresh_share: float
    worst_gap_ms: float
    jitter_us: float

    @classmethod
    def of(cls, ages: I8, unread: int) -> LinkReport | None:
        """Return the report of a histogram of ages [ns] and the number of ticks without new data; None of no tick."""
        ticks = int(ages.sum())
        if ticks == 0:
            return None
        p50, p99, most = (percentile_us(ages, share) for share in (0.5, 0.99, 1.0))
        return cls(1.0 - unread / ticks, most / 1e3, p99 - p50)
