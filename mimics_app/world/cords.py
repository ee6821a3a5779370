"""Cords of a world as they are now: what a renderer gets of each, all of it live."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.maths.cord import Catenary, Ripple, Ripples, hang

__all__ = ["MOST_TAPS", "Cord"]

Colour = tuple[float, float, float]

MOST_TAPS = 8
"""Ripples at once; a ninth takes the place of the oldest."""
_MOST_RIPPLE = 0.5
"""Share of the radius that a ripple is high at most: at the whole of it the cord would be cut through."""
_MOST_BEND = 0.95
"""Radius times curvature at most: at 1 the surface folds over on the inside of the bend."""
_OVER_S = 6.0
"""After so long a ripple cannot be seen any more [s]."""


@dataclass(eq=False)
class Cord:
    """One cord between two places.

    Attributes:
        ends: Where it is fixed, world [m], float64 [2, 3].
        length: [m]; shorter than the distance between the ends it is taut.
        radius: [m].
        colour: Linear RGB.
        roughness: Of its surface.
        visible: False draws nothing.
        swing: How far it is swung out of the vertical [rad].
        waves: How ripples run.
        ball: Centre [m] and radius [m] of a ball that casts its shadow on the cord, float64 [4]; radius 0: none.
        taps: Ripples: where, and when they began [s].
        faults: What could not be as it was requested, each once.
    """

    ends: F8 = field(default_factory=lambda: np.array([[0.0, 1.0, 0.0], [0.0, 1.0, -1.0]]))
    length: float = 1.2
    radius: float = 0.025
    colour: Colour = (0.75, 0.25, 0.2)
    roughness: float = 0.45
    visible: bool = True
    swing: float = 0.0
    waves: Ripples = field(default_factory=Ripples)
    ball: F8 = field(default_factory=lambda: np.zeros(4))
    taps: list[tuple[float, float, float, float]] = field(default_factory=list)
    faults: list[str] = field(default_factory=list)
    _reported: int = 0

    @property
    def curve(self) -> Catenary:
        """Its middle line now."""
        return hang(self.ends[0], self.ends[1], self.length, self.swing)

    @property
    def shown_radius(self) -> float:
        """The radius that is drawn [m]: in a bend that is too sharp for it a smaller one, and a fault says so."""
        bend = self.curve.bend
        if self.radius * bend <= _MOST_BEND:
            return self.radius
        self._note("the cord's bend is sharper than its radius: it is drawn thinner")
        return _MOST_BEND / bend

    def tap(self, s: float, theta: float, t_s: float, height: float) -> None:
        """Begin a ripple.

        Args:
            s: Along the cord [m].
            theta: Around it [rad], 0 towards the inside of its bend.
            t_s: When [s].
            height: Of the first crest [m].
        """
        most = _MOST_RIPPLE * self.radius
        if height > most:
            self._note("a ripple is higher than the cord's radius allows: it is drawn lower")
        self.taps = [*self.taps, (s, theta, t_s, min(height, most))][-MOST_TAPS:]

    def ripples(self, now_s: float) -> list[Ripple]:
        """Those that have begun and may still be seen, at a time [s]."""
        return [
            Ripple(s, theta, now_s - begun, height)
            for s, theta, begun, height in self.taps
            if 0.0 <= now_s - begun <= _OVER_S
        ]

    def place(self, share: float, theta: float, gap: float = 0.0) -> tuple[F8, F8]:
        """A place on the cord, or over it.

        Args:
            share: Of its length, 0 to 1.
            theta: Around it [rad].
            gap: Over its surface [m].

        Returns:
            The place and the direction straight out of it, world [m], float64 [3] each.
        """
        curve = self.curve
        s = share * curve.length
        out = np.cos(theta) * curve.normal(s)[0] + np.sin(theta) * curve.binormal
        return curve.point(s)[0] + (self.shown_radius + gap) * out, out

    def take_faults(self) -> list[str]:
        """What could not be as it was requested since the last call, each reported once."""
        new, self._reported = self.faults[self._reported :], len(self.faults)
        return new

    def _note(self, fault: str) -> None:
        if fault not in self.faults:
            self.faults.append(fault)
