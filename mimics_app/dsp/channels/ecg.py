"""ECG: R peaks, heart rate and its variability, signal quality."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from typing import ClassVar

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
from mimics_app.dsp.channel import Channel, Event, FeatureSet
from mimics_app.dsp.filters import Floats, band_pass, delay_of
from mimics_app.dsp.kernels.beat_path import PATH
from mimics_app.dsp.kernels.beats import FORM_STATE, FormDetector, choose_beats
from mimics_app.dsp.kernels.ecg import ENERGY_STATE, EnergyDetector, Filters, find_beats
from mimics_app.dsp.kernels.form_tuning import TUNING
from mimics_app.dsp.kernels.templates import Bank
from mimics_app.dsp.rhythm import Rhythm

__all__ = ["CHANNEL", "Ecg"]

BANDS = ((8.2, 29.0), (15.0, 40.0), (2.0, 60.0))
"""Lower and upper band-pass of the QRS, and the wide one of its templates [Hz]."""
ORDER = 2
"""Order of the band-passes."""


class Ecg(Channel):
    """R peaks, known within 150 ms in the median, for any polarity, gain and sampling rate."""

    name: ClassVar[str] = "ecg"
    unit: ClassVar[str] = "mV"
    features: ClassVar[Mapping[str, str]] = {
        HEART_RATE: "1/min",
        RMSSD: "ms",
        SDNN: "ms",
        PNN50: "%",
        HRV_WINDOW_S: "s",
        LF: "ms²",
        HF: "ms²",
        LF_HF: "1",
    }
    latency_s: ClassVar[float] = 0.25
    lowest_rate: ClassVar[float] = 100.0
    phase: ClassVar[float] = 0.8

    def __init__(self, rate: float) -> None:
        super().__init__(rate)
        sos = np.stack([band_pass(ORDER, *band, rate) for band in BANDS])
        delays = np.array([delay_of(each, qrs, rate) for each, qrs in zip(sos, _QRS, strict=True)])
        self._filters = Filters(sos, np.zeros((*sos.shape[:2], 2)), delays)
        self._levels = np.zeros(1, ENERGY_STATE)
        ring, kept, found = np.zeros(int(4 * rate)), np.zeros((64, 2)), np.zeros((64, 3))
        self._energy = EnergyDetector(self._levels, ring, kept, found, rate)
        step = max(round(rate / _TEMPLATE_HZ), 1)
        bank, out, forms = _empty_bank(rate / step), np.zeros((64, 2)), np.zeros(1, FORM_STATE)
        self._forms = FormDetector(forms, bank, out, rate / step, step, delays[2], np.zeros(1, PATH))
        for state in (self._levels, forms):
            state["rhythm"]["last"] = -1.0
            state["rhythm"]["unsteady"] = 0.5  # it takes a dozen beats until the rhythm counts as steady
        forms["fitted"], forms["provisional"] = -np.inf, 1.0
        self._wide, self._missing = np.zeros((2, self._length))
        self._unclear = False
        self._bad: deque[bool] = deque(maxlen=_DOUBTED_S)
        self.rhythm = Rhythm()

    def _take(self, piece: Floats) -> list[Event]:
        wide, missing = self._wide[: len(piece)], self._missing[: len(piece)]
        found = self._energy.out[: find_beats(piece, self._filters, self._energy, wide, missing)]
        lost = (missing > self.rate) | self._unclear
        count, begin, events = choose_beats(wide, found, self._forms), 0, []
        for at, known in self._forms.out[:count].tolist():
            end = round(known) - self.samples
            if lost[begin:end].any():
                self.rhythm.pause()  # no interval spans it
            begin = end
            t_s = max(at, 0.0) / self.rate
            interval = self.rhythm.beat(t_s)
            events.append(Event(t_s, (known + 1.0) / self.rate, "r_peak", interval or 0.0, self.found.quality))
        if lost[begin:].any():
            self.rhythm.pause()
        return events

    def _evaluate(self, raw: Floats) -> FeatureSet:
        now_s = self.samples / self.rate
        features, state = self.rhythm.features(now_s), self._levels[0]
        last = state["rhythm"]["last"]
        silent = now_s - last / self.rate if last >= 0.0 else np.inf
        clear = (state["signal_level"] / max(state["noise_level"], _TINY) - _UNCLEAR) / (_CLEAR - _UNCLEAR)
        quality = self._contact(raw) * float(np.clip(clear, 0.0, 1.0)) * (1.0 if silent < 3.0 else 0.0)
        self._bad.append(quality < _LEAST_QUALITY)
        self._unclear = self._bad[-1] and now_s > _FIRST_S  # what is found in noise gives no interval
        if sum(self._bad) >= _MOSTLY * _DOUBTED_S:
            self.rhythm.forget(now_s - _DOUBTED_S)
        return FeatureSet(features if quality > 0.0 else {}, quality)


_QRS = (13.0, 20.0, 13.0)
"""Frequency at which the group delay of each band is taken [Hz]: where most of a QRS's power in it lies."""
_UNCLEAR, _CLEAR = 1.8, 4.0
"""Ratio of signal level to noise level at which the quality is 0, and at which it is 1."""

_TINY = 1e-12
"""Keeps the ratio finite [mV]."""
_LEAST_QUALITY = 0.2
"""Quality below which the beats that are found make no intervals."""
_DOUBTED_S, _MOSTLY = 10, 0.8
"""Where so much of so many seconds is bad, the intervals found in the others are dropped too [s]."""
_FIRST_S = 5.0
"""Time in which the quality is not known yet [s]."""

_TEMPLATE_HZ = 180.0
"""Sampling rate of the templates, approximately [Hz]."""
_SEARCHED_S = 10.0
"""Length of the signal in which a form is searched [s]."""
_TEMPLATES, _ORDER = 3, 4
"""Forms of beats, and order of the noise's predictor."""


def _empty_bank(rate: float) -> Bank:
    """Return ring buffers, templates and noise without content, for a sampling rate of the ring buffers [Hz]."""
    length = round(TUNING.before_s * rate) + round(TUNING.after_s * rate)
    rings, templates = np.zeros((3, int(_SEARCHED_S * rate))), np.zeros((_TEMPLATES, length + _ORDER))
    whitened, sizes = np.zeros((_TEMPLATES, length)), np.zeros((_TEMPLATES, 2))
    return Bank(rings, templates, whitened, sizes, np.zeros((_ORDER + 1, _ORDER + 1)), np.zeros(_ORDER + 1))


CHANNEL = Ecg
