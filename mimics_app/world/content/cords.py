"""Cord: the live state of one cord of a world, which renderers read."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.maths.cord import Catenary, Ripple, Ripples, hang

__all__ = ["MAX_TAPS", "Cord"]

Colour = tuple[float, float, float]

MAX_TAPS = 8
"""Largest number of ripples at once; a further one replaces the oldest."""
_MAX_RIPPLE = 0.5
"""Largest height of a ripple over the cord's radius: at 1 the cord would be cut through."""
_MAX_BEND = 0.95
"""Largest radius times curvature: at 1 the surface folds over on the inside of the bend."""
_RIPPLE_LIFETIME_S = 6.0
"""Time after which a ripple is invisible [s]."""


@dataclass(eq=False)
class Cord:
    """One cord between two points.

    Attributes:
        ends: Its fixed ends, world [m], float64 [2, 3].
        length: Length [m]; the cord is taut where it is below the distance between the ends.
        radius: Radius [m].
        colour: Linear RGB.
        roughness: Roughness of the surface.
        visible: False draws nothing.
        swing: Angle of its plane to the vertical [rad].
        waves: Propagation parameters of ripples.
        ball: Centre [m] and radius [m] of a ball that casts its shadow on the cord, float64 [4]; radius 0: none.
        taps: Ripples: distance along [m], angle around [rad], start [s], height [m].
        faults: Requests that could not be met, each once.
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
        """Centre line of the cord."""
        return hang(self.ends[0], self.ends[1], self.length, self.swing)

    @property
    def shown_radius(self) -> float:
        """Drawn radius [m]: smaller, with a fault noted, where a bend is too sharp for it."""
        bend = self.curve.bend
        if self.radius * bend <= _MAX_BEND:
            return self.radius
        self._note("the cord's bend is sharper than its radius: it is drawn thinner")
        return _MAX_BEND / bend

    def tap(self, s: float, theta: float, t_s: float, height: float) -> None:
        """Begin a ripple.

        Args:
            s: Distance along the cord [m].
            theta: Angle around it [rad], 0 towards the inside of its bend.
            t_s: Start [s].
            height: Height of the first crest [m].
        """
        limit = _MAX_RIPPLE * self.radius
        if height > limit:
            self._note("a ripple is higher than the cord's radius allows: it is drawn lower")
        self.taps = [*self.taps, (s, theta, t_s, min(height, limit))][-MAX_TAPS:]

    def ripples(self, now_s: float) -> list[Ripple]:
        """Return the ripples that are visible at a time [s]."""
        return [
            Ripple(s, theta, now_s - begun, height)
            for s, theta, begun, height in self.taps
            if 0.0 <= now_s - begun <= _RIPPLE_LIFETIME_S
        ]

    def place(self, share: float, theta: float, gap: float = 0.0) -> tuple[F8, F8]:
        """Return a point on the cord, or above it.

        Args:
            share: Position as a share of the length, 0 to 1.
            theta: Angle around it [rad].
            gap: Distance above the surface [m].

        Returns:
            The point [m] and the outward unit normal, world, float64 [3] each.
        """
        curve = self.curve
        s = share * curve.length
        out = np.cos(theta) * curve.normal(s)[0] + np.sin(theta) * curve.binormal
        return curve.point(s)[0] + (self.shown_radius + gap) * out, out

    def take_faults(self) -> list[str]:
        """Return the faults noted since the last call."""
        new, self._reported = self.faults[self._reported :], len(self.faults)
        return new

    def _note(self, fault: str) -> None:
        if fault not in self.faults:
            self.faults.append(fault)
