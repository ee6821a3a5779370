"""Range of motion: the hand follows a light to the edge, in each direction, comfortably and then as far as it gets."""

from __future__ import annotations

from collections import deque
from statistics import median

from mimics_app.contracts.arrays import Vec3
from mimics_app.contracts.messages.calibration_record import DIRECTIONS, CalibratedMeasure
from mimics_app.contracts.system.phrases import phrase
from mimics_app.maths.triples import dot
from mimics_app.tasks.kinds.calibration.spec import CalibrationSpec
from mimics_app.tasks.kinds.calibration.step import Cue, Seen, Step, spread_of

__all__ = ["RangeStep"]

_PROGRESS = 0.003
"""Way that a hand gains in the time for a limit, if it is not at its limit [m]."""
_LONGEST_S = 20.0
"""Longest time for one reach [s]."""
_MOST_S = 540.0
"""Time after which the step ends with the reaches that were made [s]."""
_BACK, _BACK_S = 0.03, 6.0
"""Distance from the rest at which the hand is back [m], and longest time for the way back [s]."""
_AHEAD = 0.02
"""How far the light must be past the hand for a hand that stays behind to be at its limit [m]."""
_AT_EDGE = 0.97
"""Share of the light's way from which the device, not the person, is the limit."""
_STARTS_S = 4.0
"""Time from which a hand that did not set out is at its limit [s]."""
_MOVED = 0.01
"""Reach in some direction from which a hand moved at all [m]."""
_PREFIXES = {True: "ease", False: "reach"}


class RangeStep(Step):
    """Follows the hand through all reaches: every direction in turn, first all comfortable rounds, then the others.

    A reach is the median of the hand's way over the last part of the time in which it got no farther; a measure the
    median of its repeats.
    """

    def __init__(self, spec: CalibrationSpec, skipped: str = "") -> None:
        super().__init__(skipped)
        self._spec = spec
        self._farthest = dict(zip(DIRECTIONS, spec.reaches, strict=True))
        rounds = [
            (comfortable, direction)
            for comfortable in (True, False)
            for _ in range(spec.repeats)
            for direction in DIRECTIONS
        ]
        self._left, self._count = deque(rounds), len(rounds)
        self._found: dict[tuple[bool, str], list[float]] = {}
        self._spent = 0.0
        self._way = self._since = 0.0
        self._returns = False
        self._begin()

    @property
    def cue(self) -> Cue:
        if self.done:
            return Cue("")
        comfortable, direction = self._left[0]
        if self._returns:
            return Cue(phrase("Back to the middle"), light=(0.0, 0.0, 0.0), comfortable=comfortable)
        prompt = phrase(
            "Follow the light as far as is comfortable" if comfortable else "Follow the light as far as you can"
        )
        return Cue(prompt, _along(direction, self._way), direction, comfortable=comfortable)

    @property
    def share(self) -> float:
        return 1.0 - len(self._left) / self._count

    def take(self, seen: Seen, seconds: float) -> None:
        self._since += seconds
        self._spent += seconds
        if self._returns:
            if self._spent >= _MOST_S:
                self._left.clear()
                self._begin()
            elif _length(seen.hand) < _BACK or self._since >= _BACK_S:
                self._left.popleft()
                self._begin()
            return
        key = self._left[0]
        farthest = self._farthest[key[1]]
        self._way = min(self._way + self._spec.pace * seconds, farthest)
        here = dot(DIRECTIONS[key[1]], seen.hand)
        self._places.append((seen.now_s, here))
        while self._places[0][0] < seen.now_s - self._spec.still_s:
            self._places.popleft()
            self._whole = True
        self._whole = self._whole and len(self._places) > 1  # it begins anew where the computer stalled for all of it
        if self._at_limit(here, farthest) or self._since >= _LONGEST_S:
            self._found.setdefault(key, []).append(self._late_half())
            self._returns, self._since = True, 0.0

    def _at_limit(self, here: float, farthest: float) -> bool:
        """Whether the hand got no farther for the time of a limit, while the light did."""
        behind = self._way - here > _AHEAD or self._way >= farthest
        set_out = here >= _AHEAD or self._since >= _STARTS_S
        if not (self._whole and behind and set_out):
            return False
        early = median(place for _, place in list(self._places)[: len(self._places) // 2])
        return self._late_half() - early < _PROGRESS

    def _late_half(self) -> float:
        """Return the median of the hand's way over the later half of the time for a limit [m]."""
        return median(place for _, place in list(self._places)[len(self._places) // 2 :])

    def _begin(self) -> None:
        self._way = self._since = 0.0
        self._returns = False
        self._whole = False  # whether the places fill the time for a limit
        self._places: deque[tuple[float, float]] = deque()
        if not self._left:
            self.done = True
            found = [self._measure(*key, values) for key, values in self._found.items()]
            if all(measure.value < _MOVED for measure in found):
                self.skipped = phrase("the hand did not move")
            else:
                self.measures = found

    def _measure(self, comfortable: bool, direction: str, values: list[float]) -> CalibratedMeasure:
        value, name = median(values), f"{_PREFIXES[comfortable]}_{direction}"
        at_least = not comfortable and value >= _AT_EDGE * self._farthest[direction]
        return CalibratedMeasure(name, value, "m", len(values), spread_of(values), at_least)


def _along(direction: str, way: float) -> Vec3:
    x, y, z = DIRECTIONS[direction]
    return way * x, way * y, way * z


def _length(values: Vec3) -> float:
    return dot(values, values) ** 0.5
