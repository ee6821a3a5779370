"""Wind over a canyon: it rises with how exposed a walker is, and blows in gusts."""

from __future__ import annotations

import math

import numpy as np

__all__ = ["Wind", "exposure"]

_SHELTER = 12.0
"""Distance from a rim over which the wind rises on the beam [m]."""
_MEAN_PAUSE_S, _GUST_S = 6.0, 2.4
"""Mean time between two gusts, and their duration [s]."""
_STEADY, _STRONGEST = 0.35, 1.0
"""Strength of the steady wind, and of the strongest gust, as shares."""


def exposure(along: float, begins: float, ends: float) -> float:
    """Return how exposed a place on the beam is: 0 on land, 1 from some metres after a rim on.

    Args:
        along: The place [m].
        begins: The near rim [m].
        ends: The far rim [m].
    """
    inside = min(along - begins, ends - along) / _SHELTER
    share = min(max(inside, 0.0), 1.0)
    return share * share * (3.0 - 2.0 * share)


class Wind:
    """Gusts from either side.

    Args:
        rng: Source of the gusts.
        calm: No gusts, and half the steady wind.

    Attributes:
        strength: Present strength, 0 to 1.
        push: Present push aside as a share of the strongest, negative to the left.
        side: Side to which the newest gust pushes, -1 left, 1 right; 0 before the first.
    """

    def __init__(self, rng: np.random.Generator, *, calm: bool) -> None:
        self._rng, self._calm = rng, calm
        self._until = float(rng.exponential(_MEAN_PAUSE_S))
        self._since = math.inf
        self.side = self._peak = 0.0
        self.strength = self.push = 0.0

    def blow(self, exposed: float, seconds: float) -> bool:
        """Advance by a time [s] at an exposure (0 to 1); return whether a gust begins."""
        self._since += seconds
        self._until -= seconds
        begins = self._until <= 0.0 and not self._calm
        if begins:
            self._since, self.side = 0.0, float(self._rng.choice((-1.0, 1.0)))
            self._peak = float(self._rng.uniform(0.5, _STRONGEST))
            self._until = _GUST_S + float(self._rng.exponential(_MEAN_PAUSE_S))
        gust = self._peak * math.sin(math.pi * self._since / _GUST_S) ** 2 if self._since < _GUST_S else 0.0
        steady = _STEADY * (0.5 if self._calm else 1.0)
        self.strength = exposed * (steady + (1.0 - _STEADY) * gust)
        self.push = exposed * gust * self.side
        return begins and exposed > 0.0
