"""Grip: the hand squeezes as hard as it can, holds, and lets go.

The strength is the mean of the repeats, which repeats itself better than the best one does (Mathiowetz et al., J Hand
Surg 9A(2), 1984); each is the mean force over the last part of the squeeze.
"""

from __future__ import annotations

from statistics import fmean, median

from mimics_app.contracts.messages.calibration_record import CalibratedMeasure
from mimics_app.contracts.system.phrases import phrase
from mimics_app.tasks.kinds.calibration.spec import CalibrationSpec
from mimics_app.tasks.kinds.calibration.step import Cue, Seen, Step, spread_of

__all__ = ["OPEN", "GripStep"]

OPEN = 0.1
"""Share of the force held, below which the hand has let go."""
_COUNTS = 0.6
"""Share of a squeeze that counts, its last part."""
_LETS_GO_S, _RESTS_S = 5.0, 1.5
"""Longest time to let go, and pause before the next squeeze [s]."""
_FELT = 0.5
"""Force below which nothing was squeezed [N]."""


class GripStep(Step):
    """Follows the grasp force through all squeezes."""

    def __init__(self, spec: CalibrationSpec, skipped: str) -> None:
        super().__init__(skipped)
        self._spec = spec
        self._forces: list[float] = []
        self._times: list[float] = []
        self._squeezes, self._opened = True, False
        self._since = self._word_s = 0.0
        self._begin()

    @property
    def cue(self) -> Cue:
        if self._squeezes:
            return Cue(phrase("Squeeze as hard as you can, and hold"), squeeze=True)
        return Cue(phrase("Rest the hand" if self._opened else "Let go"))

    @property
    def share(self) -> float:
        return len(self._forces) / self._spec.repeats

    def take(self, seen: Seen, seconds: float) -> None:
        self._since += seconds
        if self._squeezes:
            if self._since >= (1.0 - _COUNTS) * self._spec.squeeze_s:
                self._held.append(seen.grasp)
            if self._since >= self._spec.squeeze_s:
                self._squeezes, self._since, self._word_s = False, 0.0, seen.shown_s
        elif not self._opened:
            self._wait_for_release(seen)
        elif self._since >= _RESTS_S:
            self._end_repeat()
        self._before = seen.now_s, seen.grasp

    def _wait_for_release(self, seen: Seen) -> None:
        limit, late = OPEN * fmean(self._held), self._since >= _LETS_GO_S
        if seen.grasp >= limit and not late:
            return
        (then, before), now = self._before, seen.now_s
        if not late and before > limit:
            share = (before - limit) / (before - seen.grasp)
            self._times.append(then + share * (now - then) - self._word_s)
        self._opened, self._since = True, 0.0

    def _end_repeat(self) -> None:
        self._forces.append(fmean(self._held))
        if len(self._forces) < self._spec.repeats:
            self._begin()
            return
        self.done = True
        if max(self._forces) < _FELT:
            self.skipped = phrase("no grip was felt: the device does not measure it, or the hand did not close")
            return
        force, count = fmean(self._forces), len(self._forces)
        self.measures = [CalibratedMeasure("grip", force, "N", count, spread_of(self._forces))]
        if self._times:
            release = median(self._times)
            self.measures += [CalibratedMeasure("release", release, "s", len(self._times), spread_of(self._times))]

    def _begin(self) -> None:
        self._squeezes, self._opened = True, False
        self._since = self._word_s = 0.0
        self._held: list[float] = []
        self._before = 0.0, 0.0
