"""Keeps a live signal honest: gaps become NaN, what comes twice is dropped, drift is followed; all is counted."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.clock import SECOND_NS
from mimics_app.contracts.messages import Experience, SignalBlock

__all__ = ["Faults", "Grid", "LiveSignals"]

_JITTER_S = 0.04
"""Blocks come this much early or late without being a gap or a repetition [s]."""
_LONGEST_GAP_S = 60.0
"""A longer gap is not filled: the signal begins anew."""
_FOLLOW = 0.02
"""Share of a block's lateness by which the grid follows it: at 100 ppm it stays less than a millisecond behind."""
_SETTLED_S = 5.0
_RATE_OFF = 0.02
"""A signal that comes faster or slower than its stated rate by more than this share has another rate."""


@dataclass(slots=True)
class Faults:
    """What was wrong with one signal so far.

    Attributes:
        gaps, lost: How often samples were missing, and how many.
        repeats, dropped: How often samples came twice or late, and how many were dropped for it.
        drift_ppm: How much faster the amplifier's clock runs than ours.
        wrong_rate: The signal does not come at the rate it states.
    """

    gaps: int = 0
    lost: int = 0
    repeats: int = 0
    dropped: int = 0
    drift_ppm: float = 0.0
    wrong_rate: bool = False


class Grid:
    """The regular grid of one signal.

    Args:
        name: Of the signal.
        rate: Stated [Hz].

    Attributes:
        faults: So far.
    """

    def __init__(self, name: str, rate: float) -> None:
        self._name, self._rate = name, rate
        self._start_ns: float | None = None
        self._first_ns = 0
        self._count = 0
        self._received = 0
        self._followed = 0.0
        self.faults = Faults()

    def take(self, t_ns: int, values: NDArray[np.float64]) -> SignalBlock | None:
        """Samples that the source stamped with a time, as they belong on the grid; None where none is left.

        Args:
            t_ns: Of the first of them, on the session's clock.
            values: Shape [n].
        """
        if not len(values):
            return None
        if self._start_ns is None:
            self._start_ns, self._first_ns = float(t_ns), t_ns
        late = (t_ns - self._start_ns) / SECOND_NS - self._count / self._rate
        self._received += len(values)
        if late > _LONGEST_GAP_S:
            self.faults.gaps += 1
            self._start_ns, self._count, late = float(t_ns), 0, 0.0
        elif late > _JITTER_S:
            missing = round(late * self._rate)
            self.faults.gaps += 1
            self.faults.lost += missing
            values = np.concatenate([np.full(missing, np.nan), values])
        elif late < -_JITTER_S:
            twice = min(round(-late * self._rate), len(values))
            self.faults.repeats += 1
            self.faults.dropped += twice
            values = values[twice:]
        else:
            self._follow(late, t_ns)
        block_ns = round(self._start_ns + self._count / self._rate * SECOND_NS)
        self._count += len(values)
        return SignalBlock(self._name, self._rate, block_ns, values) if len(values) else None

    def _follow(self, late: float, t_ns: int) -> None:
        """Let the grid follow the source's clock, and say by how much it runs off ours."""
        step = _FOLLOW * late
        self._start_ns = (self._start_ns or 0.0) + step * SECOND_NS
        self._followed += step
        elapsed = (t_ns - self._first_ns) / SECOND_NS
        if elapsed > _SETTLED_S:
            self.faults.drift_ppm = -1e6 * self._followed / elapsed
            self.faults.wrong_rate = abs(self._received / elapsed / self._rate - 1.0) > _RATE_OFF and elapsed > 30.0


class LiveSignals:
    """What sources of a real person's signals have in common: a grid for each signal, by name."""

    def __init__(self) -> None:
        self._grids: dict[str, Grid] = {}

    @property
    def faults(self) -> Mapping[str, Faults]:
        """Of each signal so far."""
        return {name: grid.faults for name, grid in self._grids.items()}

    def feel(self, experience: Experience) -> None:
        """A real person needs no such message."""
