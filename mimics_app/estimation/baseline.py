"""Baseline of a person's features at rest: mean and standard deviation over the calibration."""

from __future__ import annotations

from collections.abc import Mapping

from mimics_app.contracts.messages.feature_names import BREATH_RATE, HEART_RATE, RMSSD, SCL, SCR_RATE

__all__ = ["Baseline"]

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


class Baseline:
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
