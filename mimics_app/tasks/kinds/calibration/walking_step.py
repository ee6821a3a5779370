"""Walking speed: the mean speed of the belt over some walks."""

from __future__ import annotations

from statistics import median

from mimics_app.contracts.messages.calibration_record import CalibratedMeasure
from mimics_app.contracts.system.phrases import phrase
from mimics_app.tasks.kinds.calibration.spec import CalibrationSpec
from mimics_app.tasks.kinds.calibration.step import Cue, Seen, Step, spread_of

__all__ = ["WalkingStep"]

_RUN_IN = 1.0 / 3.0
"""Share of a walk that does not count."""


class WalkingStep(Step):
    """Follows the belt through all walks."""

    def __init__(self, spec: CalibrationSpec, skipped: str) -> None:
        super().__init__(skipped)
        self._spec = spec
        self._since = 0.0
        self._from: tuple[float, float] | None = None  # time [s] and way of the belt [m] from which it counts
        self._means: list[float] = []

    @property
    def cue(self) -> Cue:
        return Cue(phrase("Walk as fast as is comfortable"))

    @property
    def share(self) -> float:
        return len(self._means) / self._spec.repeats

    def take(self, seen: Seen, seconds: float) -> None:
        self._since += seconds
        if self._from is None:
            self._from = (seen.now_s, seen.belt) if self._since >= _RUN_IN * self._spec.walk_s else None
            return
        if self._since < self._spec.walk_s:
            return
        then, way = self._from
        self._means.append((seen.belt - way) / (seen.now_s - then))
        self._since, self._from = 0.0, None
        if len(self._means) == self._spec.repeats:
            self.done = True
            speed = median(self._means)
            self.measures = [CalibratedMeasure("walking", speed, "m/s", len(self._means), spread_of(self._means))]
