"""Plan of a simulated person who picks an object up and sets it down: target of the hand, step by step."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum, auto

from mimics_app.contracts.arrays import Vec3
from mimics_app.contracts.messages.stage_messages import Aim

__all__ = ["Percept", "Picker"]


_HOVER = 0.10
"""Height above the object from which the hand descends [m]."""
_OVER_THE_MARK = 0.05
"""Height above its final position at which the object is carried to the mark [m]."""
_FAR = 0.08
"""Horizontal distance from which the hand rises before it moves to the object [m]."""
_ABOVE = 0.010
"""Horizontal distance from the object within which the hand descends; at twice this distance it rises again [m]."""
_AROUND = 0.012
"""Distance from the object's centre at which the hand closes [m]."""
_LANDED = 0.004
"""Height of the object's centre above its final position up to which it counts as set down [m]."""
_CLOSING_S = 0.7
"""Time of closing before the hand lifts [s]."""
_GIVES_UP_S = 2.0
"""Time of closing without a grip after which the hand opens and starts again [s]."""
_OPENING_S = 0.6
"""Time of opening before it starts again [s]."""


@dataclass(frozen=True, slots=True)
class Percept:
    """What the simulated person perceives in one frame.

    Attributes:
        time: Time [s].
        hand: Point between the fingertips [m].
        body: Centre of the object to be carried [m].
        held: Whether the fingers hold it.
    """

    time: float
    hand: Vec3
    body: Vec3
    held: bool


class _Step(Enum):
    ABOVE = auto()  # over the object
    DOWN = auto()  # onto it
    CLOSE = auto()  # round it
    LIFT = auto()  # up with it
    OVER = auto()  # above the mark
    LOWER = auto()  # onto the mark
    OPEN = auto()  # let go
    AWAY = auto()  # up again
    AGAIN = auto()  # lost it: open, then begin again


class Picker:
    """The plan of one person, step by step.

    Args:
        mark: Target position of the object on the surface [m].
        half_height: Height of the object's centre above the surface it lies on [m].
        within: Largest horizontal distance of its centre from the mark [m].
    """

    def __init__(self, mark: Vec3, half_height: float, within: float) -> None:
        self.within = within
        self._mark = mark
        self._lying = mark[1] + half_height
        self._step = _Step.ABOVE
        self._since = 0.0
        self._picked: Vec3 = mark

    def aim(self, seen: Percept) -> Aim:
        """Return the target of the hand in this frame."""
        following = self._following(seen)
        if following is not self._step:
            self._step, self._since = following, seen.time
            self._picked = seen.hand
        return Aim(self._target(seen), self._step in _CLOSED)

    def _following(self, seen: Percept) -> _Step:
        """The step of this frame."""
        if self._step in _CARRIES and not seen.held:
            return _Step.AGAIN
        return _RULES[self._step](self, seen)

    def _after_above(self, seen: Percept) -> _Step:
        near = _level(seen.hand, seen.body) <= _ABOVE
        return _Step.DOWN if near and seen.hand[1] < seen.body[1] + 1.3 * _HOVER else _Step.ABOVE

    def _after_down(self, seen: Percept) -> _Step:
        if math.dist(seen.hand, seen.body) <= _AROUND:
            return _Step.CLOSE
        return _Step.ABOVE if _level(seen.hand, seen.body) > 2.0 * _ABOVE else _Step.DOWN

    def _after_close(self, seen: Percept) -> _Step:
        waited = seen.time - self._since
        if seen.held and waited >= _CLOSING_S:
            return _Step.LIFT
        return _Step.AGAIN if waited >= _GIVES_UP_S else _Step.CLOSE

    def _after_lift(self, seen: Percept) -> _Step:
        return _Step.OVER if seen.hand[1] >= self._carry_height - 0.02 else _Step.LIFT

    def _after_over(self, seen: Percept) -> _Step:
        return _Step.LOWER if _level(seen.body, self._mark) <= 0.5 * self.within else _Step.OVER

    def _after_lower(self, seen: Percept) -> _Step:
        if _level(seen.body, self._mark) > 0.9 * self.within:
            return _Step.OVER
        return _Step.OPEN if seen.body[1] - self._lying <= _LANDED else _Step.LOWER

    def _after_open(self, seen: Percept) -> _Step:
        return _Step.OPEN if seen.held else _Step.AWAY

    def _after_away(self, seen: Percept) -> _Step:
        return _Step.AWAY if _level(seen.body, self._mark) <= self.within else _Step.ABOVE

    def _after_again(self, seen: Percept) -> _Step:
        return _Step.ABOVE if seen.time - self._since >= _OPENING_S else _Step.AGAIN

    @property
    def _carry_height(self) -> float:
        return self._lying + _OVER_THE_MARK

    def _target(self, seen: Percept) -> Vec3:
        (x, y, z), mark = seen.body, self._mark
        if self._step is _Step.ABOVE:
            high = y + _HOVER
            if _level(seen.hand, seen.body) > _FAR and seen.hand[1] < high:
                return seen.hand[0], high + 0.05, seen.hand[2]
            return x, high, z
        if self._step in (_Step.DOWN, _Step.CLOSE):
            return seen.body
        if self._step is _Step.LIFT:
            return self._picked[0], self._carry_height, self._picked[2]
        if self._step in (_Step.OVER, _Step.AWAY):
            return mark[0], self._carry_height, mark[2]
        if self._step in (_Step.LOWER, _Step.OPEN):
            return mark[0], self._lying, mark[2]
        return self._picked


_CLOSED = {_Step.CLOSE, _Step.LIFT, _Step.OVER, _Step.LOWER}
_CARRIES = {_Step.LIFT, _Step.OVER, _Step.LOWER}

_RULES: dict[_Step, Callable[[Picker, Percept], _Step]] = {
    _Step.ABOVE: Picker._after_above,
    _Step.DOWN: Picker._after_down,
    _Step.CLOSE: Picker._after_close,
    _Step.LIFT: Picker._after_lift,
    _Step.OVER: Picker._after_over,
    _Step.LOWER: Picker._after_lower,
    _Step.OPEN: Picker._after_open,
    _Step.AWAY: Picker._after_away,
    _Step.AGAIN: Picker._after_again,
}


def _level(a: Vec3, b: Vec3) -> float:
    """Return the horizontal distance [m]."""
    return math.hypot(a[0] - b[0], a[2] - b[2])
