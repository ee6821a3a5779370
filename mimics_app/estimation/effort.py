"""What work does to the heart, so that what is left can be read as arousal."""

from __future__ import annotations

import math

__all__ = ["EffortModel"]

_ON_S, _OFF_S = 35.0, 50.0
"""Time constants of the heart rate [s]: 30 to 60, recovery slower (Linnarsson 1974; Hunt et al. 2015)."""
_FORGET_S = 600.0
_FIRST_GAIN = 10.0
"""Heart rate per unit of effort before anything is known of the person [1/min]."""
_FIRST_VARIANCE = 36.0
_NOISE = 16.0
"""Variance of heart rate that is not work [1/min^2]."""


class EffortModel:
    """Effort from mechanical power by first-order kinetics, and its gain on this heart by recursive estimation.

    Args:
        full_power: Mechanical power that counts as full effort [W].
    """

    def __init__(self, full_power: float = 1.5) -> None:
        self._full = full_power
        self.effort = 0.0
        self.gain = _FIRST_GAIN
        self._variance = _FIRST_VARIANCE

    def step(self, power: float | None, seconds: float) -> float:
        """Let time pass under a mechanical power [W]; None: not measured, the effort fades. The effort, 0 to 1.5."""
        work = 0.0 if power is None else min(max(power / self._full, 0.0), 1.5)
        slow = _ON_S if work > self.effort else _OFF_S
        self.effort += -math.expm1(-seconds / slow) * (work - self.effort)
        return self.effort

    def residual(self, heart: float, *, learn: bool) -> float:
        """Heart rate over rest less what the work explains [1/min]; `learn`: the gain may follow this sample."""
        left = heart - self.gain * self.effort
        if learn and self.effort > 0.05:
            self._variance += _FIRST_VARIANCE / _FORGET_S
            noise = _NOISE * 30.0  # samples of one second go together for about half a minute
            k = self._variance * self.effort / (self.effort**2 * self._variance + noise)
            self.gain = min(max(self.gain + k * left, 0.0), 40.0)
            self._variance *= 1.0 - k * self.effort
        return left
