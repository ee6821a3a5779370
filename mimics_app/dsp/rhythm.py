"""Heart rhythm from a stream of R peaks: classification of the RR intervals, heart rate and its variability.

After Lipponen & Tarvainen, J Med Eng Technol 43(3), 2019, made causal: an interval is classified when the next one is
known. Intervals that are not normal are left out of the variability; the spectrum alone fills them in.
"""

from __future__ import annotations

from collections import deque

import numpy as np

from mimics_app.contracts.messages.feature_names import (
    HEART_RATE,
    HF,
    HRV_WINDOW_S,
    LF,
    LF_HF,
    PNN50,
    RMSSD,
    SDNN,
)
from mimics_app.dsp.filters import Floats
from mimics_app.dsp.spectrum import band_power

__all__ = ["Rhythm"]

_LONGEST_S = 200.0
"""Length of the history [s]: LF/HF takes three minutes."""
_WINDOW_S = 60.0
"""Window of SDNN, RMSSD and pNN50 [s]."""
_SPECTRUM_S = 180.0
"""Window of LF and HF [s]."""
_LEAST_SPECTRUM_S = 120.0
"""Shortest history for LF and HF [s]."""
_SPECTRUM_EVERY_S = 5.0
"""Period in which the spectrum is computed anew [s]."""
_LF, _HF = (0.04, 0.15), (0.15, 0.4)
"""Bands of the heart-rate variability [Hz]; Task Force, Circulation 93, 1996."""
_PLAUSIBLE = (0.27, 2.0)
"""Range of plausible RR intervals, 222 to 30 beats a minute [s]."""


class Rhythm:
    """The RR intervals of one person.

    Attributes:
        counts: Number of intervals by class: "normal", "missed" (a beat), "extra", "ectopic".
    """

    def __init__(self) -> None:
        self.counts = {"normal": 0, "missed": 0, "extra": 0, "ectopic": 0}
        self._last: float | None = None
        self._pending: tuple[float, float] | None = None
        self._after_pause = True
        self._recent: deque[float] = deque(maxlen=15)
        self._jumps: deque[float] = deque(maxlen=31)
        self._normal: deque[tuple[float, float, bool]] = deque()
        self._table: Floats | None = None
        self._spectrum_at, self._found_spectrum = -np.inf, dict[str, float]()

    def beat(self, t_s: float) -> float | None:
        """Take a beat at a time [s] and return its RR interval [s], None for the first one after a pause."""
        if self._last is None or t_s - self._last > 2.0 * _PLAUSIBLE[1]:
            self._last, self._pending, self._after_pause = t_s, None, True
            return None
        interval = t_s - self._last
        self._last = t_s
        if self._pending is None:
            self._pending = (t_s, interval)
        else:
            self._pending = self._evaluate(self._pending, (t_s, interval))
        return interval

    def pause(self) -> None:
        """Note that contact was lost: the next beat has no interval."""
        self._last, self._pending, self._after_pause = None, None, True

    def forget(self, since_s: float) -> None:
        """Drop the intervals that ended after a time [s]."""
        while self._normal and self._normal[-1][0] > since_s:
            self._normal.pop()
            self._table = None
        self._pending, self._after_pause = None, True
        self._recent.clear()
        self._jumps.clear()

    def _evaluate(self, first: tuple[float, float], second: tuple[float, float]) -> tuple[float, float] | None:
        """Classify an interval now that the next one is known, and return the one to be classified next."""
        usual = float(np.median(self._recent)) if len(self._recent) >= 3 else first[1]
        limit = max(5.2 * float(np.median(self._jumps)) if len(self._jumps) >= 5 else 0.3 * usual, 0.1 * usual)
        both = first[1] + second[1]
        if first[1] < 0.75 * usual and abs(both - usual) < min(limit, 0.25 * usual):
            self.counts["extra"] += 1
            return second[0], both
        if not _PLAUSIBLE[0] <= first[1] <= _PLAUSIBLE[1] or abs(first[1] - 2.0 * usual) < 0.25 * usual:
            self.counts["missed"] += 1
            self._after_pause = True
        elif first[1] < usual - limit and second[1] > usual + 0.3 * limit:
            self.counts["ectopic"] += 1
            self._after_pause = True
            return None  # the compensatory pause after it is not normal either
        elif abs(first[1] - usual) > 2.0 * limit:
            self.counts["ectopic"] += 1
            self._after_pause = True
        else:
            self._take(first)
        self._jumps.append(min(abs(first[1] - usual), 0.2 * usual))
        self._recent.append(first[1])
        return second

    def _take(self, interval: tuple[float, float]) -> None:
        self.counts["normal"] += 1
        self._normal.append((*interval, not self._after_pause))
        self._table = None
        self._after_pause = False
        while self._normal[-1][0] - self._normal[0][0] > _LONGEST_S:
            self._normal.popleft()

    def intervals(self, since_s: float) -> tuple[Floats, Floats, Floats]:
        """Return times and lengths [s] of the normal intervals since a time, and whether each follows the last."""
        rows = self._rows()
        rows = rows[np.searchsorted(rows[:, 0], since_s) :]
        return rows[:, 0], rows[:, 1], rows[:, 2]

    def _rows(self) -> Floats:
        """Return the normal intervals as a table, cached until there is a new one."""
        if self._table is None:
            self._table = np.array(self._normal, float).reshape(-1, 3)
        return self._table

    def features(self, now_s: float) -> dict[str, float]:
        """Return heart rate and variability; a measure whose window is not covered yet is left out."""
        times, lengths, follows = self.intervals(now_s - _WINDOW_S)
        found: dict[str, float] = {}
        if len(lengths) < 3 or now_s - times[-1] > 5.0:
            return found
        short = lengths[times > now_s - 10.0]
        found[HEART_RATE] = 60.0 / float(np.mean(short if len(short) >= 3 else lengths[-3:]))
        if times[-1] - times[0] < 0.4 * _WINDOW_S or len(lengths) < 15:
            return found
        steps = 1e3 * np.diff(lengths)[follows[1:] > 0.0]
        if len(steps) < 10:
            return found
        found[RMSSD] = float(np.sqrt(np.mean(steps**2)))
        found[SDNN] = 1e3 * float(np.std(lengths, ddof=1))
        found[PNN50] = 100.0 * float(np.mean(np.abs(steps) > 50.0))
        found[HRV_WINDOW_S] = float(min(times[-1] - times[0], _WINDOW_S))
        if now_s - self._spectrum_at >= _SPECTRUM_EVERY_S:
            self._spectrum_at, self._found_spectrum = now_s, self._spectrum(now_s)
        return found | self._found_spectrum

    def _spectrum(self, now_s: float) -> dict[str, float]:
        """Return LF and HF power [ms^2] and their ratio over three minutes, {} before two have passed."""
        times, lengths, _ = self.intervals(now_s - _SPECTRUM_S)
        if len(times) < 60 or times[-1] - times[0] < _LEAST_SPECTRUM_S:
            return {}
        low, high = (band_power(times, 1e3 * lengths, *band) for band in (_LF, _HF))
        return {LF: low, HF: high, **({LF_HF: low / high} if high > 0.0 else {})}
