"""State of the person by a Kalman filter of arousal: each feature is an observation, noisier at low quality."""

from __future__ import annotations

import math
from collections.abc import Mapping

from mimics_app.contracts.messages.feature_names import (
    BREATH_RATE,
    HAND_POWER,
    HEART_RATE,
    LEG_POWER,
    RMSSD,
    SCL,
    SCR_RATE,
)
from mimics_app.contracts.messages.stage_messages import Estimate, FeatureFrame, TrialResult, UserState
from mimics_app.estimation.trial_view import HEART

__all__ = ["EffortModel", "FusionEstimation", "load_of"]

_STEP_S = 1.0
"""Step of the filter: one frame of features [s]."""
_TAU_S = 40.0
"""Time constant with which arousal returns to rest without observations [s]."""
_DRIVE = 0.02
"""Process noise of arousal: variance per step."""
_INNOVATION = 1.5
"""Limit of an observation of arousal."""
_LEAST_QUALITY = 0.2
"""Signal quality below which features are not used."""
_VIEWS = {
    HEART: (0.22, 3.0),
    SCR_RATE: (0.25, 1.5),
    SCL: (0.20, 2.0),
    RMSSD: (-0.35, 1.5),
}
"""Arousal per standard deviation of each feature from rest, and the feature's noise in standard deviations. At full
arousal the heart beats some 12/min faster (spread of rest 2 to 3), ten more SCRs come in a minute (2 to 3), the level
rises by 1 to 2 uS (0.25), and RMSSD falls by a third to a half (6 ms): Boucsein, Electrodermal Activity, 2012; Kim et
al., Psychiatry Investig 15(3), 2018. The heart counts least: what work, posture and talk do to it is no arousal."""
_SIGNAL = {HEART: "ecg", RMSSD: "ecg", SCR_RATE: "gsr", SCL: "gsr"}
"""Signal of each feature."""
_AS_AT_REST = (SCR_RATE, SCL, RMSSD, BREATH_RATE)
"""Features that are compared with rest as they are; of RMSSD the effect of work is taken away afterwards."""
_CORRELATED_S = 25.0
"""Correlation time of the features, whose windows are 10 to 60 s: factor on the noise of observations 1 s apart."""
_UNKNOWN = 0.6
"""Standard deviation of arousal above which it is unknown: 0.64 without an observation, 0.35 with all of them."""
_PEOPLE = 2.1
"""Ratio of the variance of arousal over people to that of the filter, which takes everybody for the same: with it 95 %
of the truth lies within 1.96 standard deviations, over simulated people of five families (decision 292)."""
_VALENCE_VARIANCE = 0.3
"""Variance of valence, which body signals hardly show."""
_EFFORT_RMSSD, _FALL_DIFFERS = 0.3, 0.5
"""Fall of RMSSD at full effort as a share of its value at rest, and its standard deviation between people as a share of
the fall."""
_BAND = (-0.3, 0.35)
"""Arousal of a task that is a challenge; below it the person is under-challenged, above it over-challenged."""


_ON_S, _OFF_S = 42.0, 65.0
"""Time constants of the heart rate [s]: 30 to 60, recovery slower (Linnarsson 1974; Hunt et al. 2015)."""
_KINETICS = 0.6
"""Standard deviation of the time course between people, as a share of what is still to come."""
_FORGET_S = 200.0
"""Time in which the variance of the gain grows by the first one [s]."""
_FIRST_GAIN = 12.0
"""Prior heart rate per unit of effort [1/min]."""
_FIRST_VARIANCE = 36.0
"""Prior variance of the gain [1/min^2]."""
_NOISE = 16.0
"""Variance of the heart rate that is not due to work [1/min^2]."""
_FULL = 1.6
"""Mechanical power that counts as full effort [W]: what an arm on a light robot gives for minutes."""
_FULL_LEGS = 25.0
"""Power of both legs that counts as full effort [W]: of a healthy simulated person in the gait orthosis at 0.4 m/s."""


_LEAST_SPREAD = {
    HEART_RATE: 2.0,
    RMSSD: 6.0,
    SCL: 0.25,
    SCR_RATE: 1.5,
    BREATH_RATE: 1.0,
}
"""Smallest standard deviation of a baseline [unit of the feature]: two minutes at rest underestimate it."""

_LEAST_FRAMES = 10
"""Smallest number of frames with a feature for a baseline of it."""

_MEASURED = 0.75
"""Share of the calibration in which a feature is measured at least; it lasts longer where the electrodes come late."""


class EffortModel:
    """Effort from mechanical power by first-order kinetics, and its gain on the heart rate by a scalar Kalman filter.

    Attributes:
        effort: Present effort, 0 to 1.5.
        gain: Heart rate per unit of effort [1/min].
    """

    def __init__(self) -> None:
        self.effort = 0.0
        self.gain = _FIRST_GAIN
        self._variance = _FIRST_VARIANCE
        self._coming = 0.0

    @property
    def doubt(self) -> float:
        """Standard deviation of the effect of work on the heart rate [1/min]: its gain and its time course differ."""
        return math.hypot(math.sqrt(self._variance) * self.effort, _KINETICS * self.gain * self._coming)

    def step(self, power: float | None, seconds: float, full: float = _FULL) -> float:
        """Advance by a time under a mechanical power [W] and return the effort.

        Args:
            power: None: not measured, taken as 0.
            seconds: Time [s].
            full: Power that counts as full effort [W].
        """
        work = 0.0 if power is None else min(max(power / full, 0.0), 1.5)
        slow = _ON_S if work > self.effort else _OFF_S
        self.effort += -math.expm1(-seconds / slow) * (work - self.effort)
        self._coming = abs(work - self.effort)
        return self.effort

    def residual(self, heart: float, *, learn: bool) -> float:
        """Return the heart rate over rest less the effect of work [1/min]; `learn`: update the gain by this sample."""
        left = heart - self.gain * self.effort
        if learn and self.effort > 0.05:
            self._variance += _FIRST_VARIANCE / _FORGET_S
            noise = _NOISE * 30.0  # samples one second apart are correlated over about half a minute
            k = self._variance * self.effort / (self.effort**2 * self._variance + noise)
            self.gain = min(max(self.gain + k * left, 0.0), 40.0)
            self._variance *= 1.0 - k * self.effort
        return left


class _Baseline:
    """Mean and standard deviation of features over the calibration.

    Args:
        seconds: Shortest length of the calibration [s], with one frame of features per second.

    Attributes:
        done: Whether the calibration is over.
    """

    def __init__(self, seconds: float = 60.0) -> None:
        self._wanted = seconds
        self._frames = 0
        self._sums: dict[str, tuple[int, float, float]] = {}
        self.done = False

    def add(self, values: Mapping[str, float]) -> None:
        """Take the features of a second of rest; ignored after the calibration."""
        if self.done:
            return
        self._frames += 1
        for name, value in values.items():
            if name in _LEAST_SPREAD:
                n, mean, square = self._sums.get(name, (0, 0.0, 0.0))
                step = value - mean
                mean += step / (n + 1)
                self._sums[name] = (n + 1, mean, square + step * (value - mean))
        measured = max((n for n, _, _ in self._sums.values()), default=0)
        self.done = self._frames >= self._wanted and measured >= _MEASURED * self._wanted

    def at_rest(self, name: str) -> tuple[float, float] | None:
        """Return mean and standard deviation of a feature at rest; None where too little of it was seen."""
        n, mean, square = self._sums.get(name, (0, 0.0, 0.0))
        return None if n < _LEAST_FRAMES else (mean, max((square / (n - 1)) ** 0.5, _LEAST_SPREAD[name]))

    def z(self, name: str, values: Mapping[str, float]) -> float | None:
        """Return a feature in standard deviations from rest; None without the feature or its baseline."""
        rest = self.at_rest(name)
        return None if name not in values or rest is None else (values[name] - rest[0]) / rest[1]


class FusionEstimation:
    """Effort from mechanical work, then arousal from the residual; unknown at low signal quality and at the start.

    Args:
        baseline_s: Shortest length of the calibration at rest [s], see `_Baseline`.

    Attributes:
        seen: Newest features in standard deviations from rest, heart rate and RMSSD without the effect of work.
    """

    def __init__(self, baseline_s: float = 60.0) -> None:
        self._baseline_s = baseline_s
        self._baseline = _Baseline(baseline_s)
        self._effort = EffortModel()
        self._mean, self._variance = 0.0, 0.5
        self._doubts: dict[str, float] = {}
        self.seen: Mapping[str, float] = {}
        self._state = UserState(-1)

    def update(self, features: FeatureFrame) -> UserState:
        """Return the state after a frame of features; the same state for the same frame."""
        if features.t_ns == self._state.t_ns:
            return self._state
        values, quality = features.values, features.quality
        legs, hand = values.get(LEG_POWER), values.get(HAND_POWER)
        self._effort.step(hand, _STEP_S) if legs is None else self._effort.step(legs, _STEP_S, _FULL_LEGS)
        if not self._baseline.done and self._effort.effort < 0.2:
            self._baseline.add(values)
        self._step(values, quality)
        body = [quality[name] for name in ("ecg", "gsr") if name in quality]
        known = self._baseline.done and self._variance < _UNKNOWN**2 and bool(body) and max(body) > _LEAST_QUALITY
        effort = None
        if hand is not None or legs is not None:
            effort = Estimate(min(self._effort.effort, 1.0), 0.02)
        self._state = UserState(
            features.t_ns,
            arousal=self._arousal() if known else None,
            valence=self._valence() if known else None,
            effort=effort,
            load=load_of(self._mean, self._variance) if known else None,
            quality=max(body, default=0.0),
        )
        return self._state

    def update_from_result(self, result: TrialResult) -> UserState:
        """Return the present state: it depends on body signals alone."""
        return self._state

    def recalibrate(self) -> None:
        """Measure the baseline anew; until then the state is unknown."""
        self._baseline = _Baseline(self._baseline_s)

    def _step(self, values: Mapping[str, float], quality: Mapping[str, float]) -> None:
        """Predict, then update by each observation in turn."""
        self._mean *= math.exp(-_STEP_S / _TAU_S)
        self._variance = self._variance * math.exp(-2.0 * _STEP_S / _TAU_S) + _DRIVE
        self.seen = self._seen(values)
        for name, (gain, noise) in _VIEWS.items():
            good = quality.get(_SIGNAL[name], 0.0)
            if good < _LEAST_QUALITY or name not in self.seen:
                continue
            noise = math.hypot(noise, self._doubts.get(name, 0.0))
            variance = (abs(gain) * noise) ** 2 * _CORRELATED_S / good**2
            innovation = max(min(gain * self.seen[name], _INNOVATION), -_INNOVATION) - self._mean
            k = self._variance / (self._variance + variance)
            self._mean += k * innovation
            self._variance *= 1.0 - k

    def _seen(self, values: Mapping[str, float]) -> dict[str, float]:
        """Return the features in standard deviations from rest, heart rate and RMSSD without the effect of work."""
        seen = {name: z for name in _AS_AT_REST if (z := self._baseline.z(name, values)) is not None}
        self._doubts = {}
        heart, rmssd = self._baseline.at_rest(HEART_RATE), self._baseline.at_rest(RMSSD)
        if heart is not None and HEART_RATE in values:
            quiet = self._baseline.done and abs(self._mean) < 0.35
            left = self._effort.residual(values[HEART_RATE] - heart[0], learn=quiet)
            seen[HEART] = left / heart[1]
            self._doubts[HEART] = self._effort.doubt / heart[1]
        if rmssd is not None and RMSSD in seen:
            fall = _EFFORT_RMSSD * self._effort.effort * rmssd[0] / rmssd[1]
            seen[RMSSD] += fall
            self._doubts[RMSSD] = _FALL_DIFFERS * fall
        return seen

    def _arousal(self) -> Estimate:
        """Return the arousal within -1 and 1, with its variance to first order (delta method)."""
        mean = math.tanh(self._mean)
        return Estimate(mean, _PEOPLE * self._variance * (1.0 - mean * mean) ** 2)

    def _valence(self) -> Estimate:
        """Return the valence, of which little is known: high arousal in a task is seldom pleasant."""
        return Estimate(-0.4 * max(math.tanh(self._mean), 0.0), _VALENCE_VARIANCE)


def load_of(mean: float, variance: float) -> tuple[float, float, float]:
    """Return the probability that arousal is below, within or above the band of a challenge."""
    deviation = math.sqrt(variance)

    def below(limit: float) -> float:
        return 0.5 * math.erfc((mean - limit) / (deviation * math.sqrt(2.0)))

    low, high = map(below, _BAND)
    return low, high - low, 1.0 - high
