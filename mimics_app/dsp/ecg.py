"""ECG: R peaks, rhythm, quality."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from mimics_app.dsp.channel import Channel, Event, Found
from mimics_app.dsp.filters import Floats, band_pass, delay_of
from mimics_app.dsp.kernels.ecg import ECG_STATE, LAST, MISSING, NPK, SPK, UNSTEADY, find_beats
from mimics_app.dsp.rhythm import Rhythm

__all__ = ["TUNING", "Ecg"]

BANDS = ((8.2, 29.0), (15.0, 40.0))
"""Lower and upper [Hz]."""
ORDER = 2

TUNING = np.array(
    [
        0.101,  # window of the energy [s]
        0.091,  # a peak of the energy stands when nothing larger came for so long [s]
        0.218,  # no two beats nearer than this [s]
        3.0,  # levels are taken from so much of the beginning [s]: two beats of a slow heart
        0.601,  # ... or when the energy fell below this share of it
        1.813,  # a beat is missing after so many usual intervals
        0.126,  # then a refused peak counts that rose this share of the way from noise to beats
        0.45,  # threshold between noise (0) and beats (1) when a beat is due
        1.011,  # just after a beat
        1.242,  # share of the usual interval in which it falls from the one to the other
        0.245,  # weight of a new beat in the level of beats
        0.152,  # weight of a refused peak in that of noise
        0.024,  # loss of the level of beats per second without any [1/s]
        1.0,  # first level of beats, of the second largest peak
        0.078,  # weight of a new interval in the usual one
        1.625,  # a beat counts at most so many times the level
        6.21,  # where beats stand over noise by less than this ratio of the levels, the rhythm begins to count
        1.84,  # ... and counts fully
        1.1,  # by so much of the way from noise to beats it moves the threshold, half up and half down
        0.173,  # a peak is in time within this share of the usual interval
        0.2,  # a rhythm whose intervals differ by this share counts for nothing
        0.1,  # from this trust on the rhythm continues on its own between beats
        0.25,  # a beat so near one of the rhythm belongs to it
        0.7,  # ... and draws it to itself by so much
        0.01,  # weight of a beat that does not belong, in how unsteady the rhythm is
        4.0,  # powers of the two bands are means over so much time [s]
        12.0,  # kurtosis of the lower band below which the upper one begins to count
        8.0,  # ... and counts as much as the next two say
        1.0,  # ratio of the kurtosis of the upper band to that of the lower one from which it begins to count
        1.2,  # ... and counts alone
        1.0,  # time in which one band takes over from the other [s]
    ]
)
"""Found by a random search over the six MIT-BIH records with and without synthetic noise and the four of the noise
stress test; what concerns the rhythm over the six with real electrode noise added, without the stress test; what
concerns the bands by hand over simulated electrode noise alone (decision 169). See
docs/guide/physiology.md for what other records and other noise give."""


class Ecg(Channel):
    """R peaks within 150 ms in the median, whatever the polarity, gain or rate."""

    name: ClassVar[str] = "ecg"
    latency_s: ClassVar[float] = 0.25
    lowest_rate: ClassVar[float] = 100.0
    phase: ClassVar[float] = 0.8

    def __init__(self, rate: float) -> None:
        super().__init__(rate)
        self._sos = np.stack([band_pass(ORDER, *band, rate) for band in BANDS])
        self._delays = np.array([delay_of(sos, qrs, rate) for sos, qrs in zip(self._sos, _QRS, strict=True)])
        self._z = np.zeros((*self._sos.shape[:2], 2))
        self._state = np.zeros(ECG_STATE)
        self._state[UNSTEADY] = 0.5  # a rhythm is steady when a dozen beats have shown it
        self._ring = np.zeros((1, int(4 * rate)))
        self._kept = np.zeros((64, 2))
        self._out = np.zeros((64, 3))
        self._strength = 0.0
        self.rhythm = Rhythm()

    def _take(self, piece: Floats) -> list[Event]:
        state = self._state
        count = find_beats(
            piece, self._sos, self._z, state, self._ring, self._kept, self.rate, self._delays, TUNING, self._out
        )
        events = []
        for at, known, strength in self._out[:count].tolist():
            self._strength += 0.2 * (min(strength, 20.0) - self._strength)
            t_s = max(at, 0.0) / self.rate
            interval = self.rhythm.beat(t_s)
            events.append(Event(t_s, (known + 1.0) / self.rate, "r_peak", interval or 0.0, self.found.quality))
        if state[MISSING] > self.rate:
            self.rhythm.pause()
        return events

    def _look_back(self, raw: Floats) -> Found:
        now_s = (self.samples) / self.rate
        features = self.rhythm.features(now_s)
        if self._state[LAST] >= 0.0:
            silent = now_s - self._state[LAST] / self.rate
        else:
            silent = np.inf
        clear = (self._state[SPK] / max(self._state[NPK], 1e-12) - _UNCLEAR) / (_CLEAR - _UNCLEAR)
        quality = self._contact(raw) * float(np.clip(clear, 0.0, 1.0)) * (1.0 if silent < 3.0 else 0.0)
        return Found(features if quality > 0.0 else {}, quality)


_QRS = (13.0, 20.0)
"""Where most of a QRS's power in each band is [Hz]: what its delay is taken at."""
_UNCLEAR, _CLEAR = 1.8, 4.0
"""Ratio of the levels of beats and of what lies between them that is no good, and that is all good."""
