"""ECG: R peaks, heart rate and its variability, signal quality."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from mimics_app.dsp.channel import Channel, Event, Found
from mimics_app.dsp.filters import Floats, band_pass, delay_of
from mimics_app.dsp.kernels.ecg import ECG_STATE, LAST, MISSING, NPK, SPK, UNSTEADY, find_beats
from mimics_app.dsp.rhythm import Rhythm

__all__ = ["TUNING", "Ecg"]

BANDS = ((8.2, 29.0), (15.0, 40.0))
"""Lower and upper band-pass of the QRS [Hz]."""
ORDER = 2
"""Order of the band-passes."""

TUNING = np.array(
    [
        0.101,  # window of the energy [s]
        0.091,  # a peak of the energy is complete when nothing larger followed for this time [s]
        0.218,  # refractory period [s]
        3.0,  # learning phase at the beginning [s]: two beats of a slow heart
        0.601,  # ... or complete when the energy fell below this share of the peak
        1.813,  # mean intervals without a beat after which one is taken as missed
        0.126,  # search back: threshold for rejected peaks between noise level (0) and signal level (1)
        0.45,  # threshold between noise level (0) and signal level (1) when a beat is due
        1.011,  # ... and just after a beat
        1.242,  # share of the mean interval in which it decays from the latter to the former
        0.245,  # weight of a new beat in the signal level
        0.152,  # weight of a rejected peak in the noise level
        0.024,  # decay rate of the signal level without beats [1/s]
        1.0,  # first signal level, as a share of the second largest candidate
        0.078,  # weight of a new interval in the mean one
        1.625,  # upper limit of a beat in its weight, in signal levels
        6.21,  # ratio of signal level to noise level below which the rhythm begins to count
        1.84,  # ... and counts fully
        1.1,  # range over which the rhythm moves the threshold, half up and half down, in units of the threshold
        0.173,  # width of the window around an expected beat, as a share of the mean interval
        0.2,  # relative deviation of the intervals at which the rhythm counts for nothing
        0.1,  # weight of the rhythm from which its phase runs on between beats
        0.25,  # largest offset from the expected beat at which a beat is in rhythm
        0.7,  # share of that offset by which the phase is corrected
        0.01,  # weight of a beat out of rhythm in the mean relative deviation
        4.0,  # time constant of the powers of the two bands [s]
        12.0,  # kurtosis of the lower band below which the crossfade to the upper one begins
        8.0,  # ... and is limited by the next two values alone
        1.0,  # ratio of the kurtosis of the upper band to that of the lower one from which it begins
        1.2,  # ... and is complete
        1.0,  # time constant of the crossfade [s]
    ]
)
"""Parameters of `find_beats`, by index. From a random search over the six MIT-BIH records with and without synthetic
noise and the four of the noise stress test; those of the rhythm over the six with real electrode noise added, without
the stress test; those of the bands by hand over simulated electrode noise alone (decision 169).
docs/guide/physiology.md has the results for other records and other noise."""


class Ecg(Channel):
    """R peaks, known within 150 ms in the median, for any polarity, gain and sampling rate."""

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
        self._state[UNSTEADY] = 0.5  # it takes a dozen beats until the rhythm counts as steady
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
        now_s = self.samples / self.rate
        features = self.rhythm.features(now_s)
        if self._state[LAST] >= 0.0:
            silent = now_s - self._state[LAST] / self.rate
        else:
            silent = np.inf
        clear = (self._state[SPK] / max(self._state[NPK], 1e-12) - _UNCLEAR) / (_CLEAR - _UNCLEAR)
        quality = self._contact(raw) * float(np.clip(clear, 0.0, 1.0)) * (1.0 if silent < 3.0 else 0.0)
        return Found(features if quality > 0.0 else {}, quality)


_QRS = (13.0, 20.0)
"""Frequency at which the group delay of each band is taken [Hz]: where most of a QRS's power in it lies."""
_UNCLEAR, _CLEAR = 1.8, 4.0
"""Ratio of signal level to noise level at which the quality is 0, and at which it is 1."""
