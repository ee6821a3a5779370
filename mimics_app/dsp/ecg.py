"""ECG: R peaks, heart rate and its variability, signal quality."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from mimics_app.dsp.channel import Channel, Event, Found
from mimics_app.dsp.filters import Floats, band_pass, delay_of
from mimics_app.dsp.kernels.beats import BEATS_STATE, FITTED, PROVISIONAL, Bank, choose_beats
from mimics_app.dsp.kernels.ecg import ECG_STATE, MISSING, NPK, SPK, find_beats
from mimics_app.dsp.kernels.rhythm import LAST, UNSTEADY
from mimics_app.dsp.rhythm import Rhythm

__all__ = ["TUNING", "Ecg"]

BANDS = ((8.2, 29.0), (15.0, 40.0), (2.0, 60.0))
"""Lower and upper band-pass of the QRS, and the wide one of its templates [Hz]."""
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


TEMPLATE_TUNING = np.array(
    [
        0.05,  # a template begins this time before the R peak [s]
        0.0555,  # ... and ends this time after it
        8.23,  # degrees of freedom of the noise's distribution
        7.2,  # time constant of the noise's covariance [s]
        0.0764,  # samples within this time of a beat are not noise [s]
        2.28,  # a beat is averaged into a template if its energy is more than this multiple of the noise level
        0.766,  # correlation with a template above which a beat is of its form
        0.103,  # least weight of a new beat in its template
        5.71,  # beats from which a template is used
        20.0,  # amplitude of a template over that of the noise, both whitened, below which templates decide
        26.0,  # ... and above which energy decides again
        5.42,  # threshold of the score when a beat is due
        6.26,  # ... and what is added to it just after a beat
        1.3,  # share of the mean interval in which that decays
        12.1,  # range over which the rhythm moves the threshold, half up and half down
        0.179,  # width of the window around an expected beat, as a share of the mean interval
        0.134,  # relative deviation of the intervals at which the rhythm counts for nothing
        0.0527,  # a peak of the score is complete when nothing larger followed for this time [s]
        0.251,  # refractory period [s]
        1.34,  # mean intervals without a beat after which the best rejected candidate is taken
        -5.05,  # ... if its score exceeds the threshold by more than this
        1.6,  # mean intervals without a beat after which one found by energy fills the gap
        1.52,  # ... if its energy is more than this multiple of the noise level
        0.497,  # share of the beats found by templates below which these are discarded
        0.09,  # standard deviation of the intervals on a path, as a share of the period
        5.0,  # cost of a missed beat on it, in the logarithm of the probability
        40.0,  # evidence of a path from which its form is used, in the same
        0.9,  # least time between two searches of a form [s]
        60.0,  # time constant with which the evidence for a form fades [s]
        6.0,  # signal from which on one is searched [s]
        0.7,  # least share of that signal which the beats of a path cover, each by a mean interval
    ]
)
"""Parameters of `choose_beats`, by index."""


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
        self._state, self._beats = np.zeros(ECG_STATE), np.zeros(BEATS_STATE)
        for state in (self._state, self._beats):
            state[LAST], state[UNSTEADY] = -1.0, 0.5  # it takes a dozen beats until the rhythm counts as steady
        self._beats[FITTED], self._beats[PROVISIONAL] = -np.inf, 1.0
        self._step = max(round(rate / _TEMPLATE_HZ), 1)
        self._bank = _bank(rate / self._step)
        self._wide = np.zeros(self._length)
        self._ring = np.zeros((1, int(4 * rate)))
        self._kept = np.zeros((64, 2))
        self._found, self._out = np.zeros((64, 3)), np.zeros((64, 2))
        self.rhythm = Rhythm()

    def _take(self, piece: Floats) -> list[Event]:
        state = self._state
        rate, step, wide, delay = self.rate, self._step, self._wide[: len(piece)], self._delays[2]
        count = find_beats(
            piece, self._sos, self._z, state, self._ring, self._kept, rate, self._delays, TUNING, wide, self._found
        )
        found, out = self._found[:count], self._out
        count = choose_beats(
            wide, found, self._beats, self._bank, rate / step, step, delay, TUNING, TEMPLATE_TUNING, out
        )
        events = []
        for at, known in out[:count].tolist():
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


_QRS = (13.0, 20.0, 13.0)
"""Frequency at which the group delay of each band is taken [Hz]: where most of a QRS's power in it lies."""
_UNCLEAR, _CLEAR = 1.8, 4.0
"""Ratio of signal level to noise level at which the quality is 0, and at which it is 1."""

_TEMPLATE_HZ = 180.0
"""Sampling rate of the templates, approximately [Hz]."""
_SEARCHED_S = 10.0
"""Length of the signal in which a form is searched [s]."""
_TEMPLATES, _ORDER = 3, 4
"""Forms of beats, and order of the noise's predictor."""


def _bank(rate: float) -> Bank:
    """Return ring buffer, templates and noise without content, for a sampling rate of the ring buffer [Hz]."""
    length = round(TEMPLATE_TUNING[0] * rate) + round(TEMPLATE_TUNING[1] * rate)
    shapes = (3, int(_SEARCHED_S * rate)), (_TEMPLATES, length + _ORDER), (_TEMPLATES, length), (_TEMPLATES, 2)
    rings, templates, whitened, sizes = (np.zeros(shape) for shape in shapes)
    return rings, templates, whitened, sizes, np.zeros((_ORDER + 2, _ORDER + 1))
