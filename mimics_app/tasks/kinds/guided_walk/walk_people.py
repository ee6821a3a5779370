"""Models of a walker and of a guide along an alley, by proxemics.

The walker's parameters are from publications and were fixed before any learning:

- personal space of 0.45 to 1.2 m among strangers (Hall, The Hidden Dimension, 1966); people leave 0.4 to 0.6 m between
  themselves and a virtual person who stands, and step away from one who walks into that space (Bailenson et al., Pers
  Soc Psychol Bull 29(7), 2003);
- the nearer the intruder, the stronger the answer (Llobera et al., ACM TAP 8(1), 2010);
- a step of a walker is about half a metre, one that gives way about a third;
- a stranger's gesture is followed sometimes, and less with time: between a tenth and a third of the time at first.

One step of either lasts two seconds. A walker moves away from a guide within their personal space, so a guide moves a
walker by approaching from behind, or by beckoning from the front.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum

import numpy as np

__all__ = ["STEP_S", "Alley", "Deed", "Guide", "Walker"]

STEP_S = 2.0
"""Length of a step [s]."""
_GUIDE_STEP = 0.4
"""Length of the guide's step [m]."""
_PASSING = 1.3
"""Distance of the guide after it went round the walker [m]."""
_YIELD = 0.35
"""Mean step of a walker who gives way [m]."""
_SWAY = 0.05
"""Standard deviation of a standing walker's displacement per step [m]."""
_TIRES = 0.985
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
    """The alley, along one axis [m]: its ends, where the walker begins, the place to come to, how near it counts."""

    low: float = -2.5
    high: float = 4.0
    start: float = 0.0
    place: float = 3.0
    within: float = 0.3


class Walker:
    """One simulated walker.

    Args:
        rng: Source of all random numbers.
        alley: The alley.

    Attributes:
        x: Along the alley [m].
        space: Personal space [m].
    """

    def __init__(self, rng: np.random.Generator, alley: Alley) -> None:
        self._rng, self._alley = rng, alley
        self.x = alley.start
        self.space = float(np.clip(rng.normal(0.85, 0.25), 0.45, 1.6))
        self._follows = float(np.clip(rng.normal(0.20, 0.07), 0.1, 0.33))
        self._yield = float(np.clip(rng.normal(_YIELD, 0.1), 0.1, 0.6))

    def answer(self, guide: float, deed: Deed) -> None:
        """Take one step with the guide's position [m] and action."""
        gap, away = abs(self.x - guide), np.sign(self.x - guide) or 1.0
        move = _SWAY * self._rng.standard_normal()
        if gap < self.space:
            move += away * self._yield * (0.5 + 1.5 * (1.0 - gap / self.space))
        elif deed in (Deed.BECKON, Deed.POINT) and self._rng.random() < self._follows:
            towards = -away if deed is Deed.BECKON else np.sign(self._alley.place - self.x)
            share = 1.0 if deed is Deed.BECKON else 0.5
            move += towards * share * min(0.5, gap - 0.8 * self.space)
        if deed in (Deed.BECKON, Deed.POINT):
            self._follows *= _TIRES
        self.x = float(np.clip(self.x + move, self._alley.low, self._alley.high))


class Guide:
    """The avatar, which keeps a smallest distance.

    Args:
        alley: The alley.
        nearest: Smallest distance from the walker [m].

    Attributes:
        x: Position along the alley [m].
        deed: Action in this step.
    """

    def __init__(self, alley: Alley, nearest: float) -> None:
        self._alley, self.nearest = alley, nearest
        self.x = alley.low
        self.deed = Deed.WAIT

    def do(self, deed: Deed, walker: float) -> None:
        """Take one step with an action and the walker's position [m]."""
        self.deed = deed
        side = np.sign(self.x - walker) or -1.0
        if deed is Deed.APPROACH:
            gap = max(abs(self.x - walker) - _GUIDE_STEP, min(self.nearest, abs(self.x - walker)))
            self.x = walker + side * gap
        elif deed is Deed.RETREAT:
            self.x += side * _GUIDE_STEP
        elif deed is Deed.STEP_ASIDE:
            self.x = walker - side * max(_PASSING, self.nearest)
        self.x = float(np.clip(self.x, self._alley.low - 1.5, self._alley.high + 1.5))
        if abs(self.x - walker) < self.nearest:  # the walker came to the end of the alley, or nearer on their own
            self.x = float(walker + side * self.nearest)
