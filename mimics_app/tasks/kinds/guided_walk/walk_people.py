"""Models of a walker and of a guide in an alley, by proxemics. Places and ways are complex numbers [m].

The real part is along the alley, the imaginary part to its right.

The walker's distances are from publications; how fast a gesture wears off and how often pointing works are settings:

- personal space of 0.45 to 1.2 m among strangers (Hall, The Hidden Dimension, 1966); people leave 0.4 to 0.6 m between
  themselves and a virtual person who stands, and step away from one who walks into that space (Bailenson et al., Pers
  Soc Psychol Bull 29(7), 2003);
- the nearer the intruder, the stronger the answer (Llobera et al., ACM TAP 8(1), 2010);
- a step of a walker is about half a metre, one that gives way about a third;
- a stranger's gesture is followed sometimes, and less with time: between a tenth and a third of the time at first; one
  comes to who beckons, and goes a part of the way to where somebody points.

One step of either lasts two seconds. A walker moves straight away from a guide within their personal space, so a guide
moves a walker by approaching from where the place is behind the walker, or by beckoning from where it is. Where the
guide begins is drawn, on any side: no single action leads to the place, wherever it is done from.
"""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass
from enum import IntEnum

import numpy as np

__all__ = ["STEP_S", "Alley", "Deed", "Guide", "Walker"]

STEP_S = 2.0
"""Length of a step [s]."""
_GUIDE_STEP = 0.4
"""Length of the guide's step [m]."""
_BEGINS = 2.0
"""Distance of the guide from the walker at the beginning [m], where the alley is wide enough."""
_WIDER = 1.5 + 0.1j
"""How much farther along and across the guide goes than the walker."""
_PASSING, _ROUND = 1.3, math.pi / 3.0
"""Distance of the guide after a step round the walker [m], and its angle, towards the right [rad]."""
_YIELD = 0.35
"""Mean step of a walker who gives way [m]."""
_SWAY = 0.05
"""Standard deviation of a standing walker's displacement per step, in either direction [m]."""
_LONGEST, _POINTED = 0.5, 0.15
"""Longest step to who beckons [m], and the share of it that is gone to where somebody points."""
_TIRES = 0.99
"""Factor on the effect of gestures after each one (habituation)."""


class Deed(IntEnum):
    """Actions of a guide."""

    APPROACH = 0
    RETREAT = 1
    STEP_ASIDE = 2
    WAIT = 3
    BECKON = 4
    POINT = 5


@dataclass(frozen=True, slots=True)
class Alley:
    """The alley: its limits, where the walker begins, the place to come to.

    Attributes:
        low, high: Ends of it for the walker [m].
        half: Half its width for the walker [m].
        start: Where the walker begins.
        place: The place to come to.
        within: How near counts [m].
    """

    low: float = -2.5
    high: float = 4.0
    half: float = 0.9
    start: complex = 0.0
    place: complex = 3.0 + 0.6j
    within: float = 0.3

    def left(self, walker: complex) -> float:
        """Return how far a walker still has to go [m]."""
        return abs(self.place - walker)

    def inside(self, place: complex, more: complex = 0.0) -> complex:
        """Return the nearest place inside the limits, which are `more` farther out along and across."""
        along = min(max(place.real, self.low - more.real), self.high + more.real)
        half = self.half + more.imag
        return complex(along, min(max(place.imag, -half), half))

    def observe(self, walker: complex, guide: complex) -> dict[str, float]:
        """Return what a guide sees: distance `gap` [m], `left` [m], and `bearing` [rad].

        The bearing is that of the guide as seen by the walker, 0 in the direction of the place and positive from there
        to the right.
        """
        bearing = cmath.phase((guide - walker) * (self.place - walker).conjugate())
        return {"gap": abs(guide - walker), "left": self.left(walker), "bearing": bearing}


class Walker:
    """One simulated walker.

    Args:
        rng: Source of all random numbers.
        alley: The alley.

    Attributes:
        at: Place.
        space: Personal space [m].
    """

    def __init__(self, rng: np.random.Generator, alley: Alley) -> None:
        self._rng, self._alley = rng, alley
        self.at = alley.start
        self.space = float(np.clip(rng.normal(0.85, 0.25), 0.45, 1.6))
        self._follows = float(np.clip(rng.normal(0.20, 0.07), 0.1, 0.33))
        self._yield = float(np.clip(rng.normal(_YIELD, 0.1), 0.1, 0.6))

    def answer(self, guide: complex, deed: Deed) -> None:
        """Take one step with the guide's place and action."""
        gap, away = abs(self.at - guide), _direction(self.at - guide)
        move = _SWAY * complex(*self._rng.standard_normal(2))
        gesture = deed in (Deed.BECKON, Deed.POINT)
        if gap < self.space:
            move += away * self._yield * (0.5 + 1.5 * (1.0 - gap / self.space))
        elif gesture and self._rng.random() < self._follows:
            step = min(_LONGEST, gap - 0.8 * self.space)
            to_place = _direction(self._alley.place - self.at)
            move += step * (-away if deed is Deed.BECKON else _POINTED * to_place)
        if gesture:
            self._follows *= _TIRES
        self.at = self._alley.inside(self.at + move)


class Guide:
    """The avatar, which keeps a smallest distance.

    Args:
        rng: Source of the place where it begins.
        alley: The alley.
        nearest: Smallest distance from the walker [m].

    Attributes:
        at: Place.
        deed: Action in this step.
    """

    def __init__(self, rng: np.random.Generator, alley: Alley, nearest: float) -> None:
        self._alley, self.nearest = alley, nearest
        side = rng.uniform(-math.pi, math.pi)
        self.at = alley.inside(alley.start + cmath.rect(_BEGINS, side), _WIDER)
        self.deed = Deed.WAIT

    def do(self, deed: Deed, walker: complex) -> None:
        """Take one step with an action and the walker's place."""
        self.deed = deed
        gap, side = abs(self.at - walker), _direction(self.at - walker)
        if deed is Deed.APPROACH:
            self.at = walker + side * max(gap - _GUIDE_STEP, min(self.nearest, gap))
        elif deed is Deed.RETREAT:
            self.at = self.at + side * _GUIDE_STEP
        elif deed is Deed.STEP_ASIDE:
            self.at = walker + side * cmath.rect(1.0, _ROUND) * max(_PASSING, self.nearest)
        self.at = self._alley.inside(self.at, _WIDER)
        if abs(self.at - walker) < self.nearest:  # a wall is in the way, or the walker came nearer on their own
            self.at = walker + self.nearest * _direction(self.at - walker)


def _direction(way: complex) -> complex:
    """Return a way of length 1; along the alley where it has no length."""
    length = abs(way)
    return way / length if length > 1e-9 else 1.0
