"""Integrity of live signals: gaps become NaN, repeated samples are dropped, clock drift is followed; all is counted."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.clock import SECOND_NS
from mimics_app.contracts.messages.stage_messages import Experience, SignalBlock

__all__ = ["Faults", "Grid", "LiveSignals"]

_JITTER_S, _JITTER_SAMPLES = 0.04, 0.5
"""Deviation of a block's time stamp that is neither a gap nor a repetition, the longer of the two [s, samples]."""
_SPREADS, _LEAST_LATE_S, _LEAST_LATE_SAMPLES = 4.0, 0.002, 1.5
"""Deviation that is a loss where it stays: so many mean deviations of the stamps, at least the longer of the others."""
_FIRST_SPREAD_S, _SPREAD_FOLLOW = 0.005, 0.05
"""Mean deviation assumed at the beginning [s], and weight of a block in it."""
_STAYS = 5
"""Number of blocks in succession after which a deviation stays."""
_PAUSE_S = 1.0
"""Gap from which on its time does not count in the measured rate [s]; a wrong rate makes many short ones. Stamps that
go back by more, or lie so far ahead of the session, come from a clock that was set."""
_LONGEST_GAP_S = 60.0
"""Deviation beyond which the grid restarts: a long gap [s]."""
_FOLLOW = 0.02
"""Share of a block's lateness by which the grid follows it: at 100 ppm it stays less than a millisecond behind."""
_SETTLING_S = 5.0
"""Time after which the drift is reported [s]."""
_RATE_SETTLING_S = 30.0
"""Time after which the rate is checked [s]."""
_SILENT_NS = 2 * SECOND_NS
"""Time without samples after which a source is taken as lost [ns]."""
_RATE_OFF = 0.02
"""Relative deviation of the measured rate from the stated one above which it is wrong."""


@dataclass(slots=True)
class Faults:
    """Faults of one signal so far.

    Attributes:
        gaps, lost: Number of gaps, and of samples missing in them.
        repeats, dropped: Number of blocks that overlapped earlier ones, and of samples dropped for it.
        clock_sets: Times that the source's clock was set; the samples continue without a gap.
        drift_ppm: Drift of the amplifier's clock against the session's, positive where it runs faster.
        wrong_rate: The measured rate differs from the stated one.
    """

    gaps: int = 0
    lost: int = 0
    repeats: int = 0
    dropped: int = 0
    clock_sets: int = 0
    drift_ppm: float = 0.0
    wrong_rate: bool = False


class Grid:
    """The regular time grid of one signal.

    Args:
        name: Name of the signal.
        rate: Stated sampling rate [Hz].
        counted: The stamps are those of counted samples: they are exact, and any deviation is a loss or a repetition.

    Attributes:
        rate: Stated sampling rate [Hz].
        faults: Faults so far.
    """

    def __init__(self, name: str, rate: float, *, counted: bool = False) -> None:
        self._name, self.rate, self._counted = name, rate, counted
        self._set_ns = 0
        self._jitter_s = _JITTER_SAMPLES / rate if counted else max(_JITTER_S, _JITTER_SAMPLES / rate)
        self._start_ns: float | None = None
        self._first_ns = 0
        self._count = 0
        self._received = 0
        self._followed = 0.0
        self._spread_s = _FIRST_SPREAD_S
        self._staying: list[float] = []
        self.faults = Faults()

    def take(self, t_ns: int, values: NDArray[np.float64], now_ns: int | None = None) -> SignalBlock | None:
        """Place time-stamped samples on the grid; None where none is left.

        Args:
            t_ns: Time of the first of them on the session's clock [ns].
            values: Shape [n].
            now_ns: Time of their arrival [ns]; None: not known.
        """
        if not len(values):
            return None
        t_ns += self._set_ns
        if self._start_ns is None:
            self._start_ns, self._first_ns = float(t_ns), t_ns
        late = (t_ns - self._start_ns) / SECOND_NS - self._count / self.rate
        if self._is_set(late, t_ns, now_ns):
            self.faults.clock_sets += 1
            set_ns = round(late * SECOND_NS)
            self._set_ns, t_ns, late = self._set_ns - set_ns, t_ns - set_ns, 0.0
        self._received += len(values)
        if late > _PAUSE_S:
            self._first_ns += round(late * SECOND_NS)
        if late > _LONGEST_GAP_S:
            self.faults.gaps += 1
            self._start_ns, self._count = float(t_ns), 0
        elif late > self._jitter_s or self._stays(late):
            values = np.concatenate([self._lose(late), values])
        elif late < -self._jitter_s:
            twice = min(round(-late * self.rate), len(values))
            self.faults.repeats += 1
            self.faults.dropped += twice
            values = values[twice:]
        else:
            self._follow(late, t_ns)
        block_ns = round(self._start_ns + self._count / self.rate * SECOND_NS)
        self._count += len(values)
        return SignalBlock(self._name, self.rate, block_ns, values) if len(values) else None

    def _is_set(self, late: float, t_ns: int, now_ns: int | None) -> bool:
        """Return whether the source's clock was set: samples are not repeated for so long, nor sent from the future."""
        if self._counted:
            return False
        return late < -_PAUSE_S or (now_ns is not None and late > 0.0 and t_ns - now_ns > _PAUSE_S * SECOND_NS)

    def _stays(self, late: float) -> bool:
        """Return whether samples were lost: the blocks are late and stay so, by more than their stamps vary."""
        least = max(_SPREADS * self._spread_s, _LEAST_LATE_S, _LEAST_LATE_SAMPLES / self.rate)
        if late < least:
            self._staying.clear()
            self._spread_s += _SPREAD_FOLLOW * (abs(late) - self._spread_s)
            return False
        self._staying.append(late)
        return len(self._staying) >= _STAYS

    def _lose(self, late: float) -> NDArray[np.float64]:
        """Count a gap and return its samples."""
        missing = round(min([late, *self._staying]) * self.rate)
        self._staying.clear()
        self.faults.gaps += 1
        self.faults.lost += missing
        return np.full(missing, np.nan)

    def _follow(self, late: float, t_ns: int) -> None:
        """Let the grid follow the source's clock, and measure its drift and rate."""
        if not self._staying:
            step = _FOLLOW * late
            self._start_ns = (self._start_ns or 0.0) + step * SECOND_NS
            self._followed += step
        elapsed = (t_ns - self._first_ns) / SECOND_NS
        if elapsed > _SETTLING_S:
            self.faults.drift_ppm = -1e6 * self._followed / elapsed
            off = abs(self._received / elapsed / self.rate - 1.0)
            self.faults.wrong_rate = off > _RATE_OFF and elapsed > _RATE_SETTLING_S


class LiveSignals:
    """Base class of the sources of live signals: a grid for each signal, by name.

    Attributes:
        lost: As in `SignalSource`.
    """

    def __init__(self) -> None:
        self.lost = ""
        self._received_ns = 0
        self._grids: dict[str, Grid] = {}

    @property
    def rates(self) -> Mapping[str, float]:
        """Stated rate of each signal [Hz]."""
        return {name: grid.rate for name, grid in self._grids.items()}

    @property
    def faults(self) -> Mapping[str, Faults]:
        """Faults of each signal so far, by its name."""
        return {name: grid.faults for name, grid in self._grids.items()}

    def take_experience(self, experience: Experience) -> None:
        """Do nothing: only simulated bodies react to the movement."""

    def _listen(self, now_ns: int, *, received: bool, source: str) -> None:
        """Note at a read whether there were samples: the source is lost where it is silent for too long."""
        if received:
            self._received_ns, self.lost = now_ns, ""
        elif self._received_ns and now_ns - self._received_ns > _SILENT_NS:
            self.lost = f"{source} is silent"
