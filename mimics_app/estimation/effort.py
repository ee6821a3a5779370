"""Effect of mechanical work on the heart rate, whose residual indicates arousal."""

from __future__ import annotations

import math

__all__ = ["EffortModel"]

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

    def step(self, power: float | None, seconds: float) -> float:
        """Advance by a time under a mechanical power [W] and return the effort; None: not measured, taken as 0."""
        work = 0.0 if power is None else min(max(power / _FULL, 0.0), 1.5)
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
