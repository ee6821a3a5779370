"""Synthesis of raw ECG, GSR, EMG and breathing at 1 kHz from the slow drive of one person, with disturbances.

The signals are made second by second and are continuous. The ground truth (beats, responses, bursts) is kept for
scoring detectors; a session does not read it.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.inputs.physio.simulated.person import Drive
from mimics_app.inputs.physio.simulated.shapes import BREATHS, RESPONSES

__all__ = ["RATE", "SIGNALS", "Disturbance", "SignalGenerator", "Truth"]


RATE = 1000
"""Samples per second."""
SIGNALS = ("ecg", "gsr", "emg", "resp")

_WAVES = ((-0.17, 0.025, 0.12), (-0.026, 0.010, -0.12), (0.0, 0.011, 1.05), (0.028, 0.010, -0.22), (0.26, 0.045, 0.28))
"""P, Q, R, S, T of a normal beat: time from the R peak [s], width [s], height [mV]; after McSharry et al., IEEE TBME
50(3), 2003."""
_ECTOPIC = ((0.0, 0.035, 1.35), (0.07, 0.04, -0.55), (0.30, 0.07, -0.30))
"""A ventricular beat: no P, broad QRS, T against it."""
_ECTOPIC_AT, _PAUSE = 0.62, 1.35
"""An early beat comes after this share of the interval, the next one after this multiple: the two make a whole pair."""
_SHORTEST_RR = 0.28
"""Refractory time of the heart [s]: no two beats are nearer."""
_SLOW_BACK, _SLOW_KICK, _BY_BREATH, _BY_NOISE = 0.12, 0.35, 0.75, 0.4
"""Variation of the intervals, in RMSSD: return and kick of its slow part a beat, swing by the breath (respiratory sinus
arrhythmia, most of the fast part), and chance."""
_LUNG = 0.06
"""Change of the ECG's height by the lung's filling: its conductivity."""
_WANDER_HZ = (0.07, 0.19, 0.33)
"""Frequencies of the baseline wander [Hz]: below and at the breath, no multiples of each other."""
_UNEVEN_BREATH = 0.06
"""Relative deviation of the breath rate from second to second."""
_LEVEL_FOLLOWS = 0.02
"""Share by which the tonic level goes to its aim in a second: sweat ducts fill within a minute."""
_APART_S, _UNEVEN_RESPONSE = 1.5, 0.35
"""Least time between two responses [s], and the standard deviation of the logarithm of their amplitude."""
_MUSCLE_LOW, _MUSCLE_TIRED, _MUSCLE_MEAN = 0.55, 0.3, 0.94
"""Poles of the two filters that shape noise to the band of surface EMG, 10 to 95 Hz; the first one rises by the second
figure with full fatigue, which lowers the upper end to 26 Hz."""
_MUSCLE_REST, _MUSCLE_FULL = 0.004, 0.25
"""Standard deviation of the pattern at rest, and what full activity adds [mV]."""
_MUSCLE_NOISE, _BREATH_NOISE = 0.2, 2.0
"""Sizes of EMG [mV] and breath that the amplifier's noise is a share of."""
_SHAKE_EVERY, _SHAKE_KEEPS = 50, 0.8
"""Samples between two places of the motion artefact, and what it keeps of itself: a corner of 0.7 Hz, as an arm's."""
_OFF_S = 4
"""Length of a loss of contact [s]: until somebody presses the electrode on."""
_SKIN_SHARE = 0.2
"""Motion artefact of the skin's electrodes [uS] for one of 1 mV in the ECG: they lie on the still hand."""


@dataclass(frozen=True, slots=True)
class Disturbance:
    """Disturbances of the signals.

    Attributes:
        ectopic: Share of ventricular ectopic beats.
        wander: Baseline wander of the ECG [mV].
        mains: 50 Hz interference in the ECG [mV].
        muscle: Muscle noise in the ECG [mV].
        white: Noise of the amplifier, as a share of each signal's size.
        motion: Motion artefacts in ECG and GSR per m/s of the hand's speed [mV, uS].
        lead_off: Share of seconds without contact of the ECG and GSR electrodes.
        rail: Saturation level of the ECG [mV]; 0: none.
    """

    ectopic: float = 0.0
    wander: float = 0.08
    mains: float = 0.01
    muscle: float = 0.01
    white: float = 0.004
    motion: float = 0.15
    lead_off: float = 0.0
    rail: float = 0.0


@dataclass
class Truth:
    """Ground truth in seconds since the start: R peaks, ectopic ones, SCR peaks, EMG onsets, in-breaths."""

    beats: list[float] = field(default_factory=list)
    ectopic: list[float] = field(default_factory=list)
    responses: list[float] = field(default_factory=list)
    bursts: list[float] = field(default_factory=list)
    breaths: list[float] = field(default_factory=list)


class SignalGenerator:
    """The four signals of one person.

    Args:
        rng: Source of all random numbers.
        disturbance: Disturbances of the signals.
        response: Shape of a skin response, a name in `shapes.RESPONSES`.
        breath: Waveform of a breath, a name in `shapes.BREATHS`.

    Attributes:
        truth: Ground truth so far.
        seconds: Seconds made so far.
    """

    def __init__(
        self,
        rng: np.random.Generator,
        disturbance: Disturbance | None = None,
        response: str = "exponentials",
        breath: str = "rounded",
    ) -> None:
        self._rng = rng
        self._response, self._breath = RESPONSES[response], BREATHS[breath]
        self._peak = self._response.peak
        self._bad = disturbance or Disturbance()
        self.truth = Truth()
        self.seconds = 0
        self._beats: list[tuple[float, bool]] = [(0.3 + 0.5 * rng.random(), False)]
        self._slow = 0.0
        self._responses: list[tuple[float, float]] = []
        self._tonic = 0.0
        self._phase = 2.0 * np.pi * rng.random()
        self._wander_phase = 2.0 * np.pi * rng.random(3)
        self._shake = 0.0
        self._coloured = np.zeros(2)
        self._off = 0

    def second(self, drive: Drive) -> dict[str, F8]:
        """Return the next second of each of SIGNALS, shape [RATE]; `drive` is of one person."""
        t = self.seconds + np.arange(RATE) / RATE
        breath = self._breathe(drive, t)
        ecg = self._heart(drive, t, breath)
        gsr = self._skin(drive, t)
        emg = self._muscle(drive)
        resp = float(drive.breath_depth[0]) * breath + self._bad.white * _BREATH_NOISE * self._rng.standard_normal(RATE)
        shake = self._motion(float(drive.motion[0]))
        ecg += self._bad.motion * shake
        gsr += _SKIN_SHARE * self._bad.motion * shake
        self._lose_contact(ecg, gsr)
        if self._bad.rail > 0.0:
            ecg = np.clip(ecg, -self._bad.rail, self._bad.rail)
        self.seconds += 1
        return {"ecg": ecg, "gsr": gsr, "emg": emg, "resp": resp}

    def _breathe(self, drive: Drive, t: F8) -> F8:
        """Return the breathing in [-1, 1], and note where an in-breath begins."""
        rate = float(drive.breath_rate[0]) / 60.0 * (1.0 + _UNEVEN_BREATH * self._rng.standard_normal())
        phase = self._phase + 2.0 * np.pi * rate * np.arange(1, RATE + 1) / RATE
        turns = np.floor(phase / (2.0 * np.pi)) > np.floor((phase - 2.0 * np.pi * rate / RATE) / (2.0 * np.pi))
        self.truth.breaths += t[turns].tolist()
        self._phase = float(phase[-1])
        return self._breath(phase / (2.0 * np.pi) % 1.0)

    def _heart(self, drive: Drive, t: F8, breath: F8) -> F8:
        """Return the ECG: beats, baseline wander, mains, muscle noise."""
        while self._beats[-1][0] < t[-1] + 1.0:
            self._plan_beat(drive, float(breath[-1]))
        ecg = np.zeros(RATE)
        lung = 1.0 + _LUNG * breath
        for at, ectopic in self._beats:
            if t[0] - 0.8 <= at <= t[-1] + 0.8:
                for place, width, height in _ECTOPIC if ectopic else _WAVES:
                    ecg += height * np.exp(-0.5 * ((t - at - place) / width) ** 2)
            if t[0] <= at < t[-1] + 0.5 / RATE:
                self.truth.beats.append(at)
                if ectopic:
                    self.truth.ectopic.append(at)
        self._beats = [beat for beat in self._beats if beat[0] > t[0] - 1.0]
        wander = sum(np.sin(2.0 * np.pi * f * t + p) for f, p in zip(_WANDER_HZ, self._wander_phase, strict=True))
        noise = self._rng.standard_normal(RATE)
        muscle = np.convolve(noise, [0.5, 0.0, -0.5], "same")
        return (
            ecg * lung
            + self._bad.wander * wander
            + self._bad.mains * np.sin(100.0 * np.pi * t)
            + self._bad.muscle * muscle
            + self._bad.white * self._rng.standard_normal(RATE)
        )

    def _plan_beat(self, drive: Drive, breath: float) -> None:
        """Add the next beat: respiratory sinus arrhythmia, slow waves, random variation, ectopic beats."""
        rr = 60.0 / float(drive.heart_rate[0])
        rmssd = 1e-3 * float(drive.variability[0])
        self._slow += _SLOW_KICK * rmssd * self._rng.standard_normal() - _SLOW_BACK * self._slow
        step = rr - _BY_BREATH * rmssd * breath + self._slow + _BY_NOISE * rmssd * self._rng.standard_normal()
        last, early = self._beats[-1]
        step = max(step * _PAUSE if early else step, _SHORTEST_RR)
        if not early and self._rng.random() < self._bad.ectopic:
            self._beats.append((last + _ECTOPIC_AT * step, True))
        else:
            self._beats.append((last + step, False))

    def _skin(self, drive: Drive, t: F8) -> F8:
        """Return the skin conductance: tonic level and SCRs."""
        for _ in range(self._rng.poisson(float(drive.responses[0]) / 60.0)):
            onset = float(t[0] + self._rng.random())
            if not self._responses or onset - self._responses[-1][0] > _APART_S:
                self._responses.append((onset, float(drive.response[0]) * self._rng.lognormal(0.0, _UNEVEN_RESPONSE)))
                self.truth.responses.append(onset + self._response.peak_s)
        level = float(drive.conductance[0])
        begin = self._tonic if self.seconds else level
        self._tonic = begin + _LEVEL_FOLLOWS * (level - begin)
        gsr = np.linspace(begin, self._tonic, RATE, endpoint=False)
        for onset, size in self._responses:
            gsr += size / self._peak * self._response.of(np.maximum(t - onset, 0.0))
        self._responses = [each for each in self._responses if each[0] > t[0] - self._response.lasts_s]
        return gsr + self._bad.white * self._rng.standard_normal(RATE)

    def _muscle(self, drive: Drive) -> F8:
        """Return the interference pattern [mV]; fatigue lowers its frequency."""
        slow = _MUSCLE_LOW + _MUSCLE_TIRED * float(drive.fatigue[0])
        noise = self._rng.standard_normal(RATE)
        excited, self._coloured[:1] = _first_order(noise, slow, float(self._coloured[0]))
        mean, self._coloured[1:] = _first_order(excited, _MUSCLE_MEAN, float(self._coloured[1]))
        shaped = excited - mean
        activity = float(drive.muscle[0])
        noise = self._bad.white * _MUSCLE_NOISE * self._rng.standard_normal(RATE)
        return (_MUSCLE_REST + _MUSCLE_FULL * activity) * shaped + noise

    def _motion(self, speed: float) -> F8:
        """Return the motion artefact: low-frequency noise in proportion to the hand's speed."""
        places = [self._shake]
        for kick in (self._rng.standard_normal(RATE // _SHAKE_EVERY) * speed).tolist():
            places.append(_SHAKE_KEEPS * places[-1] + kick)
        self._shake = places[-1]
        return np.interp(np.arange(RATE) / _SHAKE_EVERY, np.arange(len(places)), places)

    def _lose_contact(self, *signals: F8) -> None:
        """Replace the signals by NaN during lead-off."""
        if self._off == 0 and self._bad.lead_off > 0.0 and self._rng.random() < self._bad.lead_off / _OFF_S:
            self._off = _OFF_S
        if self._off > 0:
            self._off -= 1
            for signal in signals:
                signal[:] = np.nan


def _first_order(values: F8, keep: float, last: float) -> tuple[F8, float]:
    """Filter by a first-order low-pass that keeps a share of the last output; return the outputs and the last one."""
    from scipy.signal import lfilter  # slow to import: only sessions with a simulated body need it

    out, _ = lfilter([1.0 - keep], [1.0, -keep], values, zi=[keep * last])
    return out, float(out[-1])
