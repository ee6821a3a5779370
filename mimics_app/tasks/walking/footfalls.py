"""Footfalls from the angles of two legs: heel strikes, step lengths, symmetry, lift of the feet, phase of the cycle.

A foot comes down when its ankle, which was moving forwards relative to the hip, begins to move backwards, as a standing
one does. Where the loop finds that at 1 kHz, it is believed; otherwise nothing but the angles and the belt is used, and
the speed of the foot is continued to the present: a difference of two frames is that of half a frame ago.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from mimics_app.contracts.messages.leg_motion import LegMotion
from mimics_app.tasks.walking.legs import SHANK, THIGH, natural_step

__all__ = ["Footfall", "Footfalls"]

_SIDES = ("left", "right")
_UP = 0.3
"""Share of the belt's speed at which a foot moves forwards when it counts as swinging."""
_LEAST_BELT = 0.05
"""Speed of the belt below which nobody steps [m/s]."""
_LONGEST_CYCLE_S = 4.0
"""Longest time between two footfalls of a foot that is taken for a cycle [s]."""
_FIRST_CYCLE_S = 1.2
_CADENCE_FROM = 4
"""Number of footfalls from which the cadence is that of the person."""
_PULL = 3.0
"""Rate at which the phase is drawn to that of the footfalls [1/s]."""


@dataclass(frozen=True, slots=True)
class Footfall:
    """A foot that came down.

    Attributes:
        side: "left" or "right".
        length: How far its ankle was ahead of the other one [m].
        lift: Greatest height of its ankle over the other one's in the swing before [m].
    """

    side: str
    length: float
    lift: float


@dataclass(slots=True)
class _Foot:
    """A foot over time."""

    ahead: float = 0.0
    moves: float = 0.0
    strikes: int = 0
    swings: bool = False
    stood: bool = True
    lift: float = 0.0
    since: float = 0.0
    lengths: list[float] = field(default_factory=list)
    lifts: list[float] = field(default_factory=list)


class Footfalls:
    """Watches two legs.

    Attributes:
        count: Number of footfalls.
        phase: Phase of the left leg, 0 at its heel strike, 0.5 at that of the right one.
    """

    def __init__(self) -> None:
        self._feet = (_Foot(), _Foot())
        self._begun = False
        self._cycle_s = _FIRST_CYCLE_S
        self._error = 0.0
        self.count = 0
        self.phase = 0.0

    def watch(self, legs: LegMotion, seconds: float) -> list[Footfall]:
        """Take the legs after a time step [s]; return the feet that came down in it."""
        places = ankle(legs.hip_left, legs.knee_left), ankle(legs.hip_right, legs.knee_right)
        fallen = []
        for k, foot in enumerate(self._feet):
            ahead, lift = places[k][0], places[1 - k][1] - places[k][1]
            moves = (ahead - foot.ahead) / seconds if self._begun and seconds > 0.0 else 0.0
            now, foot.ahead, foot.moves = moves + 0.5 * (moves - foot.moves), ahead, moves
            foot.since += seconds
            turns = now < 0.0 and moves < _UP * legs.belt_speed
            struck = self._is_counted(foot, legs.strikes[k]) if legs.strikes else turns
            if self._comes_down(foot, struck, lift, legs.belt_speed):
                fallen.append(self._take(k, foot, ahead - places[1 - k][0]))
        self._begun = True
        self._follow(legs.belt_speed, seconds)
        return fallen

    @property
    def symmetry(self) -> float | None:
        """Shorter over longer of the mean step lengths of both sides; None before both have stepped twice."""
        left, right = (self._mean(foot.lengths) for foot in self._feet)
        if left is None or right is None:
            return None
        longer = max(left, right)
        return max(min(left, right), 0.0) / longer if longer > 0.0 else None

    @property
    def step_length(self) -> float | None:
        """Mean step length [m]."""
        return self._mean([*self._feet[0].lengths, *self._feet[1].lengths])

    @property
    def clearance(self) -> float | None:
        """Mean of the greatest lift of the foot that lifts less [m]."""
        lifts = [mean for foot in self._feet if (mean := self._mean(foot.lifts)) is not None]
        return min(lifts) if len(lifts) == len(_SIDES) else None

    def step_at(self, speed: float) -> float:
        """Return the step [m] at a speed [m/s] with the present cadence; the natural one before there is any."""
        return 0.5 * speed * self._cycle_s if self.count > _CADENCE_FROM else natural_step(speed)

    def _is_counted(self, foot: _Foot, strikes: int) -> bool:
        """Return whether a foot has struck since the last time step, as the loop counts it."""
        before, foot.strikes = foot.strikes, strikes
        return self._begun and strikes > before

    def _comes_down(self, foot: _Foot, struck: bool, lift: float, belt: float) -> bool:
        """Advance a foot; return whether it comes down."""
        if belt < _LEAST_BELT:
            foot.swings, foot.stood = False, True
            return False
        foot.stood = foot.stood or foot.moves < -_UP * belt
        if foot.swings:
            foot.lift = max(foot.lift, lift)
            if struck:
                foot.swings = foot.stood = False  # until it goes back with the belt, it has not left again
                return True
        elif foot.stood and foot.moves > _UP * belt:
            foot.swings, foot.lift = True, lift
        return False

    def _take(self, k: int, foot: _Foot, length: float) -> Footfall:
        """Count a footfall."""
        self.count += 1
        foot.lengths.append(length)
        foot.lifts.append(foot.lift)
        if foot.since < _LONGEST_CYCLE_S and len(foot.lengths) > 1:
            self._cycle_s = foot.since
        foot.since = 0.0
        self._error = math.remainder(0.5 * k - self.phase, 1.0)
        return Footfall(_SIDES[k], length, foot.lift)

    def _follow(self, belt: float, seconds: float) -> None:
        """Advance the phase, and draw it to that of the last footfall."""
        if belt < _LEAST_BELT:
            return
        pulled = self._error * min(_PULL * seconds, 1.0)
        self._error -= pulled
        self.phase = (self.phase + seconds / self._cycle_s + pulled) % 1.0

    @staticmethod
    def _mean(values: list[float]) -> float | None:
        """Return the mean without the first, with which somebody starts; None with fewer than two."""
        return sum(values[1:]) / (len(values) - 1) if len(values) > 1 else None


def ankle(hip: float, knee: float) -> tuple[float, float]:
    """Return how far an ankle is ahead of the hip and below it [m]."""
    return (
        THIGH * math.sin(hip) + SHANK * math.sin(hip - knee),
        THIGH * math.cos(hip) + SHANK * math.cos(hip - knee),
    )
